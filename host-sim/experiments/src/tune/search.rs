//! Search of the parameters with the smallest cost.

use std::sync::atomic::{AtomicU64, Ordering};

use rayon::prelude::*;

use catalogue::estimators::{Kind, Parameter, Search, Setup, Values};
use device_files::to_digits;

/// Points of a search's first grid.
const GRID: usize = 25;

/// Inertia of the device for which the ranges of the parameters are stated, kg.m2.
const DEFAULT_INERTIA: f64 = estimator_core::MotorModel::DCX35L.inertia;

/// Rounds of refinement between the neighbours of the best point.
const REFINEMENTS: usize = 3;

/// The least cost found so far on one grid. A point whose cost is certain to be above it need not be
/// evaluated to the end: it is not the best one, whatever the order of the points.
pub(super) struct Least(AtomicU64);

impl Least {
    /// No cost yet.
    pub(super) fn none() -> Self {
        Self(AtomicU64::new(f64::INFINITY.to_bits()))
    }

    /// Whether a point has been found whose cost is below `cost`.
    pub(super) fn is_below(&self, cost: f64) -> bool {
        f64::from_bits(self.0.load(Ordering::Relaxed)) < cost
    }

    /// Takes the cost of a point. The bits of floats that are not negative have the order of the floats.
    fn take(&self, cost: f64) {
        self.0.fetch_min(cost.to_bits(), Ordering::Relaxed);
    }
}

/// One line for each value at a limit of the searched range.
pub(super) fn ends_of_ranges(kind: &Kind, setup: &Setup, values: &Values) -> Vec<String> {
    let searched = kind.parameters.iter().zip(values);
    searched
        .filter_map(|(parameter, &value)| {
            let grid = first_grid(parameter, setup);
            let (low, high) = (grid[0], grid[grid.len() - 1]);
            let is = |end: f64| to_digits(end, 3) == to_digits(value, 3);
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

/// The parameters of `kind` with the smallest cost, on a grid over all parameters for `setup` and then
/// on finer grids around the best point. `cost` is not negative; of a point whose cost is above the least
/// one it may return any larger value.
pub(super) fn best_values(
    kind: &Kind,
    setup: &Setup,
    cost: impl Fn(&Values, &Least) -> f64 + Sync,
) -> Values {
    let mut axes: Vec<_> = kind
        .parameters
        .iter()
        .map(|p| first_grid(p, setup))
        .collect();
    let mut best = evaluate(&cost, &axes);
    for _ in 0..REFINEMENTS {
        for ((axis, parameter), value) in axes.iter_mut().zip(kind.parameters).zip(&best) {
            *axis = finer(parameter, axis, *value);
        }
        best = evaluate(&cost, &axes);
    }
    best
}

/// The point of the grid spanned by `axes` with the smallest cost.
fn evaluate(cost: &(impl Fn(&Values, &Least) -> f64 + Sync), axes: &[Vec<f64>]) -> Values {
    let mut points = vec![Vec::new()];
    for axis in axes {
        // Values rounded to three digits repeat on a fine grid.
        let mut axis = axis.clone();
        axis.dedup();
        points = points
            .iter()
            .flat_map(|point: &Values| {
                axis.iter()
                    .map(|&value| point.iter().copied().chain([value]).collect())
            })
            .collect();
    }
    let least = Least::none();
    let costed = |point: Values| {
        let cost = cost(&point, &least);
        least.take(cost);
        (cost, point)
    };
    // The middle of a finer grid is the best point of the grid before: most others are cut off early.
    let middle = costed(points.swap_remove(points.len() / 2));
    points
        .into_par_iter()
        .map(costed)
        .chain(rayon::iter::once(middle))
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
                .map(|value| to_digits(value, 3))
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

#[cfg(test)]
mod tests {
    use super::*;
    use simulation::device::Device;

    #[test]
    fn grid_contains_its_limits_and_the_best_point() {
        let grid = logarithmic(1.0, 100.0, 5);
        assert!((grid[2] - 10.0).abs() < 1e-9 && (grid[4] - 100.0).abs() < 1e-9);
        assert_eq!(whole(vec![1.2, 0.9, 3.0]), [1.0, 3.0]);
        let window = Kind::named("foaw-end-fit").unwrap().parameters[0];
        assert_eq!(
            finer(&window, &[1.0, 5.0, 9.0], 5.0),
            (1..=9).map(f64::from).collect::<Vec<_>>()
        );
    }

    /// Two terms that are not negative; the second one is left out where the first one decides.
    #[test]
    fn points_that_are_cut_off_do_not_change_the_best_one() {
        use std::sync::atomic::AtomicUsize;

        let axis = |from: i32, to: i32| (from..to).map(f64::from).collect::<Vec<_>>();
        let axes = [axis(0, 9), axis(-4, 5)];
        for (x, y) in [(4.0, 0.0), (8.0, -4.0), (0.0, 4.0), (2.2, 1.5)] {
            let terms = |point: &Values| [(point[0] - x).powi(2), (point[1] - y).powi(2)];
            let completed = AtomicUsize::new(0);
            let cut_off = |point: &Values, least: &Least| {
                let [first, second] = terms(point);
                if least.is_below(first) {
                    return f64::INFINITY;
                }
                completed.fetch_add(1, Ordering::Relaxed);
                first + second
            };
            let full = |point: &Values, _: &Least| terms(point).iter().sum();
            assert_eq!(evaluate(&cut_off, &axes), evaluate(&full, &axes));
            // The middle is the best point: only points as good in the first term are completed.
            if (x, y) == (4.0, 0.0) {
                assert_eq!(completed.into_inner(), axes[1].len());
            }
        }
    }

    #[test]
    fn of_equal_costs_the_earlier_point_is_the_best_one() {
        let axes = [vec![1.0, 2.0, 2.0, 3.0, 4.0]];
        // 3 is the middle, which is evaluated apart.
        for first in [2.0, 3.0, 4.0] {
            let cost = |point: &Values, least: &Least| match least.is_below(7.0) {
                true => f64::INFINITY,
                false => 7.0 + f64::from(point[0] < first),
            };
            assert_eq!(evaluate(&cost, &axes), [first]);
        }
    }

    #[test]
    fn value_at_either_end_of_its_range_is_reported() {
        let kind = Kind::named("low-pass").unwrap();
        let setup = Setup::of(&Device::default(), 1e4);
        // The cut-off is searched from 5 to 500 Hz.
        for (value, end) in [(5.0, "lower"), (500.0, "upper")] {
            let notes = ends_of_ranges(kind, &setup, &vec![value]);
            let said = format!("low-pass.cutoff_hz = {value} Hz is the {end} limit");
            assert!(notes.len() == 1 && notes[0].starts_with(&said), "{notes:?}");
        }
        assert!(ends_of_ranges(kind, &setup, &vec![100.0]).is_empty());
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
