//! A reference velocity from the recording itself, for recordings without a true velocity.
//!
//! The position is a triple integrator of white jerk, in counts and seconds. A row observes that the
//! position, with sensor noise, is in the cell of the row's count; a stamped edge observes that it is
//! the boundary at the edge's instant. Intervals may be uneven. The density of the jerk and the
//! variance of the sensor are those that make the innovations most likely. The velocity is smoothed
//! in both directions of time, so it needs the future: no estimator can be as good. It starts anew
//! after a long gap and after a jump of the counter, and passes over a single bad count.
//!
//! # What it does not resolve
//! * Motion within a cell without an edge. Its standard deviation grows with the time between edges.
//! * Motion faster than [`Reference::bandwidth_hz`], where the smoother halves an amplitude.
//! * Errors of the encoder's disc: equal cells are assumed.
//! * One density of jerk serves the whole recording. Where the motion is more abrupt than on the
//!   average, as in impacts, the standard deviation is too small, and at rest it is too large.

mod cell;
mod events;
mod noises;
mod sections;
mod shaft;
mod state;
mod sweeps;
mod thinned;
mod truth;

use std::f64::consts::TAU;
use std::ops::Range;

use rayon::prelude::*;

use recordings::recording::Recording;
use scoring::score::rms_scored;
use simulation::trace::Trace;

use crate::table::number;

pub use sections::interruptions;
pub use shaft::ShaftMotion;
pub use truth::TruthCheck;

use sections::Motion;
use sweeps::Model;

/// Smallest number of rows of a recording with a reference.
pub const FEWEST_ROWS: usize = 100;

/// Smallest number of rows of a recording with a reference at which the count changes.
pub const FEWEST_CHANGES: usize = 30;

/// Smallest RMS error, in standard deviations of the reference, that ranks an estimator. Below it the
/// reference's own error is more than half of what the score measures.
pub const RESOLVED: f64 = 1.5;

/// Smallest standard deviation of the sensor's noise that is reported, counts. An exact encoder has less.
const NOISY: f64 = 0.5;

/// Rows of a piece that is smoothed at a time.
const PIECE: usize = 65_536;

/// Rows before and after a piece that are smoothed with it.
const OVERLAP: usize = 8192;

/// Noises of a recording.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Noises {
    /// Spectral density of the white jerk, counts^2/s^5.
    pub jerk: f64,
    /// Variance of the sensor's noise, counts^2. Quantisation is not part of it.
    pub sensor: f64,
}

/// Velocity of a recording with its standard deviation, one value per row.
#[derive(Clone, Debug)]
pub struct Reference {
    /// Velocity, rad/s.
    pub omega: Vec<f64>,
    /// Its standard deviation, rad/s.
    pub sd: Vec<f64>,
    /// Whether an estimate is scored against it at each row; `None` if at all of them. It is not at rows that are no
    /// motion of a shaft and shortly after them, unless these are most of the rows.
    pub known: Option<Vec<bool>>,
    /// The noises with which it was computed.
    pub noises: Noises,
    /// Frequency at which the smoother halves the amplitude of a motion, on the average over the
    /// recording, Hz.
    pub bandwidth_hz: f64,
}

impl Reference {
    /// The reference of `recording`, whose encoder has `counts_per_rev`. The result does not depend on
    /// the number of threads.
    ///
    /// # Errors
    /// If the recording has fewer than [`FEWEST_ROWS`] rows, or its count changes at fewer than
    /// [`FEWEST_CHANGES`] of them: the noises cannot be estimated. If a velocity or a standard
    /// deviation is not finite.
    pub fn of(recording: &Recording, counts_per_rev: u32) -> Result<Self, String> {
        let noises = Noises::of(recording)?;
        let reference = Self::with(recording, counts_per_rev, noises);
        let mut values = reference.omega.iter().chain(&reference.sd);
        match values.all(|value| value.is_finite()) {
            true => Ok(reference),
            false => Err(
                "counts_large is no motion of a shaft: the reference of a log without true_omega, \
                 which is smoothed from it, is not finite"
                    .to_owned(),
            ),
        }
    }

    /// The reference with given noises.
    #[must_use]
    pub fn with(recording: &Recording, counts_per_rev: u32, noises: Noises) -> Self {
        Self::in_pieces(recording, counts_per_rev, noises, PIECE, OVERLAP)
    }

