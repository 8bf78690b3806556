//! Which estimator to use on a device of which only recordings exist.

mod table;
#[cfg(test)]
mod tests;

use std::collections::BTreeMap;

use serde::Serialize;

use catalogue::estimators::{Kind, Setup};
use catalogue::parameters::{Parameters, PlantKind};
use device_files::six_digits;
use recordings::recording::Recording;
use scoring::evaluation::{Estimate, Row};
use scoring::score::{SKIP_S, rms_scored};
use simulation::device::Device;
use terminal::failure::Failure;

use crate::designed::{designed, with_friction};
use crate::parallel::in_order;
use crate::rates::{check_same, refuses};
use crate::reference::{FEWEST_ROWS, Reference, remarks};
use crate::replay;

pub use table::{lines, reads, table};

/// Errors that differ by less than this part are equal: the cheaper estimator is named.
const EQUAL: f64 = 0.01;

/// Instructions per update on a Cortex-M4F.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Cost {
    /// Mean over the traces of the measurement.
    #[serde(rename = "instructions_mean")]
    pub mean: f64,
    /// Largest number of one update.
    #[serde(rename = "instructions_most")]
    pub most: f64,
}

/// The measured cost of an estimator with these parameters.
pub type Measured = fn(&str, &BTreeMap<&'static str, f64>) -> Option<Cost>;

/// What to compare.
pub struct Settings<'a> {
    /// The device; only its counts per revolution are used unless it `is_known`.
    pub device: &'a Device,
    /// Whether the device's constants are those of the recorded device.
    pub is_known: bool,
    /// Parameters of the estimators.
    pub parameters: &'a Parameters,
    /// Largest number of instructions per update of the cheap estimator.
    pub budget: f64,
    /// Measured cost of an estimator with these parameters.
    pub cost: Measured,
}

/// Scores on one recording.
#[derive(Clone, Debug, Serialize)]
pub struct OnLog {
    /// Name of the recording.
    pub log: String,
    /// Root mean square of the error, rad/s.
    pub rms_rad_s: f64,
    /// The same in % of finite difference.
    pub rms_pct: f64,
    /// 99th percentile of the error's magnitude, rad/s.
    pub p99_rad_s: f64,
    /// Delay, ms.
    pub delay_ms: Option<f64>,
    /// RMS of the standard deviation that the estimator reports, rad/s.
    pub sd_rad_s: Option<f64>,
    /// `truth` or `reference`.
    pub against: &'static str,
    /// RMS of the reference's standard deviation, rad/s; `None` for the truth.
    pub reference_sd_rad_s: Option<f64>,
    /// `constant` or `varying`: the steps of `t`.
    pub period: &'static str,
}

/// One estimator: an object of the JSON output.
#[derive(Clone, Debug, Serialize)]
pub struct Ranked {
    /// Its name.
    pub estimator: &'static str,
    /// `best`, `cheap`, or nothing.
    pub recommended: Option<&'static str>,
    /// Geometric mean over the recordings of the RMS error in % of finite difference.
    pub rms_pct: f64,
    /// RMS over the recordings of the RMS error, rad/s.
    pub rms_rad_s: f64,
    /// Largest 99th percentile of a recording, rad/s.
    pub p99_rad_s: f64,
    /// Mean delay, ms.
    pub delay_ms: Option<f64>,
    /// RMS over the recordings of the standard deviation that the estimator reports, rad/s.
    pub sd_rad_s: Option<f64>,
    /// Instructions per update; `None` if they were not measured.
    pub cost: Option<Cost>,
    /// Signals that it reads besides the counts.
    pub reads: Vec<&'static str>,
    /// Its parameters.
    pub parameters: BTreeMap<&'static str, f64>,
    /// Lines for the user's program.
    pub rust: String,
    /// The scores on each recording.
    pub logs: Vec<OnLog>,
}

/// One recording with what was computed from it.
#[derive(Debug)]
pub struct Outcome<'a> {
    /// Its path, for messages.
    pub name: &'a str,
    /// The recording.
    pub recording: &'a Recording,
    /// The reference, if there is no true velocity.
    pub reference: Option<Reference>,
    /// The velocities of all estimators that ran.
    pub estimates: Vec<Estimate>,
    rows: Vec<Row>,
}

impl Outcome<'_> {
    /// The velocity that the scores are against, rad/s.
    #[must_use]
    pub fn omega(&self) -> &[f64] {
        match (&self.recording.trace.true_omega, &self.reference) {
            (Some(truth), _) => truth,
            (None, Some(reference)) => &reference.omega,
            (None, None) => &[],
        }
    }
}

