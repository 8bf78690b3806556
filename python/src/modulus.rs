//! Counts that wrap before 2^32, unwrapped row by row.

use std::collections::BTreeMap;
use std::fmt::{self, Display};

use estimator_core::{Count, WrapError};
use pyo3::prelude::*;
use pyo3::types::PyMapping;
use recordings::recording::{after, boundary};
use simulation::trace::Trace;
use terminal::failure::Failure;

use crate::error::value_error;
use crate::integer::Integer;

/// The argument `modulus`: of the large encoder alone, or by the names of the columns.
pub(crate) enum Modulus {
    Each(BTreeMap<String, Integer>),
    One(Integer),
}

impl<'py> FromPyObject<'_, 'py> for Modulus {
    type Error = PyErr;

    fn extract(object: Borrowed<'_, 'py, PyAny>) -> PyResult<Self> {
        let Ok(mapping) = object.cast::<PyMapping>() else {
            return Ok(Self::One(object.extract()?));
        };
        let mut each = BTreeMap::new();
        for item in mapping.items()? {
            let (name, modulus): (Bound<'_, PyAny>, Integer) = item.extract()?;
            each.insert(name.str()?.to_string(), modulus);
        }
        Ok(Self::Each(each))
    }
}

/// The moduli of both encoders.
#[derive(Clone, Copy, Default)]
pub(crate) struct Moduli {
    counts: Option<u32>,
    coupled: Option<u32>,
    /// Whether the argument names the columns.
    is_named: bool,
}

/// The last counts of both encoders, unwrapped.
#[derive(Clone, Copy, Default)]
pub(crate) struct Unwrapped {
    counts: Option<Count>,
    coupled: Option<Count>,
}

impl Modulus {
    /// The moduli in their range.
    pub(crate) fn checked(self) -> PyResult<Moduli> {
        let modulus =
            |modulus: &Integer| modulus.within("modulus", &(2..=1 << 31), ", for example 4096");
        let each = match self {
            Self::One(one) => {
                return Ok(Moduli {
                    counts: Some(modulus(&one)?),
                    ..Moduli::default()
                });
            }
            Self::Each(each) => each,
        };
        let mut moduli = Moduli {
            is_named: true,
            ..Moduli::default()
        };
        for (name, value) in &each {
            let of = match name.as_str() {
                "counts" => &mut moduli.counts,
                "coupled" => &mut moduli.coupled,
                _ => {
                    return Err(value_error(format!(
                        "modulus: has the key '{name}'; pass counts or coupled"
                    )));
                }
            };
            *of = Some(modulus(value)?);
        }
        Ok(moduli)
    }
}

/// As an argument behind others; nothing where no counts wrap.
impl Display for Moduli {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if let (Some(modulus), false) = (self.counts, self.is_named) {
            return write!(f, ", modulus={modulus}");
        }
        let named = [("counts", self.counts), ("coupled", self.coupled)];
        let named = named.iter().filter_map(|(name, modulus)| {
            let modulus = (*modulus)?;
            Some(format!("'{name}': {modulus}"))
        });
        let named: Vec<_> = named.collect();
        match named.is_empty() {
            true => Ok(()),
            false => write!(f, ", modulus={{{}}}", named.join(", ")),
        }
    }
}

impl Moduli {
    /// Unwraps the counts of both encoders and the boundaries of the edges.
    pub(crate) fn unwrap(self, trace: &mut Trace, last: &mut Unwrapped) -> PyResult<()> {
        if let (Some(modulus), false, Some(_)) = (self.counts, self.is_named, &trace.counts_small) {
            return Err(value_error(format!(
                "modulus={modulus}: does not say where coupled wraps; pass {{'counts': {modulus}, 'coupled': ..}}, or \
                 {{'counts': {modulus}}} if it wraps at 2^32"
            )));
        }
        // The state is changed once all rows are good.
        let mut latest = *last;
        if let Some(modulus) = self.counts {
            let edges = &mut trace.edges;
            let moved = |k: usize, raw, count| {
                if let Some(Some(edge)) = edges.as_mut().map(|edges| &mut edges[k]) {
                    edge.boundary = boundary(edge.boundary, raw, count, modulus);
                }
            };
            let counts = &mut trace.counts_large;
            unwrapped("counts", counts, &mut latest.counts, modulus, moved).map_err(value_error)?;
        }
        if let (Some(modulus), Some(counts)) = (self.coupled, &mut trace.counts_small) {
            unwrapped(
                "coupled",
                counts,
                &mut latest.coupled,
                modulus,
                |_, _, _| (),
            )
            .map_err(value_error)?;
        }
        *last = latest;
        Ok(())
    }
}

/// Unwraps the counts of a column and tells `moved` row, raw and unwrapped count.
fn unwrapped(
    name: &str,
    counts: &mut [u32],
    last: &mut Option<Count>,
    modulus: u32,
    mut moved: impl FnMut(usize, u32, u32),
) -> Result<(), Failure> {
    for (k, count) in counts.iter_mut().enumerate() {
        let raw = *count;
        let signed = i64::from(raw as i32);
        let refused =
            |error: WrapError| format!("row {k}: {name}={signed} with modulus={modulus}: {error}");
        // A counter may count from its modulus down to 0 below zero.
        if !(-i64::from(modulus)..i64::from(modulus)).contains(&signed) {
            return Err(refused(WrapError::Raw).into());
        }
        let next = after(*last, raw, modulus).map_err(refused)?;
        *last = Some(next);
        *count = next.0;
        moved(k, raw, next.0);
    }
    Ok(())
}
