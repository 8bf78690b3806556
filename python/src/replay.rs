//! One estimator over a whole recording.

use std::collections::BTreeMap;

use catalogue::parameters::Parameters;
use experiments::uneven::{Chosen, Recorded};
use pyo3::prelude::*;
use recordings::recording::{ReadOptions, Recording};
use simulation::device::Device;
use terminal::failure::Failure;

use crate::columns::Columns;
use crate::device::{
    Built, DeviceFile, Named, PresetsFile, device_of, named, parameters as of_presets,
};
use crate::error::{of_arrays, value_error};
use crate::integer::CountsPerRev;
use crate::stream::{Arrays, Stream, arrays, lack};

/// The arrays, the times if the rows were replaced, the rate, the parameters and the notes.
type Replayed<'py> = (
    Arrays<'py>,
    Option<Vec<f64>>,
    f64,
    BTreeMap<&'static str, f64>,
    Vec<String>,
);

/// Runs an estimator over a recording as `host-sim replay` does.
#[pyfunction]
#[pyo3(signature = (recording, estimator, counts_per_rev, parameters, presets, device, resample))]
pub(crate) fn replay<'py>(
    py: Python<'py>,
    recording: Columns<'py>,
    estimator: &str,
    counts_per_rev: Option<CountsPerRev>,
    parameters: Option<&Bound<'py, PyAny>>,
    presets: Option<PresetsFile>,
    device: Option<DeviceFile>,
    resample: Option<f64>,
) -> PyResult<Replayed<'py>> {
    let name = recording.name.clone();
    let parameters = parameters.map_or(Ok(Named::new()), named)?;
    let stated = [(name.as_str(), recording.counts_per_rev)];
    let (device, differing) =
        device_of(device.as_ref(), counts_per_rev, &stated).map_err(value_error)?;
    let unchecked = recording.copy()?;
    let (reports, built, recording, notes) = py.detach(|| {
        let recording = unchecked.recording().map_err(value_error)?;
        let of_user = || of_presets(presets.as_ref(), estimator, &parameters);
        let prepared = prepared(recording, &name, &device, resample, estimator, of_user);
        let (recording, said) = prepared.map_err(value_error)?;
        let mut notes = differing;
        notes.extend(said);
        let rate_hz = recording.trace.rate_hz;
        let built = Built::new(estimator, &device, rate_hz, presets.as_ref(), &parameters);
        let built = built.map_err(value_error)?;
        lack(built.kind, &recording.trace, &name).map_err(value_error)?;
        notes.extend(built.notes.iter().cloned());
        let mut stream = Stream::new(built.estimator.clone());
        let look = || Python::attach(|py| py.check_signals());
        let reports = stream.run(&recording.trace, look)?;
        PyResult::Ok((reports, built, recording, notes))
    })?;
    Ok((
        arrays(py, reports),
        resample.map(|_| recording.t),
        recording.trace.rate_hz,
        built.named(),
        notes.iter().map(|note| of_arrays(note)).collect(),
    ))
}

/// The recording with unwrapped counts and, if asked for, even rows, and what is said about it. The
/// estimator must be one for its clock.
fn prepared(
    mut recording: Recording,
    name: &str,
    device: &Device,
    resample: Option<f64>,
    estimator: &str,
    parameters: impl FnOnce() -> Result<Parameters, Failure>,
) -> Result<(Recording, Vec<String>), Failure> {
    let kind = catalogue::estimators::Kind::named(estimator)?;
    let mut notes = recording.unwrap_counts(&ReadOptions::of(device));
    if let Some(hz) = resample {
        notes.extend(recording.unevenness());
        recording.resample(hz, name)?;
    } else if recording.trace.periods.is_some() || recording.uneven_steps > 0 {
        recording.check_times(name)?;
    }
    let parameters = parameters()?;
    let mut recorded = Recorded::new(name, &recording, device, &parameters);
    if resample.is_some() {
        recorded.unevenness = None;
    }
    let chosen = Chosen::new(&[kind], true, &recorded)?;
    notes.extend(chosen.notes(&recorded));
    Ok((recording, notes))
}
