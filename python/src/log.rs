//! Logs, read as the commands read them.

use std::path::PathBuf;

use numpy::IntoPyArray;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use recordings::arguments::{ColumnOptions, Counted, RecordingOptions};
use recordings::log::{Log, short_name};
use recordings::recording::Recording;

use crate::background::abandonable;
use crate::device::{DeviceFile, counts_source, device};
use crate::error::{check_file, in_python, value_error};
use crate::integer::CountsPerRev;

/// Reads a log; the keywords of `limpid.Recording`.
#[pyfunction]
#[pyo3(signature = (path, columns, modulus, row_rate, drop_stale, resample, counts_per_rev, device))]
pub(crate) fn read_log<'py>(
    py: Python<'py>,
    path: PathBuf,
    columns: Vec<String>,
    modulus: Vec<String>,
    row_rate: Option<f64>,
    drop_stale: bool,
    resample: Option<f64>,
    counts_per_rev: Option<CountsPerRev>,
    device: Option<DeviceFile>,
) -> PyResult<Bound<'py, PyDict>> {
    let options = RecordingOptions {
        columns: ColumnOptions {
            columns,
            modulus,
            row_rate,
            drop_stale,
        },
        resample,
        ..RecordingOptions::default()
    };
    let source = counts_source(device.as_ref(), counts_per_rev).map(str::to_owned);
    let of_file = self::device(device.as_ref(), counts_per_rev).map_err(value_error)?;
    check_file(py, &path)?;
    let name = short_name(&path).to_owned();
    let (mut recording, stated, assumed, counts_per_rev) = abandonable(py, move || {
        let source = source.as_deref();
        let log = Log::open(&path)?;
        let Counted {
            device,
            lines,
            is_stated,
        } = Counted::new(of_file, source, std::slice::from_ref(&log))?;
        let recording = options.read(&log, &device)?;
        let counts = device.stages.large.counts_per_rev;
        let assumed = (source.is_none() && !is_stated)
            .then(|| format!("{counts} counts/rev assumed: give counts_per_rev or device"));
        Ok((recording, lines, assumed, counts))
    })?;
    let notes = stated
        .into_iter()
        .chain(std::mem::take(&mut recording.notes))
        .chain(assumed);
    let notes: Vec<_> = notes.map(|note| in_python(&note)).collect();
    let fields = fields(py, recording)?;
    fields.set_item("name", name)?;
    fields.set_item("counts_per_rev", counts_per_rev)?;
    fields.set_item("notes", notes)?;
    Ok(fields)
}

/// The columns of a recording, as keywords of `limpid.Recording`.
pub(crate) fn fields(py: Python<'_>, recording: Recording) -> PyResult<Bound<'_, PyDict>> {
    let fields = PyDict::new(py);
    let trace = recording.trace;
    fields.set_item("t", recording.t.into_pyarray(py))?;
    fields.set_item("counts", trace.counts_large.into_pyarray(py))?;
    if let Some(coupled) = trace.counts_small {
        fields.set_item("coupled", coupled.into_pyarray(py))?;
    }
    if let Some(current) = trace.current {
        fields.set_item("current", current.into_pyarray(py))?;
    }
    if let Some(current) = recording.current_small {
        fields.set_item("current_small", current.into_pyarray(py))?;
    }
    if let Some(edges) = trace.edges {
        let age = edges
            .iter()
            .map(|edge| edge.map_or(f64::NAN, |edge| edge.age_s));
        let boundary = edges
            .iter()
            .map(|edge| edge.map_or(0, |edge| edge.boundary));
        fields.set_item("edge_age", age.collect::<Vec<_>>().into_pyarray(py))?;
        fields.set_item(
            "edge_boundary",
            boundary.collect::<Vec<_>>().into_pyarray(py),
        )?;
    }
    if let Some(omega) = trace.true_omega {
        fields.set_item("true_velocity", omega.into_pyarray(py))?;
    }
    Ok(fields)
}