/// The estimators on all recordings.
#[derive(Debug)]
pub struct Recommendation<'a> {
    /// The estimators, the smallest error first.
    pub ranked: Vec<Ranked>,
    /// The recordings.
    pub outcomes: Vec<Outcome<'a>>,
    /// What was left out, and what the scores do not say: one line each.
    pub notes: Vec<String>,
}

/// Runs all estimators whose signals and whose rate every one of `logs` has, as shipped, and ranks
/// them.
///
/// # Errors
/// [`Failure::Input`] that names the recording, if it is too short, has another rate than the first one
/// or determines no reference.
pub fn recommend<'a>(
    logs: &'a [(String, Recording)],
    settings: &Settings,
    done: &(dyn Fn() + Sync),
) -> Result<Recommendation<'a>, Failure> {
    check_same((logs.iter()).map(|(name, log)| (name.as_str(), log.trace.rate_hz)))?;
    let runs = |kind: &Kind, log: &Recording| {
        let rate_hz = log.trace.rate_hz;
        let is_off = refuses(kind, rate_hz, settings.device, settings.parameters);
        kind.lack(&log.trace).is_none() && !is_off
    };
    let has = |kind: &Kind| logs.iter().all(|(_, log)| runs(kind, log));
    let able: Vec<&'static Kind> = Kind::all().iter().filter(|kind| has(kind)).collect();
    let place = |log: &Recording| with_friction(settings.device, log.trace.rate_hz);
    let places: Vec<_> = logs.iter().map(|(_, log)| place(log)).collect();
    let (able, _) = designed(&able, settings.parameters, &places);
    let (kinds, of_device): (Vec<_>, Vec<_>) = able
        .into_iter()
        .partition(|kind| settings.is_known || !kind.needs_device());
    let outcomes = in_order(logs, |(name, recording)| {
        outcome(name, recording, &kinds, settings, done)
    })?;
    let mut notes = Vec::new();
    if !of_device.is_empty() {
        let names: Vec<_> = of_device.iter().map(|kind| kind.name).collect();
        notes.push(format!(
            "estimators with constants of the device left out: {}; --device FILE.toml includes them",
            names.join(", ")
        ));
    }
    for outcome in &outcomes {
        let rate_hz = outcome.recording.trace.rate_hz;
        let counts_per_rev = settings.device.stages.large.counts_per_rev;
        let said = remarks(
            outcome.recording,
            outcome.reference.as_ref(),
            counts_per_rev,
        );
        notes.extend((said.iter()).map(|line| format!("{}: {line}", outcome.name)));
        if let Some(reference) = &outcome.reference {
            let limits = reference.limits(rate_hz);
            notes.push(format!(
                "{}: no column true_omega; scores are against a reference: {limits}",
                outcome.name
            ));
            let scores = outcome
                .rows
                .iter()
                .filter_map(|row| Some((row.estimator, row.score.rms_rad_s?)));
            let close: Vec<_> = scores
                .filter(|(_, rms)| !reference.resolves(*rms, rate_hz))
                .map(|(name, _)| name)
                .collect();
            if close.len() > 1 {
                notes.push(format!(
                    "{}: not ranked among each other: {}",
                    outcome.name,
                    close.join(", ")
                ));
            }
        }
    }
    let mut ranked: Vec<Ranked> = kinds
        .iter()
        .filter_map(|kind| ranked(kind, &outcomes, settings))
        .collect();
    ranked.sort_by(|a, b| a.rms_pct.total_cmp(&b.rms_pct));
    if let Some(best) = chosen(&ranked, f64::INFINITY) {
        ranked[best].recommended = Some("best");
        let cheap = chosen(&ranked, settings.budget).filter(|cheap| *cheap != best);
        if let Some(cheap) = cheap {
            ranked[cheap].recommended = Some("cheap");
        }
    }
    Ok(Recommendation {
        ranked,
        outcomes,
        notes,
    })
}

