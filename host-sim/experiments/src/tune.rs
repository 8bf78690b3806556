//! Search of the estimators' parameters on seeds that are not used for scores.
//!
//! The search minimises the cost on the tuning seeds. The result and the shipped parameters are
//! then compared on one further seed; the shipped parameters are kept if they are at least as good
//! there.

mod image_section;
mod logs;
mod plan;
mod recipe;
mod search;

use std::collections::BTreeMap;
use std::ops::Range;

use serde::{Deserialize, Serialize};

use crate::compare::{Case, interval, trace};
use crate::parallel::in_order;
use catalogue::constant_error::ConstantError;
use catalogue::estimators::{Kind, Setup, Values};
use catalogue::parameters::{Parameters, PlantKind};
use scoring::score::{Truth, Wanted};
use simulation::device::Device;
use simulation::scenario::ScenarioName;
use simulation::trace::Trace;
use terminal::failure::Failure;

pub use image_section::image_section;
pub use logs::{LogFile, LogPlan, LogSearch, LogTuned};
pub use plan::{Group, Plan};
pub use recipe::{FILTER_SECONDS, FILTER_SEEDS, Wishes};

use search::{Least, best_values, ends_of_ranges};

/// First tuning seed; seeds below it are for scores.
pub const FIRST_SEED: u64 = 1 << 32;

/// Weight of the RMS error relative to the mean distance. It discriminates between parameters whose
/// error never leaves the haptic interval.
pub const RMS_WEIGHT: f64 = 0.01;

/// The tuning set: device, scenarios, seeds, and errors of the constants.
#[derive(Clone, Debug)]
pub struct TuningSet {
    /// The device.
    pub device: Device,
    /// Scenarios, over which the cost is averaged.
    pub scenarios: Vec<ScenarioName>,
    /// Number of tuning seeds.
    pub seeds: u64,
    /// Duration of each run, s.
    pub seconds: f64,
    /// Errors of the constants, over which the cost is averaged together with the correct
    /// constants.
    pub constant_errors: Vec<ConstantError>,
}

/// Result of tuning one estimator at one rate on one plant.
#[derive(Clone, Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Tuned {
    /// Values of the parameters by name.
    pub values: BTreeMap<String, f64>,
    /// One line for each parameter at a limit of its range, or if the shipped parameters are kept.
    pub notes: Vec<String>,
}

/// Tunes the estimators `kinds` at one rate on one plant and calls `done` after each, and `look` before each
/// simulation and each evaluation. All of them
/// must have parameters. The traces have the columns that the estimators `read` need.
///
/// The cost is the mean distance outside the haptic interval plus a hundredth of the RMS error,
/// averaged over scenarios and seeds. It is minimised on a grid over all parameters, then on finer
/// grids around the best point. The result is compared with the shipped parameters on the seed
/// after the tuning seeds; the better ones are returned.
///
/// # Errors
/// [`Failure::Input`] if a case cannot be simulated or an estimator needs a signal that the
/// simulation does not provide.
pub fn tune(
    set: &TuningSet,
    kinds: &[&'static Kind],
    read: &[&'static Kind],
    rate_hz: f64,
    plant: PlantKind,
    done: &(dyn Fn() + Sync),
    look: &(dyn Fn() + Sync),
) -> Result<Vec<Tuned>, Failure> {
    let traces = |seeds: Range<u64>| {
        let cases: Vec<_> = set
            .scenarios
            .iter()
            .flat_map(|&scenario| seeds.clone().map(move |i| (scenario, FIRST_SEED + i)))
            .map(|(scenario, seed)| Case {
                scenario,
                rate_hz,
                plant,
                seed,
                seconds: set.seconds,
                keep: false,
            })
            .collect();
        in_order(&cases, |case| {
            look();
            trace(case, &set.device, read)
        })
    };
    let traces = [traces(0..set.seeds)?, traces(set.seeds..set.seeds + 1)?];
    let [seen, unseen] = [
        tracks(&traces[0], rate_hz, &set.device)?,
        tracks(&traces[1], rate_hz, &set.device)?,
    ];

    let setup = match plant {
        PlantKind::Friction => Setup::of(&set.device, rate_hz),
        PlantKind::Frictionless => Setup::of(&set.device, rate_hz).frictionless(),
    };
    let wrong = set
        .constant_errors
        .iter()
        .map(|constant_error| constant_error.of(&setup));
    let setups: Vec<_> = std::iter::once(setup).chain(wrong).collect();
    let shipped = Parameters::default();
    let mut tuned = Vec::new();
    for &kind in kinds {
        let mut notes = Vec::new();
        let found = best_values(kind, &setups[0], |values, least| {
            look();
            mean_cost(kind, &setups, &seen, values, least)
        });
        let before = shipped.values(kind, &setup, plant);
        let cost = |values| mean_cost(kind, &setups, &unseen, values, &Least::none());
        let best = if cost(&before) <= cost(&found) {
            if before != found {
                notes.push(format!(
                    "{}: the shipped parameters are kept; they are better on a seed outside the tuning set",
                    kind.name
                ));
            }
            before
        } else {
            notes.extend(ends_of_ranges(kind, &setup, &found));
            found
        };
        let names = kind.parameters.iter().map(|p| p.name.to_owned());
        tuned.push(Tuned {
            values: names.zip(best).collect(),
            notes,
        });
        done();
    }
    Ok(tuned)
}

/// A simulated trace and the scores' reference.
type Track<'a> = (&'a Trace, Truth<'a>);

fn tracks<'a>(
    traces: &'a [Trace],
    rate_hz: f64,
    device: &Device,
) -> Result<Vec<Track<'a>>, String> {
    let wanted = Wanted {
        rms: true,
        distance: true,
        ..Wanted::NONE
    };
    let interval = interval(device);
    let track = |trace: &'a Trace| {
        let omega = trace.true_omega.as_deref().unwrap_or_default();
        Ok((trace, Truth::new(omega, rate_hz, interval, wanted)?))
    };
    traces.iter().map(track).collect()
}

/// Mean cost of the parameters over setups and tracks. It is infinite for parameters that an estimator's
/// design refuses, and for parameters whose cost is above the `least` one: the terms are not negative,
/// so that the mean is at least the part of it that is known.
fn mean_cost(
    kind: &Kind,
    setups: &[Setup],
    tracks: &[Track],
    values: &Values,
    least: &Least,
) -> f64 {
    let mut sum = 0.0;
    for setup in setups {
        let Ok(estimator) = kind.build(setup, values) else {
            return f64::INFINITY;
        };
        let mean = |of_setup: f64| (sum + of_setup / tracks.len() as f64) / setups.len() as f64;
        let mut of_setup = 0.0;
        for (trace, truth) in tracks {
            let score = truth.score(&estimator.run(trace));
            of_setup += score.distance_rad_s.unwrap_or(f64::INFINITY)
                + RMS_WEIGHT * score.rms_rad_s.unwrap_or(f64::INFINITY);
            if least.is_below(mean(of_setup)) {
                return f64::INFINITY;
            }
        }
        sum += of_setup / tracks.len() as f64;
    }
    sum / setups.len() as f64
}
