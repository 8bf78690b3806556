//! Recordings that are simulated, or computed from a finer one or from an encoder's lines.

use std::path::PathBuf;

use experiments::closed_loop::Hand;
use experiments::real::wanted::{Wanted, rate as checked_rate};
use experiments::simulated::Run;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use recordings::arguments::ColumnOptions;
use recordings::log::{Log, short_name};
use recordings::recording::Capture;
use terminal::failure::Failure;

use crate::background::abandonable;
use crate::device::{DeviceFile, device};
use crate::error::{check_file, in_python, value_error};
use crate::integer::{CountsPerRev, Integer};
use crate::log::fields;

/// The load on the handle that `name` means.
fn hand(name: &str) -> Result<Hand, Failure> {
    match name {
        "still" => Ok(Hand::Still),
        "clamp" => Ok(Hand::Clamp),
        "nobody" => Ok(Hand::Gone(0.0)),
        "moving" => Ok(Hand::Moving),
        _ => Err(Failure::Input(format!(
            "hand='{name}': must be still, clamp, nobody or moving"
        ))),
    }
}

/// A simulated recording, as keywords of `limpid.Recording`.
#[pyfunction]
#[pyo3(signature = (scenario, scene, rate, seconds, seed, hand, every, counts_per_rev, device))]
pub(crate) fn simulate<'py>(
    py: Python<'py>,
    scenario: Option<&str>,
    scene: Option<&str>,
    rate: f64,
    seconds: Option<f64>,
    seed: Integer,
    hand: &str,
    every: Integer,
    counts_per_rev: Option<CountsPerRev>,
    device: Option<DeviceFile>,
) -> PyResult<Bound<'py, PyDict>> {
    let device = self::device(device.as_ref(), counts_per_rev).map_err(value_error)?;
    let every = every.within("every", &(1..=1000), "")?;
    let seed = seed.within("seed", &(0..=u64::MAX), "")?;
    let hand = self::hand(hand).map_err(value_error)?;
    let counts_per_rev = device.stages.large.counts_per_rev;
    let run = Run {
        device,
        rate_hz: rate,
        seconds,
        seed,
    };
    let name = scenario.or(scene).unwrap_or("excite");
    let of = [scenario, scene].map(|name| name.map(str::to_owned));
    let recording = abandonable(py, move || match of {
        [Some(name), _] => run.scenario(&name),
        [None, scene] => run.scene(scene.as_deref(), hand, every),
    })?;
    let fields = fields(py, recording)?;
    fields.set_item("name", name)?;
    fields.set_item("counts_per_rev", counts_per_rev)?;
    Ok(fields)
}

/// What a coarse encoder would have seen of a fine recording, as keywords of `limpid.Recording`.
#[pyfunction]
#[pyo3(signature = (path, columns, modulus, row_rate, drop_stale, counts_per_rev, fine_counts_per_rev, rate, phase, seconds, device))]
pub(crate) fn coarsen<'py>(
    py: Python<'py>,
    path: PathBuf,
    columns: Vec<String>,
    modulus: Vec<String>,
    row_rate: Option<f64>,
    drop_stale: bool,
    counts_per_rev: CountsPerRev,
    fine_counts_per_rev: Option<Integer>,
    rate: f64,
    phase: f64,
    seconds: Option<f64>,
    device: Option<DeviceFile>,
) -> PyResult<Bound<'py, PyDict>> {
    let device = self::device(device.as_ref(), Some(counts_per_rev)).map_err(value_error)?;
    check_file(py, &path)?;
    let fine_counts_per_rev = fine_counts_per_rev
        .map(|counts| counts.counts_per_rev("fine_counts_per_rev"))
        .transpose()?;
    let counts_per_rev = counts_per_rev.get();
    let wanted = Wanted {
        counts_per_rev,
        fine_counts_per_rev,
        rate_hz: rate,
        phase,
        seconds,
        columns: ColumnOptions {
            columns,
            modulus,
            row_rate,
            drop_stale,
        },
        device,
    };
    let name = short_name(&path).to_owned();
    let recording = abandonable(py, move || wanted.of_file(&path))?;
    let fields = fields(py, recording)?;
    fields.set_item("name", name)?;
    fields.set_item("counts_per_rev", counts_per_rev)?;
    Ok(fields)
}

/// The recording of a capture of an encoder's lines, as keywords of `limpid.Recording`.
#[pyfunction]
#[pyo3(signature = (path, rate, lines, columns, row_rate, counts_per_rev))]
pub(crate) fn decode<'py>(
    py: Python<'py>,
    path: PathBuf,
    rate: f64,
    lines: Option<Vec<String>>,
    columns: Vec<String>,
    row_rate: Option<f64>,
    counts_per_rev: Option<CountsPerRev>,
) -> PyResult<Bound<'py, PyDict>> {
    check_file(py, &path)?;
    let name = short_name(&path).to_owned();
    let mut recording = abandonable(py, move || {
        let capture = Capture::new(&columns, lines, row_rate, checked_rate(rate)?)?;
        let log = Log::open(&path)?;
        capture.decode(log.reader()?, log.name())
    })?;
    let notes = std::mem::take(&mut recording.notes);
    let notes: Vec<_> = notes.iter().map(|note| in_python(note)).collect();
    let fields = fields(py, recording)?;
    fields.set_item("name", name)?;
    fields.set_item("counts_per_rev", counts_per_rev.map(CountsPerRev::get))?;
    fields.set_item("notes", notes)?;
    Ok(fields)
}
