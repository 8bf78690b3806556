//! Every estimator on every recording.

use serde::Serialize;

use catalogue::estimators::{DIFFERENCE, Kind, Setup};
use catalogue::parameters::{Parameters, PlantKind};
use scoring::evaluation::{self, Estimate, Evaluation, Heading};
use scoring::score::Wanted;
use simulation::device::Device;
use simulation::trace::Trace;
use terminal::failure::Failure;

use super::cases::{Case, Recordings};
use super::rest::{moving_at_rest, rest};
use super::sources::Role;
use crate::compare::interval;
use crate::parallel::in_order;

/// What to run.
#[derive(Clone, Debug)]
pub struct Settings {
    /// Estimators, in the order of the tables.
    pub estimators: Vec<&'static Kind>,
    /// Their parameters.
    pub parameters: Parameters,
    /// The device that the estimators are designed for; its counts per revolution are replaced.
    pub device: Device,
    /// Counts per revolution of the coarse encoder.
    pub counts_per_rev: Vec<u32>,
    /// Rates of the ticks, Hz.
    pub rates_hz: Vec<f64>,
    /// Phases of the coarse encoder, counts.
    pub phases: Vec<f64>,
    /// The part of each recording that is used, s from its start.
    pub seconds: f64,
}

/// Scores of one estimator in one run: an object of the JSON output, a row of the CSV.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Row {
    /// Name of the recording.
    pub recording: String,
    /// Role of the recording.
    pub role: Role,
    /// Resolution of the encoder that the estimator reads, counts per revolution.
    pub counts_per_rev: u32,
    /// Rate, Hz.
    pub rate_hz: f64,
    /// Phase of the coarse encoder, counts; `None` for a recording of a coarse encoder.
    pub phase: Option<f64>,
    /// Estimator.
    pub estimator: &'static str,
    /// Scores.
    #[serde(flatten)]
    pub score: Score,
}

/// Scores of one estimator in one run, or their means.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Score {
    /// Root mean square of the error, rad/s.
    pub rms_rad_s: Option<f64>,
    /// The same in % of finite difference on the same samples.
    pub rms_pct: Option<f64>,
    /// 99th percentile of the error's magnitude, rad/s.
    pub p99_rad_s: Option<f64>,
    /// The same in % of finite difference on the same samples.
    pub p99_pct: Option<f64>,
    /// Delay, ms.
    pub delay_ms: Option<f64>,
    /// Share of the samples at rest with an estimate above [`super::rest::MOTION_RAD_S`], 0 to 1; `None` for a
    /// recording without rest.
    pub moving_at_rest: Option<f64>,
}

/// Rows of one run, and its signals.
#[derive(Clone, Debug)]
pub struct Outcome {
    /// The run.
    pub case: Case,
    /// One row per estimator whose needed signals the recording has.
    pub rows: Vec<Row>,
    /// The recording and the estimates, if they are kept.
    pub signals: Option<(Trace, Vec<Estimate>)>,
}

/// Runs all `cases` in parallel and calls `done` after each. The outcomes have the order of the
/// cases, and the signals of those that `keep` selects.
///
/// # Errors
/// [`Failure::Input`] of the first case, in order, that cannot be run.
pub fn run(
    recordings: &Recordings,
    cases: &[Case],
    settings: &Settings,
    keep: impl Fn(&Case) -> bool + Sync,
    done: &(dyn Fn() + Sync),
) -> Result<Vec<Outcome>, Failure> {
    let one = |case: &Case| {
        let outcome = outcome(recordings, case, settings, keep(case));
        done();
        outcome
    };
    in_order(cases, one)
}

fn outcome(
    recordings: &Recordings,
    case: &Case,
    settings: &Settings,
    keep: bool,
) -> Result<Outcome, Failure> {
    let trace = recordings.recording(case)?.trace;
    let device = case.device(&settings.device);
    let setup = Setup::of(&device, trace.rate_hz);
    // A real device has friction.
    let plant = PlantKind::Friction;
    let mut kinds = settings.estimators.clone();
    let difference = Kind::named(DIFFERENCE)?;
    if !kinds.iter().any(|kind| kind.name == difference.name) {
        kinds.push(difference);
    }
    let evaluation = Evaluation::new(&kinds, &settings.parameters, &setup, plant)?;
    let estimates = evaluation.estimates(&trace);
    let heading = Heading {
        scenario: case.name.clone(),
        rate_hz: trace.rate_hz,
        plant,
        seed: 0,
    };
    let wanted = Wanted {
        rms: true,
        p99: true,
        delay: true,
        ..Wanted::NONE
    };
    let scored = evaluation.rows(&heading, &trace, &estimates, interval(&device), wanted)?;
    let of_difference = scored.iter().find(|row| row.estimator == difference.name);
    let whole = of_difference.and_then(|row| row.score.p99_rad_s);
    let rest = rest(
        trace.true_omega.as_deref().unwrap_or_default(),
        trace.rate_hz,
    );
    let row = |(row, estimate): (&evaluation::Row, &Estimate)| Row {
        recording: case.name.clone(),
        role: case.role,
        counts_per_rev: case.counts_per_rev,
        rate_hz: case.rate_hz,
        phase: case.phase,
        estimator: row.estimator,
        score: Score {
            rms_rad_s: row.score.rms_rad_s,
            rms_pct: row.score.rms_pct,
            p99_rad_s: row.score.p99_rad_s,
            p99_pct: whole.filter(|whole| *whole > 0.0).and_then(|whole| {
                let own = row.score.p99_rad_s?;
                Some(100.0 * own / whole)
            }),
            delay_ms: row.score.delay_ms,
            moving_at_rest: moving_at_rest(&estimate.velocity, &rest),
        },
    };
    let asked = |name: &str| settings.estimators.iter().any(|kind| kind.name == name);
    let rows = scored.iter().zip(&estimates);
    let rows = rows.filter(|(row, _)| asked(row.estimator)).map(row);
    Ok(Outcome {
        case: case.clone(),
        rows: rows.collect(),
        signals: keep.then_some((trace, estimates)),
    })
}
