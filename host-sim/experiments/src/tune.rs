//! Search of the estimators' parameters on seeds that are not used for scores.
//!
//! The search minimises the cost on the tuning seeds. The result and the shipped parameters are
//! then compared on one further seed; the shipped parameters are kept if they are at least as good
//! there.

mod image_section;

use std::collections::BTreeMap;
use std::ops::Range;

use rayon::prelude::*;

use crate::compare::{Case, interval, trace};
use catalogue::constant_error::ConstantError;
use catalogue::estimators::{Kind, Parameter, Search, Setup, Values};
use catalogue::parameters::{Parameters, PlantKind, Preset};
use scoring::score::{Truth, Wanted};
use simulation::device::Device;
use simulation::scenario::ScenarioName;
use simulation::trace::Trace;
use terminal::failure::Failure;

pub use image_section::image_section;

/// First tuning seed; seeds below it are for scores.
pub const FIRST_SEED: u64 = 1 << 32;

/// Weight of the RMS error relative to the mean distance. It discriminates between parameters whose
/// error never leaves the haptic interval.
pub const RMS_WEIGHT: f64 = 0.01;

/// Points of a search's first grid.
const GRID: usize = 25;

/// Inertia of the device for which the ranges of the parameters are stated, kg.m2.
const DEFAULT_INERTIA: f64 = estimator_core::MotorModel::DCX35L.inertia;

/// Rounds of refinement between the neighbours of the best point.
const REFINEMENTS: usize = 3;

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

/// Result of tuning at one rate on one plant.
#[derive(Clone, Debug)]
pub struct Tuned {
    /// The parameters.
    pub preset: Preset,
    /// One line for each parameter at a limit of its range, and for each estimator whose shipped
    /// parameters are kept.
    pub notes: Vec<String>,
}

