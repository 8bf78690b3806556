//! What a peer sees: the coarse encoder at the rate of the peer.

use std::f64::consts::TAU;

use catalogue::estimators::sample;
use estimator_core::{Hertz, Sample, Signals, VelocityEstimator};
use simulation::trace::Trace;
use terminal::failure::Failure;

use super::list::Peer;
use crate::real::cases::{Case, Recordings};

/// Part of a period by which a sample may be after the tick that reads it: rounding.
const SAME_INSTANT: f64 = 1e-6;

/// Samples at a rate, and the ticks at which their velocities are read.
pub struct Path {
    rate_hz: f64,
    counts_per_rev: u32,
    samples: Vec<Sample>,
    /// The newest sample at or before each tick.
    ticks: Vec<usize>,
}

/// The newest of `samples` at `sample_rate_hz` at or before each of `ticks` at `rate_hz`.
pub(super) fn ticks(rate_hz: f64, ticks: usize, sample_rate_hz: f64, samples: usize) -> Vec<usize> {
    let ratio = sample_rate_hz / rate_hz;
    let newest = |k: usize| ((k as f64 * ratio + SAME_INSTANT) as usize).min(samples - 1);
    (0..ticks).map(newest).collect()
}

/// The path that `peer` sees in `case`, whose ticks are those of `trace`.
pub(super) fn of(
    recordings: &Recordings,
    case: &Case,
    peer: &Peer,
    trace: &Trace,
) -> Result<Path, Failure> {
    let path = |seen: &Trace| Path {
        ticks: ticks(trace.rate_hz, trace.len(), seen.rate_hz, seen.len()),
        ..Path::new(seen, trace.rate_hz, trace.len(), case.counts_per_rev)
    };
    match peer.rate_hz {
        None => Ok(path(trace)),
        Some(rate_hz) => {
            let seen = recordings.recording_at(case, rate_hz)?;
            Ok(path(&seen.trace))
        }
    }
}

impl Path {
    /// The samples of `trace`, read at the first `ticks` ticks of `rate_hz`.
    pub(super) fn new(trace: &Trace, rate_hz: f64, count: usize, counts_per_rev: u32) -> Self {
        let signals = Signals {
            edge: true,
            ..Signals::COUNT
        };
        Self {
            rate_hz: trace.rate_hz,
            counts_per_rev,
            samples: (0..trace.len())
                .map(|k| sample(signals, trace, k))
                .collect(),
            ticks: ticks(rate_hz, count, trace.rate_hz, trace.len()),
        }
    }

    /// Rate of the samples.
    #[must_use]
    pub fn rate(&self) -> Hertz {
        Hertz(self.rate_hz)
    }

    /// Counts per revolution of the encoder.
    #[must_use]
    pub fn counts_per_rev(&self) -> u32 {
        self.counts_per_rev
    }

    /// The velocities of `estimator` at the ticks, rad/s; 0 at the first sample.
    pub fn velocities<E: VelocityEstimator>(&self, estimator: &E) -> Vec<f32> {
        let scale = TAU / f64::from(self.counts_per_rev) * self.rate_hz;
        let mut state = estimator.start(&self.samples[0]);
        let mut ticks = self.ticks.iter().copied().peekable();
        let mut velocities = Vec::with_capacity(self.ticks.len());
        let mut velocity = 0.0;
        for (k, sample) in self.samples.iter().enumerate() {
            if k > 0 {
                velocity = estimator.update(&mut state, sample).0;
            }
            while ticks.next_if_eq(&k).is_some() {
                velocities.push((f64::from(velocity) * scale) as f32);
            }
        }
        velocities
    }
}
