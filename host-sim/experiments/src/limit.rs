//! Velocity error of a particle filter with the exact likelihood of a count: a lower bound where the
//! filter has the true model of the plant.
//!
//! The filter simulates thousands of copies of the motor, each with its own noise, and keeps those
//! that agree with the encoder; it is too expensive for a controller. Effects that the model does
//! not contain (ripple of friction and torque) are a slow random torque, as in the observers: with
//! them, the error is no bound.

mod filter;
pub mod table;

use serde::Serialize;

use crate::compare::{Case, Settings, interval, setup_of, trace};
use crate::parallel::in_order;
use catalogue::estimators::{DIFFERENCE, Kind};
use scoring::evaluation::Evaluation;
use scoring::score::{Truth, Wanted};
use simulation::scenario::{Role, ScenarioName, TORQUE_INTENSITY_NM2_S};
use terminal::failure::Failure;

pub use filter::{Filtered, Noise, PARTS, filter};

/// Number of calls of `done` for each case of [`limit`]: the filter runs with counts and with edges.
pub const STEPS_PER_CASE: usize = 2 * PARTS;

/// Error of one estimator, or of the particle filter, in one run.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct LimitRow {
    /// Estimator; `limit` and `limit-edge` are the particle filter.
    pub estimator: &'static str,
    /// Scenario.
    pub scenario: &'static str,
    /// Control rate, Hz.
    pub rate_hz: f64,
    /// Seed.
    pub seed: u64,
    /// RMS error of the velocity, rad/s.
    pub rms_rad_s: f64,
    /// RMS error in % of that of finite difference on the same samples.
    pub rms_pct: f64,
    /// RMS error over that of the particle filter with the same signals.
    pub over_limit: f64,
    /// Of the particle filter the share of the ticks in which nearly no particle agrees with the encoder, 0 to 1;
    /// of an estimator 0.
    #[serde(skip)]
    pub collapsed: f64,
}

/// Default scenarios.
pub const SCENARIOS: [ScenarioName; 5] = {
    use ScenarioName::{FreeAir, Step, Stochastic, Texture, Track};
    [Stochastic, Step, Track, FreeAir, Texture]
};

/// Whether the filter has the true model of the plant in `scenario`, so that no estimator with its signals
/// can have a smaller error.
#[must_use]
pub(crate) fn is_bound(scenario: ScenarioName) -> bool {
    scenario.role() == Role::Linear
}

/// RMS error over the limit, below which the limit is wrong: the filter's own random error is smaller.
const BELOW: f64 = 0.97;
/// Share of the ticks with too few particles, from which the filter's error is not that of its model.
const COLLAPSED: f64 = 0.01;

/// Lines on `particles` that are too few: runs in which nearly none agree with the encoder, and bounds that an
/// estimator is below.
#[must_use]
pub fn too_few(rows: &[LimitRow], particles: usize) -> Vec<String> {
    let mut lines = Vec::new();
    for row in rows {
        let LimitRow {
            estimator,
            scenario,
            rate_hz,
            ..
        } = row;
        let what = if row.collapsed > COLLAPSED {
            format!(
                "{estimator} has fewer than 10 of its particles near the encoder's count in {:.0} % of the ticks",
                100.0 * row.collapsed
            )
        } else if scenario.parse().is_ok_and(is_bound) && row.over_limit < BELOW {
            format!(
                "{estimator} is at {:.2} of the limit, so that the limit is wrong",
                row.over_limit
            )
        } else {
            continue;
        };
        lines.push(format!(
            "note: {scenario} at {rate_hz} Hz: {what}: {particles} particles are too few; give more with --particles"
        ));
    }
    lines
}

/// Noise of the particles in `scenario`.
fn noise(scenario: ScenarioName) -> Noise {
    if is_bound(scenario) {
        // The noise of the simulated plant.
        Noise {
            torque_noise: TORQUE_INTENSITY_NM2_S.sqrt(),
            disturbance: 0.0,
            disturbance_time: 1.0,
            friction_error: 0.0,
        }
    } else {
        Noise {
            torque_noise: 6e-6,
            disturbance: 2.5e-4,
            disturbance_time: 0.02,
            friction_error: 3e-4,
        }
    }
}

