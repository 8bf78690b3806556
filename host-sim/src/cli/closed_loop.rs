//! `host-sim compare --closed-loop`.

use std::path::PathBuf;

use haptic_control::LoopPoles;

use catalogue::estimators::Kind;
use catalogue::parameters::PlantKind;
use experiments::closed_loop::{check_handle, check_stamps, environments_with, loop_ticks, named};
use experiments::compare::{Cost, Settings};
use experiments::rows;
use experiments::table::layout::terminal_width;
use experiments::transparency::compare::DEFAULT_ESTIMATOR;
use experiments::transparency::{
    self, ClosedLoopRow, Design, LoopCase, LoopSettings, Outcome, compare,
};
use haptic_control::SceneKind;
use report;
use report::{ClosedLoop, ReportInput};
use simulation::scenario::ScenarioName;
use terminal::failure::Failure;
use terminal::output::{Folder, note};

use super::arguments::{distinct, kinds};
use super::compare::{Compare, longer_than_skipped, report_folder, timing, wanted};
use super::page::{self, progress};
use super::rates::PAPER_HZ;

/// Default duration of a run, s.
const SECONDS: f64 = 10.0;

pub(super) fn run(options: &Compare, command_line: &str) -> Result<(), Failure> {
    let settings = settings(options)?;
    let (_, asked) = wanted(&options.scores)?;
    let folder = report_folder(options)?;
    let cases = cases(
        options,
        &scenes(&options.scenarios, settings.handle)?,
        SECONDS,
        folder.is_some(),
    )?;
    let bar = progress(
        cases
            .iter()
            .map(|case| transparency::compare::runs(case, &settings))
            .sum(),
        "closing loops",
    );
    let outcomes = compare(&cases, &settings, &|| bar.inc(1))?;
    bar.finish_and_clear();

    if options.timing {
        let cost: Cost = outcomes.iter().map(|outcome| outcome.cost).sum();
        note(timing(cost));
    }
    let scores: Vec<ClosedLoopRow> = outcomes.iter().flat_map(|o| o.rows.clone()).collect();
    let mut text = transparency::table::details(&outcomes, &asked, terminal_width());
    if let Some(folder) = folder {
        let input = ReportInput {
            command: command_line.to_owned(),
            device_name: options.device.name(),
            device: settings.common.device.clone(),
            ..ReportInput::default()
        };
        let index = write(
            Folder::new(folder),
            input,
            closed_loop(outcomes, &settings)?,
        )?;
        text.push_str(&format!("Report: {}\n", index.display()));
    }
    page::print(options.json.as_deref(), &rows::json(&scores)?, &text)
}

/// The closed-loop section for the report of an open-loop comparison; empty if scenarios were
/// named. If the loop cannot be closed, the section is empty and the returned remark has the
/// reason.
pub(super) fn for_report(options: &Compare) -> (ClosedLoop, Option<String>) {
    if !options.scenarios.is_empty() {
        return (ClosedLoop::default(), None);
    }
    let run = || {
        let settings = settings(options)?;
        let mut cases = cases(options, &scenes(&[], settings.handle)?, SECONDS, true)?;
        // The attribution at a high rate takes as long as the run; host-sim feel has every rate.
        let rates = cases.iter().map(|case| case.rate_hz);
        let lowest = rates.fold(f64::INFINITY, f64::min);
        for case in &mut cases {
            case.attribute = case.rate_hz == lowest;
        }
        closed_loop(compare(&cases, &settings, &|| ())?, &settings)
    };
    match run() {
        Ok(closed) => (closed, None),
        Err(error) => (
            ClosedLoop::default(),
            Some(format!("The closed loop was not simulated: {error}.")),
        ),
    }
}

/// Input of the report: the outcomes, and sweep and design of the velocity loop at their rates.
fn closed_loop(outcomes: Vec<Outcome>, settings: &LoopSettings) -> Result<ClosedLoop, Failure> {
    let rates = (outcomes.iter()).map(|outcome| (outcome.case.rate_hz, outcome.case.plant));
    let rates: Vec<_> = rates.collect();
    let rates = distinct(&rates, &[]);
    let each = || rates.iter().copied();
    Ok(ClosedLoop {
        outcomes,
        swept: each()
            .map(|(rate_hz, plant)| transparency::sweep(settings, rate_hz, plant))
            .collect::<Result<_, _>>()?,
        designs: each()
            .map(|(rate_hz, plant)| design(settings, rate_hz, plant))
            .collect::<Result<_, _>>()?,
    })
}

