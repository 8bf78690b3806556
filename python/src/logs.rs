//! Experiments over recordings in memory: a recommendation, and tuned parameters.

use std::collections::BTreeMap;

use catalogue::estimators::Kind;
use catalogue::parameters::{Parameters, PlantKind, Presets};
use experiments::recommend::{Settings, lines, recommend as recommend_for};
use experiments::tune::{LogFile, LogPlan, Plan, Wishes};
use experiments::uneven::{Chosen, Recorded};
use pyo3::prelude::*;
use recordings::recording::{ReadOptions, Recording};
use shards::Experiment as _;
use simulation::device::Device;
use simulation::scenario::ScenarioName;
use terminal::failure::Failure;

use crate::background::interruptible;
use crate::columns::{Columns, Unchecked};
use crate::device::{DeviceFile, Named, PresetsFile, device, device_of, parameters as of_presets};
use crate::error::{of_logs, value_error};
use crate::integer::{CountsPerRev, Integer};

/// The device for these recordings, and what is said about their counts per revolution.
fn device_of_logs(
    file: Option<&DeviceFile>,
    counts_per_rev: Option<CountsPerRev>,
    logs: &[Columns<'_>],
) -> PyResult<(Device, Vec<String>)> {
    let stated = logs
        .iter()
        .map(|log| (log.name.as_str(), log.counts_per_rev));
    device_of(file, counts_per_rev, &stated.collect::<Vec<_>>()).map_err(value_error)
}

/// Recordings with their names.
type Logs = Vec<(String, Recording)>;

/// The recordings and what their reader says, for the estimators `kinds`. Those that the user did not
/// name are left out where they need a constant period or another rate.
fn read(
    columns: Vec<Unchecked>,
    device: &Device,
    parameters: &Parameters,
    mut kinds: Vec<&'static Kind>,
    are_named: bool,
) -> Result<(Logs, Vec<&'static Kind>, Vec<String>), Failure> {
    let mut logs = Vec::new();
    let mut notes = Vec::new();
    for unchecked in columns {
        let name = unchecked.name().to_owned();
        let mut recording = unchecked.recording()?;
        if recording.trace.len() < 2 {
            return Err(Failure::Input(format!(
                "{name}: has one row; pass a recording of several seconds"
            )));
        }
        let unwrapped = recording.unwrap_counts(&ReadOptions::of(device));
        recording.check_times(&name)?;
        let recorded = Recorded::new(&name, &recording, device, parameters);
        let chosen = Chosen::new(&kinds, are_named, &recorded)?;
        let clock = chosen.notes(&recorded);
        let lines = unwrapped.into_iter().chain(clock);
        notes.extend(lines.map(|line| format!("{name}: {line}")));
        kinds = chosen.kinds;
        logs.push((name, recording));
    }
    Ok((logs, kinds, notes))
}

/// The estimators of these names that have parameters; all of them if no name is given.
fn tunable(names: &[String]) -> Result<Vec<&'static Kind>, Failure> {
    let named: Result<Vec<_>, _> = names.iter().map(|name| Kind::named(name)).collect();
    let kinds = match names {
        [] => Kind::all().iter().collect(),
        _ => named?,
    };
    let kinds: Vec<_> = kinds.into_iter().filter(|kind| kind.is_tunable()).collect();
    match kinds.is_empty() {
        false => Ok(kinds),
        true => Err(Failure::Input(
            "estimators: none of them has parameters to tune; see limpid.estimators()".to_owned(),
        )),
    }
}

fn in_words_of_python(notes: &[String]) -> Vec<String> {
    notes.iter().map(|note| of_logs(note)).collect()
}

fn failure_of_logs(failure: Failure) -> Failure {
    Failure::Input(of_logs(&failure.to_string()))
}

/// The ranking as JSON, the lines of Rust, and the notes.
#[pyfunction]
#[pyo3(signature = (logs, instructions, counts_per_rev, presets, device))]
pub(crate) fn recommend(
    py: Python<'_>,
    logs: Vec<Columns<'_>>,
    instructions: f64,
    counts_per_rev: Option<CountsPerRev>,
    presets: Option<PresetsFile>,
    device: Option<DeviceFile>,
) -> PyResult<(String, String, Vec<String>)> {
    let is_known = device.is_some();
    let (device, mut notes) = device_of_logs(device.as_ref(), counts_per_rev, &logs)?;
    if !(instructions > 0.0 && instructions.is_finite()) {
        return Err(value_error(format!(
            "instructions={instructions}: must be a number above 0"
        )));
    }
    let parameters = of_presets(presets.as_ref(), "", &Named::new()).map_err(value_error)?;
    let columns: PyResult<Vec<_>> = logs.iter().map(Columns::copy).collect();
    let columns = columns?;
    interruptible(py, |stop| {
        let kinds = Kind::all().iter().collect();
        let read = read(columns, &device, &parameters, kinds, false);
        let (logs, _, said) = read.map_err(failure_of_logs)?;
        notes.extend(said);
        let settings = Settings {
            device: &device,
            is_known,
            parameters: &parameters,
            budget: instructions,
            cost: report::measured::cost,
        };
        let recommended = recommend_for(&logs, &settings, &|| stop.look());
        let recommended = recommended.map_err(failure_of_logs)?;
        notes.extend(recommended.notes.iter().cloned());
        let json = serde_json::to_string(&recommended.ranked).map_err(|error| error.to_string())?;
        let rust = lines(&recommended, instructions);
        Ok((json, rust, in_words_of_python(&notes)))
    })
}

