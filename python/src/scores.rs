//! Scores of a velocity against the true one.

use std::collections::BTreeMap;

use experiments::compare::interval;
use numpy::PyReadonlyArray1;
use pyo3::prelude::*;
use scoring::score::{SKIP_S, Score, Truth, Wanted};

use crate::device::{DeviceFile, device};
use crate::error::value_error;

/// The scores that are known, by name.
#[pyfunction]
#[pyo3(signature = (velocity, true_velocity, rate, device))]
pub(crate) fn scores(
    velocity: PyReadonlyArray1<'_, f32>,
    true_velocity: PyReadonlyArray1<'_, f64>,
    rate: f64,
    device: Option<DeviceFile>,
) -> PyResult<BTreeMap<&'static str, f64>> {
    let device = self::device(device.as_ref(), None).map_err(value_error)?;
    let (velocity, omega) = (velocity.as_slice()?, true_velocity.as_slice()?);
    if omega.len() as f64 <= SKIP_S * rate {
        return Err(value_error(format!(
            "velocity: {} rows; the first {SKIP_S} s are not scored, pass more than {:.0} rows",
            omega.len(),
            SKIP_S * rate
        )));
    }
    let truth = Truth::new(omega, rate, interval(&device), Wanted::ALL).map_err(value_error)?;
    let score = truth.score(velocity);
    let fields = Score::FIELDS.iter();
    let known = fields.filter_map(|field| Some((field.name, (field.of)(&score)?)));
    Ok(known.collect())
}

/// Name, unit and definition of each score.
#[pyfunction]
pub(crate) fn score_fields() -> Vec<(&'static str, &'static str, String)> {
    let fields = Score::FIELDS.iter();
    let row = |about: &[&str]| {
        about
            .iter()
            .map(|line| line.trim())
            .collect::<Vec<_>>()
            .join(" ")
    };
    fields
        .map(|field| (field.name, field.unit, row(field.about)))
        .collect()
}