/// Tunes the estimators `kinds` at one rate on one plant and calls `done` after each. All of them
/// must have parameters.
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
    rate_hz: f64,
    plant: PlantKind,
    done: impl Fn() + Sync,
) -> Result<Tuned, Failure> {
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
        let traces = cases.par_iter().map(|case| trace(case, &set.device, kinds));
        traces.collect::<Result<Vec<_>, _>>()
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
    let mut notes = Vec::new();
    let mut estimators = BTreeMap::new();
    for &kind in kinds {
        let found = best_values(kind, &setups, &seen);
        let before = shipped.values(kind, &setup, plant);
        let cost = |values| mean_cost(kind, &setups, &unseen, values);
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
        estimators.insert(kind.name.to_owned(), names.zip(best).collect());
        done();
    }
    Ok(Tuned {
        preset: Preset {
            rate_hz,
            plant,
            counts_per_rev: Some(set.device.stages.large.counts_per_rev),
            estimators,
        },
        notes,
    })
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

/// One line for each value at a limit of the searched range.
fn ends_of_ranges(kind: &Kind, setup: &Setup, values: &Values) -> Vec<String> {
    let searched = kind.parameters.iter().zip(values);
    searched
        .filter_map(|(parameter, &value)| {
            let grid = first_grid(parameter, setup);
            let (low, high) = (grid[0], grid[grid.len() - 1]);
            let is = |end: f64| three_digits(end) == three_digits(value);
            let at = match parameter.search {
                Search::Fixed(_) => return None,
                _ if is(low) => "lower",
                _ if is(high) => "upper",
                _ => return None,
            };
            Some(format!(
                "{}.{} = {value} {} is the {at} limit of the searched range; a value beyond it may be better: try --set",
                kind.name, parameter.name, parameter.unit
            ))
        })
        .collect()
}

fn best_values(kind: &Kind, setups: &[Setup], tracks: &[Track]) -> Values {
    let mut axes: Vec<_> = kind
        .parameters
        .iter()
        .map(|p| first_grid(p, &setups[0]))
        .collect();
    let mut best = evaluate(kind, setups, tracks, &axes);
    for _ in 0..REFINEMENTS {
        for ((axis, parameter), value) in axes.iter_mut().zip(kind.parameters).zip(&best) {
            *axis = finer(parameter, axis, *value);
        }
        best = evaluate(kind, setups, tracks, &axes);
    }
    best
}

/// The point of the grid spanned by `axes` with the smallest cost.
fn evaluate(kind: &Kind, setups: &[Setup], tracks: &[Track], axes: &[Vec<f64>]) -> Values {
    let mut points = vec![Vec::new()];
    for axis in axes {
        points = points
            .iter()
            .flat_map(|point: &Values| {
                axis.iter()
                    .map(|&value| point.iter().copied().chain([value]).collect())
            })
            .collect();
    }
    points
        .into_par_iter()
        .map(|point| (mean_cost(kind, setups, tracks, &point), point))
        // Of equal costs the earlier point wins, so that the result does not depend on threads.
        .min_by(|(a, p), (b, q)| a.total_cmp(b).then_with(|| compare_points(p, q)))
        .map(|(_, point)| point)
        .unwrap_or_default()
}

fn compare_points(p: &Values, q: &Values) -> std::cmp::Ordering {
    let differing = p.iter().zip(q).map(|(a, b)| a.total_cmp(b));
    differing
        .into_iter()
        .find(|o| o.is_ne())
        .unwrap_or(std::cmp::Ordering::Equal)
}

fn mean_cost(kind: &Kind, setups: &[Setup], tracks: &[Track], values: &Values) -> f64 {
    let costs = setups.iter().map(|setup| cost(kind, setup, tracks, values));
    costs.sum::<f64>() / setups.len() as f64
}

/// Cost of the parameters; infinite if the estimator's design refuses them.
fn cost(kind: &Kind, setup: &Setup, tracks: &[Track], values: &Values) -> f64 {
    let Ok(estimator) = kind.build(setup, values) else {
        return f64::INFINITY;
    };
    let of_track = |(trace, truth): &Track| {
        let score = truth.score(&estimator.run(trace));
        score.distance_rad_s.unwrap_or(f64::INFINITY)
            + RMS_WEIGHT * score.rms_rad_s.unwrap_or(f64::INFINITY)
    };
    tracks.iter().map(of_track).sum::<f64>() / tracks.len() as f64
}

fn first_grid(parameter: &Parameter, setup: &Setup) -> Vec<f64> {
    match parameter.search {
        Search::Fixed(value) => vec![value],
        Search::Log(low, high) => {
            // The motion depends on the ratio of torque to inertia.
            let scale = match parameter.is_torque() {
                true => setup.stages.large.inertia / DEFAULT_INERTIA,
                false => 1.0,
            };
            let high = match parameter.unit {
                "Hz" => high.min(setup.rate.0 / 2.0),
                _ => high * scale,
            };
            logarithmic(low * scale, high, GRID)
        }
        Search::Each(low, high) if high - low < GRID as u32 => {
            (low..=high).map(f64::from).collect()
        }
        Search::Each(low, high) => whole(logarithmic(f64::from(low), f64::from(high), GRID)),
    }
}

/// A grid between the neighbours of `best` on `axis`.
fn finer(parameter: &Parameter, axis: &[f64], best: f64) -> Vec<f64> {
    let at = axis
        .iter()
        .position(|&value| value == best)
        .unwrap_or_default();
    let low = axis[at.saturating_sub(1)];
    let high = axis[(at + 1).min(axis.len() - 1)];
    match parameter.search {
        Search::Fixed(_) => vec![best],
        Search::Log(..) => {
            // More than three digits of a tuned value are not significant.
            logarithmic(low, high, 9)
                .into_iter()
                .map(three_digits)
                .collect()
        }
        Search::Each(..) if high - low <= 8.0 => {
            (low as u32..=high as u32).map(f64::from).collect()
        }
        Search::Each(..) => {
            let mut values = logarithmic(low, high, 9);
            values.push(best);
            whole(values)
        }
    }
}

fn logarithmic(low: f64, high: f64, points: usize) -> Vec<f64> {
    let step = (high / low).ln() / (points - 1) as f64;
    (0..points).map(|i| low * (step * i as f64).exp()).collect()
}

fn whole(mut values: Vec<f64>) -> Vec<f64> {
    for value in &mut values {
        *value = value.round();
    }
    values.sort_unstable_by(f64::total_cmp);
    values.dedup();
    values
}

fn three_digits(value: f64) -> f64 {
    format!("{value:.2e}").parse().unwrap_or(value)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn grid_contains_its_limits_and_the_best_point() {
        let grid = logarithmic(1.0, 100.0, 5);
        assert!((grid[2] - 10.0).abs() < 1e-9 && (grid[4] - 100.0).abs() < 1e-9);
        assert_eq!(whole(vec![1.2, 0.9, 3.0]), [1.0, 3.0]);
        assert_eq!(three_digits(123.456), 123.0);
        let window = Kind::named("foaw-end-fit").unwrap().parameters[0];
        assert_eq!(
            finer(&window, &[1.0, 5.0, 9.0], 5.0),
            (1..=9).map(f64::from).collect::<Vec<_>>()
        );
    }

    /// Twice the inertia needs twice the torque for the same motion.
    #[test]
    fn ranges_of_torques_follow_the_inertia() {
        let kind = Kind::named("observer").unwrap();
        let device = Device::default();
        let mut heavy = device.clone();
        heavy.stages.large.inertia *= 2.0;
        for parameter in kind
            .parameters
            .iter()
            .filter(|p| p.name != "boundary_noise")
        {
            let grid = |device| first_grid(parameter, &Setup::of(device, 1e3));
            let ratio = grid(&heavy)[0] / grid(&device)[0];
            let wanted = if parameter.is_torque() { 2.0 } else { 1.0 };
            assert!((ratio - wanted).abs() < 1e-9, "{}: {ratio}", parameter.name);
        }
    }
}