    /// The reference, computed in pieces of `piece` rows with `overlap` rows more on both sides.
    fn in_pieces(
        recording: &Recording,
        counts_per_rev: u32,
        noises: Noises,
        piece: usize,
        overlap: usize,
    ) -> Self {
        let rows = recording.t.len();
        // In the time in which the motion is seen: in that of a row the state before the first observation would have
        // velocities and accelerations beyond those of a slow motion by more than the digits of the arithmetic.
        let every = thinned::every(recording);
        let period = every as f64 * recording.trace.period_s();
        let mut motion = Motion::of(recording);
        if let Some(thinned) = thinned::thinned(recording) {
            motion.fastest = Motion::of(&thinned).fastest;
        }
        let known = sections::known(&motion.rows, recording.trace.rate_hz);
        thinned::pass_over(&mut motion.rows, recording);
        let model = Model {
            jerk: noises.jerk * period.powi(5),
            sensor: noises.sensor,
            fastest: motion.fastest,
        };
        let smoothed = |first: usize| {
            let inner = first..(first + piece).min(rows);
            let outer = first.saturating_sub(overlap)..(inner.end + overlap).min(rows);
            let events = events::events(recording, &motion.rows, outer.clone(), period);
            let (velocities, sites) = sweeps::smoothed(&events, model);
            let precision: f64 = sites.iter().map(|site| site.precision).sum();
            let of_inner = inner.start - outer.start..inner.end - outer.start;
            let share = inner.len() as f64 / outer.len() as f64;
            (velocities[of_inner].to_vec(), share * precision)
        };
        let firsts: Vec<usize> = (0..rows).step_by(piece).collect();
        let pieces: Vec<_> = firsts.into_par_iter().map(smoothed).collect();
        let precision: f64 = pieces.iter().map(|(_, precision)| precision).sum();
        let scale = TAU / f64::from(counts_per_rev) / period;
        let all = || pieces.iter().flat_map(|(velocities, _)| velocities);
        // The smoother of a triple integrator is 1 / (1 + (w / w0)^6), w0^6 = density of the jerk times
        // the information on the position in a unit of time.
        let precision = precision / rows as f64 * every as f64;
        let corner = (model.jerk * precision).powf(1.0 / 6.0);
        Self {
            omega: all().map(|s| scale * s.velocity).collect(),
            sd: all().map(|s| scale * s.variance.sqrt()).collect(),
            known,
            noises,
            bandwidth_hz: corner / TAU / period,
        }
    }

    /// Root mean square of the standard deviation at the rows that are scored, rad/s.
    #[must_use]
    pub fn rms_sd(&self, rate_hz: f64) -> f64 {
        rms_scored(&self.sd, rate_hz, self.known.as_deref())
    }

    /// Makes `rows` of the reference the velocity against which `trace`, which has these rows, is scored.
    ///
    /// # Panics
    /// If the reference does not have these rows.
    pub fn to_trace(&self, trace: &mut Trace, rows: Range<usize>) {
        trace.true_omega = Some(self.omega[rows.clone()].to_vec());
        trace.known = self.known.as_ref().map(|known| known[rows].to_vec());
    }

    /// A sentence on the reference's error and what it does not resolve, for a recording at `rate_hz`.
    #[must_use]
    pub fn limits(&self, rate_hz: f64) -> String {
        let sd = self.rms_sd(rate_hz);
        let noise = self.noises.sensor.sqrt();
        let noise = match noise >= NOISY {
            true => format!(
                "; counts and times have a noise of {} counts (standard deviation), and tune finds settings for it",
                number(Some(noise))
            ),
            false => String::new(),
        };
        let bandwidth = match self.bandwidth_hz {
            fast if fast >= 10.0 => format!("{fast:.0}"),
            slow if slow >= 0.1 => format!("{slow:.1}"),
            rest => number(Some(rest)),
        };
        format!(
            "the reference is smoothed from the counts in both directions of time; its standard \
             deviation is {} rad/s (RMS), so errors below {} rad/s rank no estimator. It does not \
             resolve motion above about {bandwidth} Hz, motion within a count, and errors of the encoder's disc{noise}",
            number(Some(sd)),
            number(Some(RESOLVED * sd)),
        )
    }

    /// Whether an RMS error `rms_rad_s` against the reference is that of the estimator: at least
    /// [`RESOLVED`] times the reference's own.
    #[must_use]
    pub fn resolves(&self, rms_rad_s: f64, rate_hz: f64) -> bool {
        rms_rad_s >= RESOLVED * self.rms_sd(rate_hz)
    }
}

impl Noises {
    /// The noises that make the innovations of `recording` most likely.
    ///
    /// # Errors
    /// As [`Reference::of`].
    pub fn of(recording: &Recording) -> Result<Self, String> {
        let counts = &recording.trace.counts_large;
        if counts.len() < FEWEST_ROWS {
            return Err(format!(
                "{} rows; a reference without true_omega needs at least {FEWEST_ROWS}",
                counts.len()
            ));
        }
        let changes = counts.windows(2).filter(|pair| pair[0] != pair[1]).count();
        if changes < FEWEST_CHANGES {
            let finer = recording.finer.as_ref();
            let finer = finer.filter(|finer| finer.changes >= FEWEST_CHANGES);
            let remedy = finer.map_or("record more motion", |finer| &finer.remedy);
            return Err(format!(
                "counts_large changes at {changes} rows; a reference without true_omega needs at least \
                 {FEWEST_CHANGES}: {remedy}"
            ));
        }
        let thinned = thinned::thinned(recording);
        let recording = thinned.as_ref().unwrap_or(recording);
        let period = recording.trace.period_s();
        let model = noises::most_likely(recording, &Motion::of(recording), period);
        Ok(Self {
            jerk: model.jerk / period.powi(5),
            sensor: model.sensor,
        })
    }
}

/// Lines on what decides a ranking without being an error of an estimator, for a recording whose scores are against
/// `reference`, or against its true velocity: rows that are no motion, and a truth that is not that of the counts.
#[must_use]
pub fn remarks(
    recording: &Recording,
    reference: Option<&Reference>,
    counts_per_rev: u32,
) -> Vec<String> {
    let mut truth = TruthCheck::default();
    truth.add(recording, counts_per_rev);
    let interrupted = interruptions(recording, reference).into_iter();
    interrupted.chain(truth.line()).collect()
}

#[cfg(test)]
mod tests;
