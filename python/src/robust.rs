//! The check of the closed loop on many devices, in shards.

use std::path::PathBuf;

use catalogue::estimators::Kind;
use catalogue::parameters::Parameters;
use experiments::robust::{Experiment, Settings, summary};
use experiments::rows;
use experiments::table::layout::NARROW;
use pyo3::prelude::*;
use pyo3::types::PyBytes;
use report::version::VERSION;
use shards::file::{self, Run};
use shards::{Part, Shards};
use terminal::failure::Failure;

use crate::background::interruptible;
use crate::device::{DeviceFile, device};
use crate::error::{in_python, value_error};

/// The settings of a run, as the command line makes them.
fn settings(
    scenes: &[String],
    estimator: &str,
    rate_hz: f64,
    devices: u64,
    seed: u64,
    seconds: f64,
    file: Option<&DeviceFile>,
) -> Result<Settings, Failure> {
    let kind = Kind::named(estimator)?;
    let device = device(file, None)?;
    Ok(Settings {
        version: env!("CARGO_PKG_VERSION").to_owned(),
        scenes: Settings::scene_names(scenes, kind)?,
        rate_hz,
        estimator: kind.name.to_owned(),
        values: Settings::values(kind, &device, rate_hz, &Parameters::default()),
        devices,
        seed,
        seconds,
        device,
    })
}

/// The content of the file of shard `shard`, which is `K/N`.
#[pyfunction]
#[pyo3(signature = (shard, scenes, estimator, rate, devices, seed, seconds, device))]
pub(crate) fn robust_shard<'py>(
    py: Python<'py>,
    shard: &str,
    scenes: Vec<String>,
    estimator: &str,
    rate: f64,
    devices: u64,
    seed: u64,
    seconds: f64,
    device: Option<DeviceFile>,
) -> PyResult<Bound<'py, PyBytes>> {
    let part: Part = shard
        .parse()
        .map_err(|why| value_error(format!("shard='{shard}': {why}")))?;
    let settings = settings(
        &scenes,
        estimator,
        rate,
        devices,
        seed,
        seconds,
        device.as_ref(),
    );
    let settings = settings.map_err(value_error)?;
    let text = interruptible(py, |stop| {
        let jobs = settings.jobs()?;
        let rows = Experiment::new(&settings)?.rows(&part.of(&jobs), || stop.look())?;
        let run = Run {
            version: VERSION,
            command: &summary::command(&settings),
        };
        file::write(&settings, run, part, jobs.len(), &rows)
    })?;
    Ok(PyBytes::new(py, &text))
}

/// CSV, JSON, table and complaint of a run.
type Merged<'py> = (
    Bound<'py, PyBytes>,
    Bound<'py, PyBytes>,
    String,
    Option<String>,
);

/// The CSV, the JSON, the table and the complaint of the shards in these files.
#[pyfunction]
pub(crate) fn robust_merge(py: Python<'_>, paths: Vec<PathBuf>) -> PyResult<Merged<'_>> {
    let (csv, json, table, complaint) = interruptible(py, |_| {
        let shards = Shards::read(&paths, VERSION)?;
        let merged = shards.merge::<Settings>()?;
        let (settings, all) = merged.ok_or_else(|| {
            Failure::Input(format!(
                "shards of {}, not of host-sim robust; host-sim merge merges them",
                shards.shard_of()
            ))
        })?;
        let scenes = summary::summaries(&all)?;
        Ok((
            rows::csv(&all)?,
            rows::json(&all)?,
            summary::table(&settings, &scenes, NARROW),
            summary::complaint(&settings, &all),
        ))
    })?;
    Ok((
        PyBytes::new(py, &csv),
        PyBytes::new(py, &json),
        table,
        complaint.map(|said| in_python(&said)),
    ))
}
