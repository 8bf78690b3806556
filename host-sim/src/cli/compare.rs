//! `host-sim compare`.

use std::path::Path;

use indicatif::{ProgressBar, ProgressStyle};

use crate::compare::{Case, Cost, Outcome, Settings, compare};
use crate::contest::Row;
use crate::device::Device;
use crate::failure::Failure;
use crate::output::{print_bytes, write_whole};
use crate::parameters::PlantKind;
use crate::report::{self, CaseReport, DeviceFacts, ReportInput, Traces};
use crate::scenario::ScenarioName;
use crate::score::{SKIP_S, Wanted};
use crate::{rows, simulate, table};

use super::arguments::{Compare, is_stdout, kinds, rates, scenarios};
use super::felt;

/// Where the report goes unless told otherwise.
const REPORT: &str = "target/report";

/// Scenarios whose signals the report's figures show.
const DRAWN: [ScenarioName; 3] = [
    ScenarioName::Step,
    ScenarioName::Permanent,
    ScenarioName::Track,
];

pub(super) fn run(options: &Compare, command_line: &str) -> Result<(), Failure> {
    let settings = Settings {
        device: options.device.load()?,
        estimators: kinds(&options.estimators)?,
        parameters: options.parameters.load()?,
        wanted: wanted(&options.scores)?,
    };
    let json_on_stdout = options.json.as_deref().is_some_and(is_stdout);
    let report = report_folder(options);
    let (cases, asked) = cases(options, report.is_some())?;
    let bar = progress(cases.len(), "simulating");
    let outcomes = compare(&cases, &settings, || bar.inc(1))?;
    bar.finish_and_clear();

    if options.timing {
        eprintln!(
            "{}",
            timing(outcomes.iter().map(|outcome| outcome.cost).sum())
        );
    }
    let asked_rows: Vec<Row> = outcomes[..asked]
        .iter()
        .flat_map(|o| o.rows.clone())
        .collect();
    if let Some(path) = &options.json {
        let json = rows::json(&asked_rows)?;
        if json_on_stdout {
            print_bytes(&json)?;
        } else {
            write_whole(path, &json)?;
        }
    }
    if let Some(folder) = report {
        let (closed, remark) = felt::beside(options);
        let input = ReportInput {
            command: command_line.to_owned(),
            device: facts(&settings.device, &options.device.name()),
            notes: remark.into_iter().collect(),
            cases: outcomes.iter().map(case_report).collect(),
            ..ReportInput::default()
        };
        let rows: Vec<Row> = outcomes.iter().flat_map(|o| o.rows.clone()).collect();
        write_whole(&folder.join("scores.json"), &rows::json(&rows)?)?;
        write_whole(
            &folder.join("scores.csv"),
            &rows::csv(&rows, rows::COLUMNS)?,
        )?;
        felt::write(folder, input, closed)?;
    }
    if json_on_stdout {
        return Ok(());
    }
    let mut text = table::overview(&asked_rows);
    if asked <= 2 {
        text = table::details(&asked_rows);
    }
    if let Some(folder) = report {
        text.push_str(&format!(
            "Report: {}\n",
            folder.join("index.html").display()
        ));
    }
    print_bytes(text.as_bytes())
}

/// Where the report goes, if there is one.
pub(super) fn report_folder(options: &Compare) -> Option<&Path> {
    let json_on_stdout = options.json.as_deref().is_some_and(is_stdout);
    match &options.out {
        Some(folder) => Some(folder),
        None if json_on_stdout || options.no_report => None,
        None => Some(Path::new(REPORT)),
    }
}

