//! `host-sim compare --closed-loop`.

use crate::closed_loop::SceneName;
use crate::compare::Cost;
use crate::estimators::Kind;
use crate::failure::Failure;
use crate::felt::compare::USUAL;
use crate::felt::{self, Case, FeltRow, Settings, compare};
use crate::output::{print_bytes, write_whole};
use crate::parameters::PlantKind;
use crate::scenario::ScenarioName;
use crate::{rows, simulate};

use super::arguments::{Compare, is_stdout, kinds, rates};
use super::compare::{progress, report_folder, timing, wanted};

/// Length of a run unless told otherwise, s.
const SECONDS: f64 = 10.0;

pub(super) fn run(options: &Compare, command_line: &str) -> Result<(), Failure> {
    let settings = settings(options)?;
    let folder = report_folder(options);
    let cases = cases(
        options,
        &scenes(&options.scenarios)?,
        SECONDS,
        folder.is_some(),
    )?;
    let bar = progress(
        cases
            .iter()
            .map(|case| felt::compare::runs(case, &settings))
            .sum(),
        "closing loops",
    );
    let outcomes = compare(&cases, &settings, || bar.inc(1))?;
    bar.finish_and_clear();

    if options.timing {
        let cost: Cost = outcomes.iter().map(|outcome| outcome.cost).sum();
        eprintln!("{}", timing(cost));
    }
    let scores: Vec<FeltRow> = outcomes.iter().flat_map(|o| o.rows.clone()).collect();
    match options.json.as_deref() {
        Some(path) if is_stdout(path) => print_bytes(&rows::json(&scores)?)?,
        Some(path) => write_whole(path, &rows::json(&scores)?)?,
        None => {}
    }
    let _ = (folder, command_line);
    if options.json.as_deref().is_some_and(is_stdout) {
        return Ok(());
    }
    print_bytes(felt::table::details(&outcomes).as_bytes())
}

/// What all runs have in common.
pub(super) fn settings(options: &Compare) -> Result<Settings, Failure> {
    let handle = Kind::named(options.handle_estimator.as_deref().unwrap_or(USUAL))?;
    if handle.needs.current {
        return Err(Failure::Input(format!(
            "--handle-estimator {}: models the large motor, not the handle; take another",
            handle.name
        )));
    }
    let mut estimators = kinds(&options.estimators)?;
    if options.estimators.is_empty() {
        estimators.retain(|kind| !kind.needs.edge);
    }
    if let Some(kind) = estimators
        .iter()
        .chain([&handle])
        .find(|kind| kind.needs.edge)
    {
        return Err(Failure::Input(format!(
            "{}: needs edge time stamps, which the closed loop does not have; take another",
            kind.name
        )));
    }
    Ok(Settings {
        device: options.device.load()?,
        estimators,
        handle,
        parameters: options.parameters.load()?,
        wanted: wanted(&options.scores)?,
    })
}

/// The scenes by these names, once each; all where there is no name.
fn scenes(names: &[String]) -> Result<Vec<SceneName>, Failure> {
    if names.is_empty() {
        return Ok(SceneName::ALL.to_vec());
    }
    let mut scenes = Vec::new();
    for name in names {
        let scene =
            name.parse::<SceneName>()
                .map_err(|error| match name.parse::<ScenarioName>() {
                    Ok(_) => format!("scenario '{name}' cannot close a loop: {error}"),
                    Err(_) => error,
                })?;
        if !scenes.contains(&scene) {
            scenes.push(scene);
        }
    }
    Ok(scenes)
}

/// The cases, rate by rate.
pub(super) fn cases(
    options: &Compare,
    scenes: &[SceneName],
    seconds: f64,
    keep: bool,
) -> Result<Vec<Case>, Failure> {
    let plant = match options.frictionless {
        true => PlantKind::Frictionless,
        false => PlantKind::Friction,
    };
    let seconds = options.seconds.unwrap_or(seconds);
    let mut cases = Vec::new();
    for rate_hz in rates(&options.rates, &[1e3, 11.6e3]) {
        simulate::ticks(rate_hz, seconds)?;
        cases.extend(scenes.iter().map(|&scene| Case {
            scene,
            rate_hz,
            plant,
            seed: options.seed,
            seconds,
            keep,
        }));
    }
    Ok(cases)
}