fn design(settings: &LoopSettings, rate_hz: f64, plant: PlantKind) -> Result<Design, Failure> {
    let assumed = transparency::compare::device(settings, plant).stages;
    Design::new(&assumed, rate_hz, LoopPoles::DEFAULT)
}

/// Writes the page, and the scores of the closed loop as JSON and CSV if there are scores. Returns
/// the path of the page.
pub(super) fn write(
    mut folder: Folder,
    mut input: ReportInput,
    closed: ClosedLoop,
) -> Result<PathBuf, Failure> {
    if !closed.outcomes.is_empty() {
        let rows: Vec<ClosedLoopRow> = (closed.outcomes.iter())
            .flat_map(|o| o.rows.clone())
            .collect();
        folder.add("closed-loop.json", rows::json(&rows)?);
        folder.add("closed-loop.csv", rows::csv(&rows)?);
    }
    input.closed_loop = closed;
    page::write(folder, &report::html(&input)?)
}

/// The estimator of the handle's velocity of this name, or the default one.
pub(super) fn handle(name: Option<&str>) -> Result<&'static Kind, Failure> {
    let handle = Kind::named(name.unwrap_or(DEFAULT_ESTIMATOR))?;
    check_handle("--handle-estimator", handle)?;
    Ok(handle)
}

/// The estimators of these names beside that of the handle; without a name, all that a closed loop can
/// have.
pub(super) fn estimators(names: &[String], handle: &Kind) -> Result<Vec<&'static Kind>, Failure> {
    let mut estimators = kinds(names)?;
    if names.is_empty() {
        estimators.retain(|kind| !kind.needs.edge);
    }
    check_stamps(estimators.iter().copied().chain([handle]))?;
    Ok(estimators)
}

/// The estimators of both velocities.
pub(super) fn with_handle(
    estimators: &[&'static Kind],
    handle: &'static Kind,
) -> Vec<&'static Kind> {
    [estimators, &[handle]].concat()
}

/// Settings that all runs share.
pub(super) fn settings(options: &Compare) -> Result<LoopSettings, Failure> {
    let handle = handle(options.handle_estimator.as_deref())?;
    let estimators = estimators(&options.estimators, handle)?;
    Ok(LoopSettings {
        common: Settings {
            device: options.device.load_to_simulate()?,
            parameters: options.parameters.load(&with_handle(&estimators, handle))?,
            estimators,
            wanted: wanted(&options.scores)?.0,
        },
        handle,
    })
}

/// The scenes of these names without duplicates. Without a name, all environments that this
/// estimator of the handle supports.
pub(super) fn scenes(names: &[String], handle: &Kind) -> Result<Vec<SceneKind>, Failure> {
    if names.is_empty() {
        return Ok(environments_with(handle).collect());
    }
    let scene = |name: &String| {
        named(name, SceneKind::environments()).map_err(|error| match name.parse::<ScenarioName>() {
            Ok(_) => format!("scenario '{name}' cannot close a loop: {error}"),
            Err(_) => error,
        })
    };
    let scenes: Vec<_> = names.iter().map(scene).collect::<Result<_, _>>()?;
    Ok(distinct(&scenes, &[]))
}

/// The cases, rate by rate.
pub(super) fn cases(
    options: &Compare,
    scenes: &[SceneKind],
    seconds: f64,
    keep: bool,
) -> Result<Vec<LoopCase>, Failure> {
    let plant = match options.frictionless {
        true => PlantKind::Frictionless,
        false => PlantKind::Friction,
    };
    let seconds = options.seconds.unwrap_or(seconds);
    let mut cases = Vec::new();
    for rate_hz in distinct(&options.rates, &PAPER_HZ) {
        loop_ticks(rate_hz, seconds)?;
        longer_than_skipped(seconds)?;
        cases.extend(scenes.iter().map(|&scene| LoopCase {
            scene,
            rate_hz,
            plant,
            seed: options.seed,
            seconds,
            keep,
            attribute: keep,
        }));
    }
    Ok(cases)
}
