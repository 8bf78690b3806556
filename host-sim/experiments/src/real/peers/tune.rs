//! Tuning of peers on the recordings with which constants may be chosen.

use device_files::to_digits;
use rayon::prelude::*;
use scoring::score::Wanted;
use terminal::failure::Failure;

use super::Scored;
use super::list::Peer;
use super::path;
use crate::distinct::distinct;
use crate::parallel::in_order;
use crate::real::cases::{Case, Recordings};
use crate::real::run::Settings;
use crate::real::sources::Role;

/// Points of the first grid and of those that refine it, by the number of parameters.
const POINTS: [(usize, usize); 3] = [(0, 0), (15, 5), (7, 5)];

/// The score that is minimised.
const WANTED: Wanted = Wanted {
    rms: true,
    ..Wanted::NONE
};

/// Number of grids, each between the neighbours of the best point of the one before.
const ROUNDS: usize = 4;

/// The best values of a peer's parameters at a resolution and a rate.
#[derive(Clone, Debug, PartialEq)]
pub struct Tuned {
    /// Name of the peer.
    pub peer: &'static str,
    /// Counts per revolution.
    pub counts_per_rev: u32,
    /// Rate of the ticks, Hz.
    pub rate_hz: f64,
    /// Values of its parameters.
    pub values: Vec<f64>,
}

impl Tuned {
    pub(super) fn is_for(&self, peer: &Peer, case: &Case) -> bool {
        self.peer == peer.name
            && self.counts_per_rev == case.counts_per_rev
            && self.rate_hz == case.rate_hz
    }
}

/// For each resolution and rate of `cases`, the values of each peer's parameters with the smallest mean
/// of the RMS error, in % of finite difference, over the recordings of fine encoders of the role
/// `chooses`: the best point of a logarithmic grid, refined three times. Nothing is tuned without
/// such a recording.
///
/// # Errors
/// [`Failure::Input`] of a case that cannot be run.
pub fn tune(
    recordings: &Recordings,
    cases: &[Case],
    settings: &Settings,
    peers: &[Peer],
) -> Result<Vec<Tuned>, Failure> {
    let chooses = |case: &&Case| case.phase.is_some() && case.role == Role::Chooses;
    let choosing: Vec<_> = cases.iter().filter(chooses).collect();
    let blocks = distinct(
        choosing
            .iter()
            .map(|case| (case.counts_per_rev, case.rate_hz)),
    );
    let mut tuned = Vec::new();
    for (counts_per_rev, rate_hz) in blocks {
        let of = |case: &&&Case| case.counts_per_rev == counts_per_rev && case.rate_hz == rate_hz;
        let own: Vec<_> = choosing.iter().filter(of).copied().collect();
        let traces = in_order(&own, |case| recordings.recording(case))?;
        let scored = own.iter().zip(&traces);
        let scored = scored.map(|(case, one)| Scored::new(&one.trace, case, settings, WANTED));
        let scored: Vec<_> = scored.collect::<Result<_, _>>()?;
        for peer in peers.iter().filter(|peer| !peer.parameters.is_empty()) {
            let each: Vec<_> = own.iter().zip(&scored).collect();
            let paths = in_order(&each, |(case, scored)| {
                path::of(recordings, case, peer, scored.trace)
            })?;
            let cost = |values: &[f64]| {
                let errors = paths.par_iter().zip(&scored).map(|(path, scored)| {
                    let velocity = (peer.run)(path, values);
                    scored.score(&velocity).rms_pct.unwrap_or(f64::INFINITY)
                });
                // The order of a sum of floats is that of the cases.
                errors.collect::<Vec<_>>().iter().sum::<f64>()
            };
            let ranges: Vec<_> = peer.parameters.iter().map(|one| one.range).collect();
            tuned.push(Tuned {
                peer: peer.name,
                counts_per_rev,
                rate_hz,
                values: smallest(&ranges, cost),
            });
        }
    }
    Ok(tuned)
}

/// The point with the smallest cost of a logarithmic grid over `ranges`, of one or two numbers, with
/// three digits.
fn smallest(ranges: &[[f64; 2]], cost: impl Fn(&[f64]) -> f64) -> Vec<f64> {
    let (first, refined) = POINTS[ranges.len()];
    let mut ranges = ranges.to_vec();
    let limits = ranges.clone();
    let mut best = (f64::INFINITY, Vec::new());
    for round in 0..ROUNDS {
        let points = if round == 0 { first } else { refined };
        let step = |[low, high]: [f64; 2]| (high / low).powf(1.0 / (points - 1) as f64);
        for at in 0..points.pow(ranges.len() as u32) {
            let mut at = at;
            let value = |range: &[f64; 2]| {
                let k = at % points;
                at /= points;
                let value = range[0] * step(*range).powi(k as i32);
                to_digits(value, 3)
            };
            let values: Vec<f64> = ranges.iter().map(value).collect();
            let cost = cost(&values);
            if cost < best.0 {
                best = (cost, values);
            }
        }
        let parts = ranges.iter_mut().zip(&best.1).zip(&limits);
        for ((range, best), limit) in parts {
            let step = step(*range);
            *range = [(best / step).max(limit[0]), (best * step).min(limit[1])];
        }
    }
    best.1
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn smallest_point_of_a_parabola_is_found_in_one_and_two_dimensions() {
        let away = |value: f64, from: f64| (value / from).ln().powi(2);
        let found = smallest(&[[1.0, 1000.0]], |p| away(p[0], 37.0));
        // The last of four grids: 14 and then 2 steps of 4 each time: a ratio of 1.1 or less.
        assert!((found[0] / 37.0).ln().abs() < 0.1, "{found:?}");
        let valley = |p: &[f64]| away(p[0], 37.0) + away(p[1], 2.0e5) + away(p[0] * p[1], 7.4e6);
        let found = smallest(&[[1.0, 1000.0], [1e2, 1e6]], valley);
        assert!((found[0] / 37.0).ln().abs() < 0.15, "{found:?}");
        assert!((found[1] / 2.0e5).ln().abs() < 0.15, "{found:?}");
        // The smallest at an end of the range stays within it.
        assert_eq!(smallest(&[[1.0, 1000.0]], |p| p[0]), [1.0]);
    }
}