/// Runs all cases in parallel with `particles` particles each and calls `done` [`STEPS_PER_CASE`] times during each.
///
/// # Errors
/// [`Failure::Input`] of the first case, in order, that cannot be run.
pub fn limit(
    cases: &[Case],
    settings: &Settings,
    particles: usize,
    done: &(dyn Fn() + Sync),
) -> Result<Vec<LimitRow>, Failure> {
    let rows = in_order(cases, |case| run(case, settings, particles, done))?;
    Ok(rows.into_iter().flatten().collect())
}

fn run(
    case: &Case,
    settings: &Settings,
    particles: usize,
    done: &(dyn Fn() + Sync),
) -> Result<Vec<LimitRow>, Failure> {
    // The particle filter uses all signals.
    let all: Vec<&Kind> = Kind::all().iter().collect();
    let trace = trace(case, &settings.device, &all)?;
    let setup = setup_of(case, &settings.device);
    let evaluation = Evaluation::new(
        &settings.estimators,
        &settings.parameters,
        &setup,
        case.plant,
    )?;
    let wanted = Wanted {
        rms: true,
        ..Wanted::NONE
    };
    let omega = trace.true_omega.as_deref().unwrap_or_default();
    let truth = Truth::new(omega, case.rate_hz, interval(&settings.device), wanted)
        .map_err(|error| Failure::Input(format!("{}: {error}", case.scenario)))?;
    let rms = |velocity: &[f32]| truth.score(velocity).rms_rad_s.unwrap_or(f64::NAN);
    let difference = Kind::named(DIFFERENCE)?.build(&setup, &Vec::new())?;
    let reference = rms(&difference.run(&trace));
    let noise = noise(case.scenario);
    let of = |edges| {
        let found = filter(&trace, &setup, &noise, edges, particles, case.seed, done);
        (rms(&found.velocities), found.collapsed)
    };
    let ((counts, counts_collapsed), (edges, edges_collapsed)) = (of(false), of(true));
    let row = |estimator, rms_rad_s: f64, limit: f64| LimitRow {
        estimator,
        scenario: case.scenario.as_str(),
        rate_hz: case.rate_hz,
        seed: case.seed,
        rms_rad_s,
        rms_pct: 100.0 * rms_rad_s / reference,
        over_limit: rms_rad_s / limit,
        collapsed: 0.0,
    };
    let mut rows = vec![
        LimitRow {
            collapsed: counts_collapsed,
            ..row("limit", counts, counts)
        },
        LimitRow {
            collapsed: edges_collapsed,
            ..row("limit-edge", edges, edges)
        },
    ];
    for candidate in evaluation.candidates() {
        if let Some(estimate) = candidate.estimate(&trace) {
            let limit = if candidate.kind.needs.edge {
                edges
            } else {
                counts
            };
            rows.push(row(candidate.kind.name, rms(&estimate.velocity), limit));
        }
    }
    Ok(rows)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::compare::tests::{case, settings};
    use catalogue::parameters::PlantKind;

    #[test]
    fn errors_are_over_the_limit_of_the_same_signals() {
        let settings = settings(&["low-pass", "m-over-t"]);
        let case = Case {
            seconds: 0.4,
            ..case(ScenarioName::Step, PlantKind::Friction)
        };
        let rows = limit(&[case], &settings, 50, &|| ()).unwrap();
        let found: Vec<_> = rows.iter().map(|row| row.estimator).collect();
        assert_eq!(found, ["limit", "limit-edge", "low-pass", "m-over-t"]);
        assert_ne!(rows[0].rms_rad_s, rows[1].rms_rad_s);
        // The low-pass reads counts, M/T edges.
        for (row, limit) in rows.iter().zip([0, 1, 0, 1]) {
            assert_eq!(row.over_limit, row.rms_rad_s / rows[limit].rms_rad_s);
        }
    }
}
