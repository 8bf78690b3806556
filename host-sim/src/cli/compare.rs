//! `host-sim compare`.

use std::path::{Path, PathBuf};

use clap::Args;

use catalogue::parameters::{Parameters, PlantKind};
use experiments::closed_loop::LOWEST_RATE_HZ;
use experiments::compare::{Case, Cost, Outcome, Settings, compare, setup_of};
use experiments::designed::at_range_ends;
use experiments::rows;
use experiments::table;
use experiments::table::layout::terminal_width;
use haptic_control::SceneKind;
use recordings::arguments::DeviceFile;
use report::measured;
use report::{self, CaseReport, ReportInput, Traces};
use scoring::evaluation::Row;
use scoring::score::{Field, SKIP_S, Score, Wanted};
use simulation::device::Device;
use simulation::scenario::{Role, ScenarioName};
use simulation::simulate;
use terminal::failure::Failure;
use terminal::output::{Folder, note};

use super::arguments::{
    ParameterOptions, distinct, handle_help, kinds, kinds_at, scenarios, seconds_help,
};
use super::closed_loop;
use super::page::{self, progress};
use super::rates::{PAPER_HZ, repeatable};
use super::report_extras::{ReportExtras, report_extras};

/// Default folder of the report.
pub(super) const REPORT: &str = "target/report";

/// Scenarios whose signals the report's figures show.
const DRAWN: Role = Role::Tuning;

/// Help text of `--scenario`, with the names of the scenes.
fn scenario_help() -> String {
    let scenes: Vec<_> = SceneKind::environments().map(SceneKind::name).collect();
    let compared = ScenarioName::compared();
    let others = ScenarioName::ALL.into_iter();
    let others = others.filter(|scenario| !compared.contains(scenario));
    let others: Vec<_> = others.map(ScenarioName::as_str).collect();
    format!(
        "Scenario to run, see host-sim scenarios; repeatable [default: all except {}]. With \
         --closed-loop, scene to run: {} [default: all]",
        others.join(", "),
        scenes.join(", ")
    )
}

/// Help text of `--rate`.
fn rate_help() -> String {
    format!(
        "{}, with --closed-loop from {LOWEST_RATE_HZ} Hz on{}",
        super::rates::rate_help(),
        repeatable(&PAPER_HZ)
    )
}

#[derive(Debug, Args)]
pub(super) struct Compare {
    /// Score the rendered force in closed loop: the velocity of each estimator in turn, and then
    /// that of the reference encoder, controls the motors in the scenes
    #[arg(long)]
    pub(super) closed_loop: bool,
    #[arg(long = "scenario", visible_alias = "scene", value_name = "NAME", help = scenario_help())]
    pub(super) scenarios: Vec<String>,
    #[arg(long, value_name = "NAME", requires = "closed_loop", help = handle_help(", only with --closed-loop"))]
    pub(super) handle_estimator: Option<String>,
    #[arg(long = "rate", value_name = "HZ", help = rate_help())]
    pub(super) rates: Vec<f64>,
    /// Estimator to run, see host-sim estimators; repeatable [default: all]
    #[arg(long = "estimator", value_name = "NAME")]
    pub(super) estimators: Vec<String>,
    /// Seed of all random numbers; seeds from 2^32 on are reserved for host-sim tune
    #[arg(long, value_name = "N", default_value_t = 1)]
    pub(super) seed: u64,
    #[arg(long, value_name = "S", help = seconds_help())]
    pub(super) seconds: Option<f64>,
    /// Simulate the plant without Coulomb friction
    #[arg(long)]
    pub(super) frictionless: bool,
    #[command(flatten)]
    pub(super) device: DeviceFile,
    #[command(flatten)]
    pub(super) parameters: ParameterOptions,
    #[arg(long = "score", value_name = "NAME", help = score_help())]
    pub(super) scores: Vec<String>,
    /// Folder of the report: index.html, figures as SVG, scores.csv, scores.json [default:
    /// target/report; no report with --json -]
    #[arg(long, value_name = "DIR")]
    pub(super) out: Option<PathBuf>,
    /// Write no report; the plant without friction, which only the report shows, is not simulated
    #[arg(long, conflicts_with = "out")]
    pub(super) no_report: bool,
    /// Write the scores as JSON to FILE; - is standard output, which then has nothing else
    #[arg(long, value_name = "FILE")]
    pub(super) json: Option<PathBuf>,
    /// Print to standard error how long simulation, estimators and scores took
    #[arg(long)]
    pub(super) timing: bool,
}

impl Default for Compare {
    fn default() -> Self {
        Self {
            closed_loop: false,
            scenarios: Vec::new(),
            handle_estimator: None,
            rates: Vec::new(),
            estimators: Vec::new(),
            seed: 1,
            seconds: None,
            frictionless: false,
            device: DeviceFile::default(),
            parameters: ParameterOptions::default(),
            scores: Vec::new(),
            out: None,
            no_report: false,
            json: None,
            timing: false,
        }
    }
}

