//! Velocity algorithms of other projects on recordings of a fine encoder.
//!
//! A project runs its algorithm at its own rate, which may be above that of the rows of a recording.
//! The coarse encoder is then read at that rate, with a straight line between two rows, and the
//! velocity at a tick is the newest one at or before the tick. Recordings of a coarse encoder are left
//! out: they have no count between two rows, and most projects read Hall sensors in another way.

mod list;
mod path;
mod tune;

use estimator_core::FiniteDifference;
use scoring::evaluation::Evaluation;
use scoring::score::{Truth, Wanted};
use simulation::trace::Trace;
use terminal::failure::Failure;

pub use list::{PEERS, PLL, Parameter, Peer};
pub use path::Path;
pub use tune::{Tuned, tune};

use super::cases::{Case, Recordings};
use super::rest::{moving_at_rest, rest};
use super::run::{Row, Score, Settings};
use crate::compare::interval;
use crate::parallel::in_order;

/// The scores of a row.
const WANTED: Wanted = Wanted {
    rms: true,
    p99: true,
    delay: true,
    ..Wanted::NONE
};

/// The recording of a case at its ticks, ready to score velocities.
struct Scored<'a> {
    trace: &'a Trace,
    truth: Truth<'a>,
    rest: Vec<bool>,
    /// RMS and 99th percentile of the finite difference's error, rad/s.
    difference: [Option<f64>; 2],
}

impl<'a> Scored<'a> {
    fn new(
        trace: &'a Trace,
        case: &Case,
        settings: &Settings,
        wanted: Wanted,
    ) -> Result<Self, Failure> {
        let omega = trace.true_omega.as_deref().unwrap_or_default();
        let interval = interval(&settings.device);
        let truth = Truth::new(omega, trace.rate_hz, interval, wanted)
            .map_err(|error| Failure::Input(format!("{}: {error}", case.name)))?;
        let path = Path::new(trace, trace.rate_hz, trace.len(), case.counts_per_rev);
        let difference = truth.score(&path.velocities(&FiniteDifference));
        Ok(Self {
            trace,
            truth,
            rest: rest(omega, trace.rate_hz),
            difference: [difference.rms_rad_s, difference.p99_rad_s],
        })
    }

    /// The scores of velocities at the ticks, rad/s.
    fn score(&self, velocity: &[f32]) -> Score {
        let score = self.truth.score(velocity);
        let percent = |own: Option<f64>, whole: Option<f64>| {
            let whole = whole.filter(|whole| *whole > 0.0)?;
            Some(100.0 * own? / whole)
        };
        let [rms, p99] = self.difference;
        Score {
            rms_rad_s: score.rms_rad_s,
            rms_pct: percent(score.rms_rad_s, rms),
            p99_rad_s: score.p99_rad_s,
            p99_pct: percent(score.p99_rad_s, p99),
            delay_ms: score.delay_ms,
            moving_at_rest: moving_at_rest(velocity, &self.rest),
        }
    }
}

/// Names of the rows of `peers`: each with its defaults, then with tuned values if it has some.
#[must_use]
pub fn names(peers: &[Peer], tuned: &[Tuned]) -> Vec<&'static str> {
    let of = |peer: &Peer| {
        let has = tuned.iter().any(|tuned| tuned.peer == peer.name);
        [Some(peer.name), has.then_some(peer.tuned)]
    };
    peers.iter().flat_map(of).flatten().collect()
}

/// The tuned values with the names of their parameters.
#[must_use]
pub fn shown(peers: &[Peer], tuned: &Tuned) -> String {
    let peer = peers.iter().find(|peer| peer.name == tuned.peer);
    let parameters = peer.map_or(&[][..], |peer| peer.parameters);
    let values = parameters.iter().zip(&tuned.values);
    let shown: Vec<_> = values
        .map(|(parameter, value)| format!("{} {value}", parameter.name))
        .collect();
    shown.join(", ")
}

fn row(case: &Case, estimator: &'static str, score: Score) -> Row {
    Row {
        recording: case.name.clone(),
        role: case.role,
        counts_per_rev: case.counts_per_rev,
        rate_hz: case.rate_hz,
        phase: case.phase,
        estimator,
        score,
    }
}

/// Scores of `peers` in every one of `cases` that has a fine encoder: with the defaults of their
/// projects, and with `tuned` values where there are some for the case.
///
/// # Errors
/// [`Failure::Input`] of the first case, in order, that cannot be run.
pub fn rows(
    recordings: &Recordings,
    cases: &[Case],
    settings: &Settings,
    peers: &[Peer],
    tuned: &[Tuned],
) -> Result<Vec<Row>, Failure> {
    let of_case = |case: &&Case| -> Result<Vec<Row>, Failure> {
        let trace = recordings.recording(case)?.trace;
        let scored = Scored::new(&trace, case, settings, WANTED)?;
        let mut rows = Vec::new();
        for peer in peers {
            let path = path::of(recordings, case, peer, &trace)?;
            let mut add = |name, values: &[f64]| {
                rows.push(row(case, name, scored.score(&(peer.run)(&path, values))));
            };
            add(peer.name, &peer.defaults());
            if let Some(tuned) = tuned.iter().find(|tuned| tuned.is_for(peer, case)) {
                add(peer.tuned, &tuned.values);
            }
        }
        Ok(rows)
    };
    let fine: Vec<_> = cases.iter().filter(|case| case.phase.is_some()).collect();
    Ok(in_order(&fine, of_case)?.into_iter().flatten().collect())
}

/// Scores of the estimators of `settings`, as they are shipped, that run at `rate_hz` in every one of
/// `cases` that has a fine encoder, and are read at its ticks as a peer is.
///
/// # Errors
/// [`Failure::Input`] of the first case, in order, that cannot be run.
pub fn ours_at(
    recordings: &Recordings,
    cases: &[Case],
    settings: &Settings,
    rate_hz: f64,
) -> Result<Vec<Row>, Failure> {
    let of_case = |case: &&Case| -> Result<Vec<Row>, Failure> {
        let trace = recordings.recording(case)?.trace;
        let scored = Scored::new(&trace, case, settings, WANTED)?;
        let fast = recordings.recording_at(case, rate_hz)?.trace;
        let ticks = path::ticks(
            scored.trace.rate_hz,
            scored.trace.len(),
            rate_hz,
            fast.len(),
        );
        let device = case.device(&settings.device);
        let setup = catalogue::estimators::Setup::of(&device, rate_hz);
        let plant = catalogue::parameters::PlantKind::Friction;
        let evaluation =
            Evaluation::new(&settings.estimators, &settings.parameters, &setup, plant)?;
        let estimates = evaluation.estimates(&fast);
        let rows = estimates.iter().map(|estimate| {
            let velocity: Vec<f32> = ticks.iter().map(|&k| estimate.velocity[k]).collect();
            row(case, estimate.estimator, scored.score(&velocity))
        });
        Ok(rows.collect())
    };
    let fine: Vec<_> = cases.iter().filter(|case| case.phase.is_some()).collect();
    Ok(in_order(&fine, of_case)?.into_iter().flatten().collect())
}

#[cfg(test)]
mod tests;