fn outcome<'a>(
    name: &'a str,
    recording: &'a Recording,
    kinds: &[&'static Kind],
    settings: &Settings,
    done: &(dyn Fn() + Sync),
) -> Result<Outcome<'a>, Failure> {
    let failed = |why: String| Failure::Input(format!("{name}: {why}"));
    let rows = recording.t.len();
    let rate_hz = recording.trace.rate_hz;
    let passed = (2.0 * SKIP_S * rate_hz) as usize + 1;
    if rows < FEWEST_ROWS.max(passed) {
        let rate = match passed > FEWEST_ROWS {
            true => format!(
                ", {} s at {rate_hz} rows a second; check the unit of t if this is not the rate",
                2.0 * SKIP_S
            ),
            false => String::new(),
        };
        return Err(failed(format!(
            "{rows} rows; scores need at least {}{rate}",
            FEWEST_ROWS.max(passed)
        )));
    }
    let reference = match &recording.trace.true_omega {
        Some(_) => None,
        None => {
            let counts_per_rev = settings.device.stages.large.counts_per_rev;
            Some(Reference::of(recording, counts_per_rev).map_err(failed)?)
        }
    };
    let (device, parameters) = (settings.device, settings.parameters);
    let replayed = replay::replay_against(
        reference.as_ref(),
        recording,
        name,
        kinds,
        device,
        parameters,
        done,
    )?;
    Ok(Outcome {
        name,
        recording,
        reference,
        estimates: replayed.estimates,
        rows: replayed.rows,
    })
}

/// The scores of one estimator; `None` if one is not finite.
fn ranked(kind: &'static Kind, outcomes: &[Outcome], settings: &Settings) -> Option<Ranked> {
    let logs: Option<Vec<OnLog>> = outcomes
        .iter()
        .map(|outcome| on_log(kind, outcome))
        .collect();
    let logs = logs?;
    let n = logs.len() as f64;
    let mean = |of: &dyn Fn(&OnLog) -> Option<f64>| -> Option<f64> {
        let values: Option<Vec<f64>> = logs.iter().map(of).collect();
        Some(values?.iter().sum::<f64>() / n)
    };
    let first = outcomes.first()?;
    let parameters = first
        .rows
        .iter()
        .find(|row| row.estimator == kind.name)?
        .parameters
        .clone();
    // Six digits: steps of a clock that are rounded in the log do not give a rate of 999.9999.
    let rate_hz = six_digits(first.recording.trace.rate_hz);
    let setup = Setup::of(settings.device, rate_hz);
    let values = settings
        .parameters
        .values(kind, &setup, PlantKind::Friction);
    Some(Ranked {
        estimator: kind.name,
        recommended: None,
        rms_pct: mean(&|log| Some(log.rms_pct.ln()))?.exp(),
        rms_rad_s: mean(&|log| Some(log.rms_rad_s.powi(2)))?.sqrt(),
        p99_rad_s: logs.iter().map(|log| log.p99_rad_s).fold(0.0, f64::max),
        delay_ms: mean(&|log| log.delay_ms),
        sd_rad_s: mean(&|log| Some(log.sd_rad_s?.powi(2))).map(f64::sqrt),
        cost: (settings.cost)(kind.name, &parameters),
        reads: reads(kind),
        parameters,
        rust: kind.rust(&setup, &values),
        logs,
    })
}

fn on_log(kind: &Kind, outcome: &Outcome) -> Option<OnLog> {
    let row = outcome.rows.iter().find(|row| row.estimator == kind.name)?;
    let estimate = outcome
        .estimates
        .iter()
        .find(|e| e.estimator == kind.name)?;
    let rate_hz = outcome.recording.trace.rate_hz;
    let finite = |value: Option<f64>| value.filter(|value| value.is_finite());
    Some(OnLog {
        log: outcome.file(),
        rms_rad_s: finite(row.score.rms_rad_s)?,
        rms_pct: finite(row.score.rms_pct)?,
        p99_rad_s: finite(row.score.p99_rad_s)?,
        delay_ms: row.score.delay_ms,
        sd_rad_s: estimate.deviation.as_ref().map(|sd| {
            let known = outcome.reference.as_ref().and_then(|r| r.known.as_deref());
            rms_scored(sd, rate_hz, known)
        }),
        against: if outcome.reference.is_some() {
            "reference"
        } else {
            "truth"
        },
        reference_sd_rad_s: outcome
            .reference
            .as_ref()
            .map(|reference| reference.rms_sd(rate_hz)),
        period: replay::period(&outcome.recording.trace),
    })
}

/// Of the estimators within `budget` instructions, the one with the smallest error, or a cheaper one
/// with an equal error. An estimator whose cost is not known is within an infinite budget only.
fn chosen(ranked: &[Ranked], budget: f64) -> Option<usize> {
    let most = |i: &usize| ranked[*i].cost.map_or(f64::INFINITY, |cost| cost.most);
    let within = || (0..ranked.len()).filter(|i| most(i) <= budget);
    let least = ranked[within().next()?].rms_pct;
    let equal = within().filter(|i| ranked[*i].rms_pct <= (1.0 + EQUAL) * least);
    equal.min_by(|a, b| most(a).total_cmp(&most(b)))
}
