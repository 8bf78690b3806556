//! Columns of a recording as arrays.

use numpy::PyReadonlyArray1;
use pyo3::prelude::*;
use recordings::recording::Recording;
use simulation::trace::{EdgeStamp, Trace};
use terminal::failure::Failure;

use crate::error::{of_times, value_error};
use crate::integer::CountsPerRev;

/// The arrays of a `limpid.Recording`, which checks their types and lengths before each call. The attribute `_t` is
/// `None` for rows at a constant rate.
#[derive(FromPyObject)]
pub(crate) struct Columns<'py> {
    pub(crate) name: String,
    _t: Option<PyReadonlyArray1<'py, f64>>,
    pub(crate) rate: f64,
    counts: PyReadonlyArray1<'py, u32>,
    coupled: Option<PyReadonlyArray1<'py, u32>>,
    current: Option<PyReadonlyArray1<'py, f64>>,
    edge_age: Option<PyReadonlyArray1<'py, f64>>,
    edge_boundary: Option<PyReadonlyArray1<'py, u32>>,
    true_velocity: Option<PyReadonlyArray1<'py, f64>>,
    pub(crate) counts_per_rev: Option<CountsPerRev>,
}

/// A recording of arrays that is not yet checked.
pub(crate) struct Unchecked {
    name: String,
    t: Option<Vec<f64>>,
    trace: Trace,
}

impl Columns<'_> {
    /// Copies the arrays, so that a thread without the interpreter can read them.
    pub(crate) fn copy(&self) -> PyResult<Unchecked> {
        let trace = Trace {
            rate_hz: self.rate,
            counts_large: self.counts.as_slice()?.to_vec(),
            counts_small: copied(self.coupled.as_ref())?,
            current: copied(self.current.as_ref())?,
            edges: edges(self.edge_age.as_ref(), self.edge_boundary.as_ref())?,
            true_omega: copied(self.true_velocity.as_ref())?,
            ..Trace::default()
        };
        Ok(Unchecked {
            name: self.name.clone(),
            t: copied(self._t.as_ref())?,
            trace,
        })
    }
}

impl Unchecked {
    /// Name in messages.
    pub(crate) fn name(&self) -> &str {
        &self.name
    }

    /// The recording, with its rate and its periods.
    pub(crate) fn recording(self) -> Result<Recording, Failure> {
        if let Some(t) = self.t {
            return Recording::of_columns(t, self.trace, &self.name);
        }
        Recording::at_rate(self.trace, &self.name)
    }
}

/// An array as a vector.
pub(crate) fn copied<T: numpy::Element + Copy>(
    column: Option<&PyReadonlyArray1<'_, T>>,
) -> PyResult<Option<Vec<T>>> {
    let slice = column.map(|column| column.as_slice()).transpose()?;
    Ok(slice.map(<[T]>::to_vec))
}

/// The latest edges; an age that is not a number is that of no edge.
pub(crate) fn edges(
    age: Option<&PyReadonlyArray1<'_, f64>>,
    boundary: Option<&PyReadonlyArray1<'_, u32>>,
) -> PyResult<Option<Vec<Option<EdgeStamp>>>> {
    let (Some(age), Some(boundary)) = (age, boundary) else {
        return Ok(None);
    };
    let pairs = age.as_slice()?.iter().zip(boundary.as_slice()?);
    let stamp = |(age, boundary): (&f64, &u32)| edge(*age, *boundary);
    Ok(Some(pairs.map(stamp).collect()))
}

/// An edge of this age, s; `None` if the age is not a number.
pub(crate) fn edge(age_s: f64, boundary: u32) -> Option<EdgeStamp> {
    (!age_s.is_nan()).then_some(EdgeStamp { age_s, boundary })
}

/// Rate of rows at the times `t`, Hz.
#[pyfunction]
pub(crate) fn clock(t: PyReadonlyArray1<'_, f64>, name: &str) -> PyResult<f64> {
    let t = t.as_slice()?.to_vec();
    let columns = Trace {
        counts_large: vec![0; t.len()],
        ..Trace::default()
    };
    let recording = Recording::of_columns(t, columns, name)
        .map_err(|failure| value_error(of_times(&failure.to_string())))?;
    Ok(recording.trace.rate_hz)
}
