//! The noises of a recording by maximum likelihood of the innovations.

use std::ops::Range;

use rayon::prelude::*;

use recordings::recording::Recording;

use super::events::{Event, events};
use super::sections::Motion;
use super::sweeps::{Model, log_likelihood};

/// Rows of a piece over which the likelihood is computed.
const PIECE: usize = 2000;

/// Most pieces, which are spread evenly over a long recording.
const PIECES: usize = 12;

/// Range of the natural logarithm of the jerk's density, counts^2/period^5. The upper end is beyond every
/// motion: a density that is too small would make the sensor's variance too large.
const JERK: [f64; 2] = [-37.0, 31.0];

/// Number of the jerk's densities at which the search may start.
const JERKS: u8 = 15;

/// Range of the natural logarithm of the sensor's variance, counts^2: a deviation of a thousandth of a
/// count to 10 000 counts.
const SENSOR: [f64; 2] = [-13.8, 18.4];

/// Natural logarithms of the sensor's variance at which the search may start.
const SENSORS: [f64; 5] = [-9.0, -4.0, 1.0, 6.0, 12.0];

/// Number of searches: the likelihood can have a maximum where the sensor is exact, and another one.
const SEARCHES: usize = 3;

/// Size of the simplex at which the search ends, in natural logarithms.
const END: f64 = 0.02;

/// The pieces of a recording of `rows` rows.
fn pieces(rows: usize) -> Vec<Range<usize>> {
    let piece = |i: usize, of: usize| {
        let first = (rows - PIECE) * i / (of - 1).max(1);
        first..first + PIECE
    };
    match rows / PIECE {
        0 | 1 => std::iter::once(0..rows).collect(),
        whole if whole <= PIECES => (0..=whole).map(|i| piece(i, whole + 1)).collect(),
        _ => (0..PIECES).map(|i| piece(i, PIECES)).collect(),
    }
}

/// The natural logarithms of the jerk's density, counts^2/period^5, and of the sensor's variance,
/// counts^2.
type Logarithms = [f64; 2];

/// The model whose noises make the innovations of `recording` most likely, with times in periods of
/// `period_s`.
pub(super) fn most_likely(recording: &Recording, motion: &Motion, period_s: f64) -> Model {
    let pieces = pieces(recording.t.len());
    let pieces: Vec<Vec<Event>> = pieces
        .into_iter()
        .map(|range| events(recording, &motion.rows, range, period_s))
        .collect();
    let model = |[jerk, sensor]: Logarithms| Model {
        jerk: jerk.clamp(JERK[0], JERK[1]).exp(),
        sensor: sensor.clamp(SENSOR[0], SENSOR[1]).exp(),
        fastest: motion.fastest,
    };
    let loss = |[jerk, sensor]: Logarithms| {
        let outside = |x: f64, [low, high]: [f64; 2]| (low - x).max(x - high).max(0.0);
        let beyond = outside(jerk, JERK) + outside(sensor, SENSOR);
        let model = model([jerk, sensor]);
        // The order of the sum does not depend on the number of threads.
        let logs: Vec<f64> =
            (pieces.par_iter().map(|piece| log_likelihood(piece, model))).collect();
        let loss = 1e6 * beyond - logs.iter().sum::<f64>();
        // The order of the losses has no place for a NaN of either sign.
        if loss.is_nan() { f64::INFINITY } else { loss }
    };
    let found = starts(loss).into_iter().map(|start| minimum(loss, start));
    let best = found.min_by(|a, b| a.0.total_cmp(&b.0));
    model(best.map_or([0.0, -4.0], |(_, point)| point))
}

/// A value of the loss and its place.
type Valued = (f64, Logarithms);

/// The places from which the minimum is searched: with each variance of the sensor the best density of the
/// jerk on a coarse grid, and of these the best [`SEARCHES`].
fn starts(loss: impl Fn(Logarithms) -> f64) -> Vec<Logarithms> {
    let spacing = (JERK[1] - JERK[0]) / f64::from(JERKS - 1);
    let jerks = || (0..JERKS).map(|i| JERK[0] + spacing * f64::from(i));
    let best = |sensor: f64| {
        let valued = jerks().map(|jerk| (loss([jerk, sensor]), [jerk, sensor]));
        valued.min_by(|a, b| a.0.total_cmp(&b.0))
    };
    let mut starts: Vec<Valued> = SENSORS.into_iter().filter_map(best).collect();
    starts.sort_by(|a, b| a.0.total_cmp(&b.0));
    let starts = starts.into_iter().take(SEARCHES);
    starts.map(|(_, point)| point).collect()
}

/// Minimum near `start` by the simplex of Nelder and Mead.
fn minimum(loss: impl Fn(Logarithms) -> f64, start: Logarithms) -> Valued {
    let [x, y] = start;
    let valued = |point: Logarithms| (loss(point), point);
    let mut simplex = [[x, y], [x + 3.0, y], [x, y + 2.0]].map(valued);
    for _ in 0..200 {
        simplex.sort_by(|a, b| a.0.total_cmp(&b.0));
        let [
            (best_loss, best),
            (middle_loss, middle),
            (worst_loss, worst),
        ] = simplex;
        let size = |of: Logarithms| (of[0] - best[0]).abs().max((of[1] - best[1]).abs());
        if size(middle).max(size(worst)) < END {
            break;
        }
        let centre = [0, 1].map(|i| 0.5 * (best[i] + middle[i]));
        let along = |by: f64| [0, 1].map(|i| centre[i] + by * (worst[i] - centre[i]));
        let reflected = valued(along(-1.0));
        let next = if reflected.0 < best_loss {
            let expanded = valued(along(-2.0));
            if expanded.0 < reflected.0 {
                expanded
            } else {
                reflected
            }
        } else if reflected.0 < middle_loss {
            reflected
        } else {
            valued(along(if reflected.0 < worst_loss { -0.5 } else { 0.5 }))
        };
        if next.0 < worst_loss {
            simplex[2] = next;
        } else {
            for point in &mut simplex[1..] {
                *point = valued([0, 1].map(|i| 0.5 * (best[i] + point.1[i])));
            }
        }
    }
    simplex.sort_by(|a, b| a.0.total_cmp(&b.0));
    simplex[0]
}
