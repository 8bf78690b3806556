//! Lists of what the names of arguments can be.

use std::collections::BTreeMap;

use catalogue::estimators::Kind;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use simulation::scenario::ScenarioName;

use crate::device::{Built, DeviceFile, Named, PresetsFile, device as of_file};
use crate::error::value_error;
use crate::integer::CountsPerRev;

/// The rows of the catalogue, as keywords of `limpid.EstimatorInfo`.
#[pyfunction]
pub(crate) fn estimators(py: Python<'_>) -> PyResult<Vec<Bound<'_, PyDict>>> {
    let row = |kind: &Kind| {
        let row = PyDict::new(py);
        row.set_item("name", kind.name)?;
        row.set_item("summary", kind.summary)?;
        let needs = [
            (kind.needs.current, "current"),
            (kind.needs.coupled, "coupled"),
            (kind.needs.edge, "edge"),
        ];
        let needs = needs.into_iter().filter(|(needed, _)| *needed);
        row.set_item("needs", needs.map(|(_, name)| name).collect::<Vec<_>>())?;
        row.set_item("varying_period", kind.varying_period)?;
        let parameters = kind.parameters.iter().map(|parameter| {
            let fields = PyDict::new(py);
            fields.set_item("name", parameter.name)?;
            fields.set_item("unit", parameter.unit)?;
            fields.set_item("meaning", parameter.meaning)?;
            fields.set_item("lowest", parameter.lowest)?;
            fields.set_item("highest", parameter.highest)?;
            fields.set_item("whole", parameter.whole)?;
            PyResult::Ok(fields)
        });
        row.set_item("parameters", parameters.collect::<PyResult<Vec<_>>>()?)?;
        Ok(row)
    };
    Kind::all().iter().map(row).collect()
}

/// The values of an estimator's parameters for an encoder at a rate.
#[pyfunction]
#[pyo3(signature = (estimator, rate, counts_per_rev, presets, device))]
pub(crate) fn parameters(
    estimator: &str,
    rate: f64,
    counts_per_rev: Option<CountsPerRev>,
    presets: Option<PresetsFile>,
    device: Option<DeviceFile>,
) -> PyResult<BTreeMap<&'static str, f64>> {
    let device = of_file(device.as_ref(), counts_per_rev).map_err(value_error)?;
    let built = Built::new(estimator, &device, rate, presets.as_ref(), &Named::new());
    Ok(built.map_err(value_error)?.named())
}

/// Names and descriptions of the scenarios.
#[pyfunction]
pub(crate) fn scenarios() -> Vec<(&'static str, &'static str)> {
    let row = |scenario: &ScenarioName| (scenario.as_str(), scenario.description());
    ScenarioName::ALL.iter().map(row).collect()
}

/// All constants of a device, as JSON with the sections and keys of a device file.
#[pyfunction]
#[pyo3(signature = (device))]
pub(crate) fn device(device: Option<DeviceFile>) -> PyResult<String> {
    let device = of_file(device.as_ref(), None).map_err(value_error)?;
    serde_json::to_string(&device).map_err(|error| value_error(error.to_string()))
}