/// RMS errors of one estimator before and with the found parameters, each in the tuned and in the
/// held-out half, and whether the old parameters are kept.
type LogRow = (String, [f64; 2], [f64; 2], bool);

/// A presets file, the errors of each estimator, and the notes.
#[pyfunction]
#[pyo3(signature = (logs, estimators, counts_per_rev, presets, device))]
pub(crate) fn tune_logs(
    py: Python<'_>,
    logs: Vec<Columns<'_>>,
    estimators: Vec<String>,
    counts_per_rev: Option<CountsPerRev>,
    presets: Option<PresetsFile>,
    device: Option<DeviceFile>,
) -> PyResult<(String, Vec<LogRow>, Vec<String>)> {
    let (device, mut notes) = device_of_logs(device.as_ref(), counts_per_rev, &logs)?;
    let before = of_presets(presets.as_ref(), "", &Named::new()).map_err(value_error)?;
    let kinds = tunable(&estimators).map_err(value_error)?;
    let columns: PyResult<Vec<_>> = logs.iter().map(Columns::copy).collect();
    let columns = columns?;
    interruptible(py, |stop| {
        let are_named = !estimators.is_empty();
        let read = read(columns, &device, &before, kinds, are_named);
        let (logs, kinds, said) = read.map_err(failure_of_logs)?;
        notes.extend(said);
        let logs = logs.into_iter().map(|(name, recording)| {
            let sum = String::new();
            (LogFile { name, sum }, recording)
        });
        let plan =
            LogPlan::new(logs.collect(), device, &kinds, &before).map_err(failure_of_logs)?;
        let plan = plan.with_notes(notes);
        let searches = plan.jobs()?;
        let tuned = plan.rows_with_look(&searches, &|| (), &|| stop.look())?;
        let rows = searches.into_iter().zip(&tuned);
        let rows = rows.map(|(search, row)| (search.estimator, row.before, row.found, row.kept));
        let (presets, notes) = plan.presets(&tuned);
        Ok((
            presets.to_toml()?,
            rows.collect(),
            in_words_of_python(&notes),
        ))
    })
}

/// A presets file and the notes.
#[pyfunction]
#[pyo3(signature = (rate, estimators, scenarios, seeds, seconds, perturbed, friction, counts_per_rev, device))]
pub(crate) fn tune_scenarios(
    py: Python<'_>,
    rate: f64,
    estimators: Vec<String>,
    scenarios: Vec<String>,
    seeds: Option<Integer>,
    seconds: Option<f64>,
    perturbed: Option<bool>,
    friction: bool,
    counts_per_rev: Option<CountsPerRev>,
    device: Option<DeviceFile>,
) -> PyResult<(String, Vec<String>)> {
    let device = self::device(device.as_ref(), counts_per_rev).map_err(value_error)?;
    let kinds = tunable(&estimators).map_err(value_error)?;
    let named: Result<Vec<ScenarioName>, String> = scenarios.iter().map(|s| s.parse()).collect();
    let seeds = seeds
        .map(|seeds| seeds.within("seeds", &(1..=1000), ""))
        .transpose()?;
    let wishes = Wishes {
        scenarios: named.map_err(value_error)?,
        seeds,
        seconds,
        perturbed,
    };
    let plan = Plan {
        groups: wishes.groups(&kinds),
        rates_hz: vec![rate],
        plants: match friction {
            true => vec![PlantKind::Friction],
            false => vec![PlantKind::Frictionless],
        },
        device,
    };
    interruptible(py, |stop| {
        let tuned = plan.rows_with_look(&plan.jobs()?, &|| (), &|| stop.look())?;
        let (presets, notes) = plan.presets(&tuned)?;
        Ok((presets.to_toml()?, in_words_of_python(&notes)))
    })
}

/// The values of a presets file, by estimator.
#[pyfunction]
pub(crate) fn values_of_presets(text: &str) -> PyResult<Vec<(String, BTreeMap<String, f64>)>> {
    let presets = Presets::parse(text, "presets").map_err(value_error)?;
    let all = presets
        .preset
        .into_iter()
        .flat_map(|preset| preset.estimators);
    Ok(all
        .map(|(name, values)| (name, values.into_iter().collect()))
        .collect())
}