pub(super) fn run(options: &Compare, command_line: &str) -> Result<(), Failure> {
    let (wanted, asked_fields) = wanted(&options.scores)?;
    let report = report_folder(options)?;
    let (cases, asked) = cases(options, report.is_some())?;
    let (device, parameters) = (
        options.device.load_to_simulate()?,
        options.parameters.load(&kinds(&options.estimators)?)?,
    );
    let settings = settings(&options.estimators, &cases, device, parameters, wanted)?;
    let bar = progress(cases.len(), "simulating");
    let outcomes = compare(&cases, &settings, &|| bar.inc(1))?;
    bar.finish_and_clear();

    if options.timing {
        let cost = outcomes.iter().map(|outcome| outcome.cost).sum();
        note(timing(cost));
    }
    for line in outcomes[..asked].iter().filter_map(at_rest) {
        note(format_args!("note: {line}"));
    }
    let asked_rows: Vec<Row> = outcomes[..asked]
        .iter()
        .flat_map(|o| o.rows.clone())
        .collect();
    let mut index = None;
    if let Some(folder) = report {
        let (closed, remark) = closed_loop::for_report(options);
        let ReportExtras {
            limits,
            constant_errors,
            warming,
        } = report_extras(options, &settings, &cases)?;
        let input = ReportInput {
            command: command_line.to_owned(),
            device_name: options.device.name(),
            device: settings.device.clone(),
            notes: remark.into_iter().collect(),
            cases: outcomes.iter().map(case_report).collect(),
            limits,
            parameter_errors: constant_errors,
            heating: warming,
            ..ReportInput::default()
        };
        let rows: Vec<Row> = outcomes.iter().flat_map(|o| o.rows.clone()).collect();
        let mut files = Folder::new(folder);
        files.add("scores.json", rows::json(&rows)?);
        files.add("scores.csv", rows::csv(&rows)?);
        index = Some(closed_loop::write(files, input, closed)?);
    }
    let width = terminal_width();
    let mut text = match asked {
        0..=2 => table::details(&asked_rows, &asked_fields, width),
        _ => table::overview(&asked_rows, &asked_fields, width),
    };
    if let Some(index) = index {
        text.push_str(&format!("Report: {}\n", index.display()));
    }
    page::print(options.json.as_deref(), &rows::json(&asked_rows)?, &text)
}

/// A line on a motor that does not move; `None` for one that moves.
fn at_rest(outcome: &Outcome) -> Option<String> {
    let Case {
        scenario,
        rate_hz,
        plant,
        ..
    } = outcome.case;
    let friction = match plant {
        PlantKind::Friction => "large.coulomb_nm is",
        PlantKind::Frictionless => "large.inertia_kg_m2 and coupler.damping_nms_per_rad are",
    };
    (!outcome.moves).then(|| {
        format!(
            "{scenario} at {rate_hz} Hz: the motor does not move by a count, so that there is no delay and no score in % \
             of finite difference; {friction} too large for large.torque_constant_nm_per_a and large.current_limit_a, \
             or large.counts_per_rev too small"
        )
    })
}

/// The settings of `cases`, with the estimators of these names; if no name is given, all that run in every
/// case.
pub(super) fn settings(
    names: &[String],
    cases: &[Case],
    device: Device,
    parameters: Parameters,
    wanted: Wanted,
) -> Result<Settings, Failure> {
    let place = |case: &Case| (setup_of(case, &device), case.plant);
    let places: Vec<_> = cases.iter().map(place).collect();
    let estimators = kinds_at(names, &parameters, &places)?;
    if let Some(line) = at_range_ends(&estimators, &parameters, &places) {
        note(format_args!("note: {line}"));
    }
    Ok(Settings {
        estimators,
        device,
        parameters,
        wanted,
    })
}

/// Folder of the report, if a report is written.
pub(super) fn report_folder(options: &Compare) -> Result<Option<&Path>, Failure> {
    if options.no_report {
        return Ok(None);
    }
    page::folder(options.out.as_deref(), options.json.as_deref(), REPORT)
}

/// The cases to run, and the number of requested cases among them. The requested cases come first.
/// The others simulate the plant without friction for the report.
fn cases(options: &Compare, with_report: bool) -> Result<(Vec<Case>, usize), Failure> {
    let scenarios = scenarios(&options.scenarios, &ScenarioName::compared())?;
    let plants: &[_] = match (options.frictionless, with_report) {
        (true, _) => &[PlantKind::Frictionless],
        (false, false) => &[PlantKind::Friction],
        (false, true) => &[PlantKind::Friction, PlantKind::Frictionless],
    };
    let mut cases = Vec::new();
    for &plant in plants {
        for rate_hz in distinct(&options.rates, &PAPER_HZ) {
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
                    keep: with_report && scenario.role() == DRAWN,
                });
            }
        }
    }
    let asked = cases.len() / plants.len();
    Ok((cases, asked))
}

/// The computations that the scores of these JSON names need, and the columns of these scores.
/// Without a name: all computations and no column.
pub(super) fn wanted(names: &[String]) -> Result<(Wanted, Vec<&'static Field<Score>>), Failure> {
    if names.is_empty() {
        return Ok((Wanted::ALL, Vec::new()));
    }
    let mut wanted = Wanted::NONE;
    let fields: Result<_, String> = names.iter().map(|name| wanted.add(name)).collect();
    Ok((wanted, fields?))
}

/// Help text of `--score`, with the names of the scores.
fn score_help() -> String {
    let each: String = Score::FIELDS
        .iter()
        .map(|field| format!("\n{}: {}", field.name, field.sentence()))
        .collect();
    format!(
        "Score to compute and show, for example --score rms_pct; repeatable [default: all]. The \
         scores are:{each}"
    )
}

/// Run time of simulation, estimators and scores in one line.
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

/// Converts an outcome to the input of the report.
pub(super) fn case_report(outcome: &Outcome) -> CaseReport {
    let row = |row: &Row| report::EstimatorRow {
        estimator: row.estimator.to_owned(),
        score: row.score,
        instructions: measured::instructions(row.estimator, &row.parameters),
    };
    let traces = outcome.signals.as_ref().map(|(trace, estimates)| Traces {
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

/// Refuses runs that are too short to be scored.
pub(super) fn longer_than_skipped(seconds: f64) -> Result<(), Failure> {
    if seconds > SKIP_S {
        return Ok(());
    }
    Err(Failure::Input(format!(
        "duration {seconds} s: scores begin after {SKIP_S} s; give a longer --seconds"
    )))
}