/// The cases to run, and how many of them were asked for: the rest, at the end, is the other
/// plant for the report.
fn cases(options: &Compare, with_report: bool) -> Result<(Vec<Case>, usize), Failure> {
    let all_but_heating: Vec<_> = ScenarioName::ALL
        .into_iter()
        .filter(|&s| s != ScenarioName::Heating)
        .collect();
    let scenarios = scenarios(&options.scenarios, &all_but_heating)?;
    let plants: &[_] = match (options.frictionless, with_report) {
        (true, _) => &[PlantKind::Frictionless],
        (false, false) => &[PlantKind::Friction],
        (false, true) => &[PlantKind::Friction, PlantKind::Frictionless],
    };
    let mut cases = Vec::new();
    for &plant in plants {
        for rate_hz in rates(&options.rates, &[1e3, 11.6e3]) {
            for &scenario in &scenarios {
                let seconds = options.seconds.unwrap_or(scenario.default_seconds());
                simulate::ticks(rate_hz, seconds)?;
                longer_than_skipped(seconds)?;
                cases.push(Case {
                    scenario,
                    rate_hz,
                    plant,
                    seed: options.seed,
                    seconds,
                    keep: with_report && DRAWN.contains(&scenario),
                });
            }
        }
    }
    let asked = cases.len() / plants.len();
    Ok((cases, asked))
}

/// The scores by their JSON names; all where there is no name.
pub(super) fn wanted(names: &[String]) -> Result<Wanted, Failure> {
    if names.is_empty() {
        return Ok(Wanted::ALL);
    }
    let mut wanted = Wanted::NONE;
    for name in names {
        wanted.add(name)?;
    }
    Ok(wanted)
}

/// Where the time went, in a line.
pub(super) fn timing(cost: Cost) -> String {
    let seconds = cost.simulation.as_secs_f64();
    format!(
        "{} plant steps in {seconds:.2} s ({:.1} million/s a thread), estimators {:.2} s, scores \
         {:.2} s, summed over threads",
        cost.plant_steps,
        1e-6 * cost.plant_steps as f64 / seconds,
        cost.estimation.as_secs_f64(),
        cost.scoring.as_secs_f64(),
    )
}

/// A progress bar on standard error, if that is a terminal.
pub(super) fn progress(length: usize, doing: &'static str) -> ProgressBar {
    let style = ProgressStyle::with_template("{msg} {wide_bar} {pos}/{len} {eta}");
    ProgressBar::new(length as u64)
        .with_style(style.unwrap_or_else(|_| ProgressStyle::default_bar()))
        .with_message(doing)
}

/// Writes the page and its figures.
pub(super) fn write_page(folder: &Path, input: &ReportInput) -> Result<(), Failure> {
    let page = report::html(input)?;
    for (i, figure) in report::figures(&page).enumerate() {
        let name = format!("figures/{:02}.svg", i + 1);
        write_whole(&folder.join(name), figure.as_bytes())?;
    }
    write_whole(&folder.join("index.html"), page.as_bytes())
}

/// What the report says of the device.
pub(super) fn facts(device: &Device, name: &str) -> DeviceFacts {
    DeviceFacts {
        name: name.to_owned(),
        damping: device.coupler.damping_nms_per_rad,
        diameter_m: device.handle.diameter_m,
        threshold_n: device.interval.threshold_n,
        weber: device.interval.weber,
        counts_per_rev: device.large.counts_per_rev,
        more: Vec::new(),
    }
}

fn case_report(outcome: &Outcome) -> CaseReport {
    let row = |row: &Row| report::Row {
        estimator: row.estimator.to_owned(),
        score: row.score,
        percent: row.percent,
    };
    let traces = outcome.signals.as_ref().map(|(trace, estimates)| Traces {
        t0: 0.0,
        rate_hz: trace.rate_hz,
        truth: trace.true_omega.clone().unwrap_or_default(),
        estimates: estimates
            .iter()
            .map(|e| (e.estimator.to_owned(), e.velocity.clone()))
            .collect(),
    });
    CaseReport {
        scenario: outcome.case.scenario.as_str().to_owned(),
        rate_hz: outcome.case.rate_hz,
        friction: outcome.case.plant == PlantKind::Friction,
        seed: outcome.case.seed,
        rows: outcome.rows.iter().map(row).collect(),
        traces,
        damping: outcome.damping.clone(),
    }
}

/// Refuses runs of which nothing would be scored.
pub(super) fn longer_than_skipped(seconds: f64) -> Result<(), Failure> {
    if seconds > SKIP_S {
        return Ok(());
    }
    Err(Failure::Input(format!(
        "duration {seconds} s: scores begin after {SKIP_S} s; use --seconds with more"
    )))
}
