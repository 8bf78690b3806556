//! The true velocity of one trace, prepared once for all estimates.

use std::ops::Range;

use super::{HapticInterval, SKIP_S, Score, TACTILE_BAND_HZ, Wanted, delay, transient};
use crate::percentile;
use crate::spectrum::Welch;

/// A true velocity, and the quantities of the scores that depend on it alone.
pub struct Truth<'a> {
    omega: &'a [f64],
    rate_hz: f64,
    interval: HapticInterval,
    wanted: Wanted,
    /// First sample that is scored.
    skip: usize,
    /// [`HapticInterval::tolerance`] of every sample from `skip` on; empty if no selected score
    /// needs it.
    tolerance: Vec<f64>,
    /// Ranges of samples in a transient, counted from the start of the trace, from `skip` on.
    transients: Vec<Range<usize>>,
    variation: f64,
    welch: Option<Welch>,
}

impl<'a> Truth<'a> {
    /// Prepares the true velocity `omega` (rad/s), sampled at `rate_hz`, for the scores `wanted`.
    ///
    /// # Errors
    /// If the rate is not positive or a velocity is not finite.
    pub fn new(
        omega: &'a [f64],
        rate_hz: f64,
        interval: HapticInterval,
        wanted: Wanted,
    ) -> Result<Self, String> {
        if !(rate_hz > 0.0 && rate_hz.is_finite()) {
            return Err(format!("sample rate {rate_hz} Hz: must be positive"));
        }
        if let Some(at) = omega.iter().position(|w| !w.is_finite()) {
            let omega = omega[at];
            return Err(format!(
                "true velocity of sample {at} is {omega}: must be finite"
            ));
        }
        let skip = ((SKIP_S * rate_hz).round() as usize).min(omega.len());
        let scored = &omega[skip..];
        let by_distance = wanted.distance || wanted.distance_transient || wanted.outside;
        Ok(Self {
            omega,
            rate_hz,
            interval,
            wanted,
            skip,
            tolerance: if by_distance {
                scored.iter().map(|&w| interval.tolerance(w)).collect()
            } else {
                Vec::new()
            },
            transients: if wanted.distance_transient {
                transient::ranges(omega, rate_hz, skip)
            } else {
                Vec::new()
            },
            variation: if wanted.chatter {
                scored.windows(2).map(|w| (w[1] - w[0]).abs()).sum()
            } else {
                0.0
            },
            welch: wanted.noise.then(|| Welch::new(rate_hz)),
        })
    }

    /// Ranges of samples in a transient, counted from the start of the trace, from [`SKIP_S`] on;
    /// empty if the transient distance is not selected.
    #[must_use]
    pub fn transients(&self) -> &[Range<usize>] {
        &self.transients
    }

    /// Number of samples that are scored.
    #[must_use]
    pub fn scored(&self) -> usize {
        self.omega.len() - self.skip
    }

    /// Sum of the squared differences of neighbouring samples, (rad/s)^2.
    pub(super) fn slope(&self) -> f64 {
        let differences = self.omega.windows(2).map(|pair| pair[1] - pair[0]);
        differences.map(|difference| difference * difference).sum()
    }

    /// The errors of an estimate in the samples that are scored, rad/s.
    pub(super) fn scored_errors(&self, estimate: &[f32]) -> impl Iterator<Item = f64> {
        self.errors(&estimate[self.skip..])
    }

    /// Scores an estimate (rad/s) of this truth. All scores are `None` if the trace is not longer
    /// than [`SKIP_S`].
    ///
    /// # Panics
    /// If the estimate and the truth differ in length.
    #[must_use]
    pub fn score(&self, estimate: &[f32]) -> Score {
        assert_eq!(estimate.len(), self.omega.len(), "one estimate per sample");
        let scored = &estimate[self.skip..];
        if scored.is_empty() {
            return Score::default();
        }
        let non_finite = scored.iter().filter(|e| !e.is_finite()).count();
        if non_finite > 0 {
            return self.not_finite(scored, non_finite);
        }
        let wanted = &self.wanted;
        let (rms, max) = if wanted.rms || wanted.max || wanted.force {
            self.error_size(scored)
        } else {
            (0.0, 0.0)
        };
        let (distance, outside) = if wanted.distance || wanted.outside {
            self.distance(scored)
        } else {
            (0.0, 0.0)
        };
        Score {
            rms_rad_s: wanted.rms.then_some(rms),
            max_rad_s: wanted.max.then_some(max),
            p99_rad_s: (wanted.p99).then(|| percentile(self.errors(scored), 0.99)),
            distance_rad_s: wanted.distance.then_some(distance),
            distance_transient_rad_s: self.distance_in_transients(scored),
            outside: wanted.outside.then_some(outside),
            delay_ms: (wanted.delay)
                .then(|| delay::samples(self.omega, estimate, self.skip))
                .flatten()
                .map(|samples| 1e3 * samples / self.rate_hz),
            noise_rad_s: self.noise(scored),
            chatter_rad_s: wanted.chatter.then(|| self.chatter(scored)),
            force_mn: wanted
                .force
                .then_some(rms * self.interval.force_mn_per_rad_s),
            ..Score::default()
        }
    }

    /// The scores of an estimate with `non_finite` samples that are NaN or infinite.
    fn not_finite(&self, scored: &[f32], non_finite: usize) -> Score {
        let wanted = &self.wanted;
        let worst = |wanted: bool| wanted.then_some(f64::INFINITY);
        let outside = || {
            let outside = self.distances(0, scored).filter(|d| d.is_nan() || *d > 0.0);
            outside.count() as f64 / scored.len() as f64
        };
        Score {
            rms_rad_s: worst(wanted.rms),
            max_rad_s: worst(wanted.max),
            p99_rad_s: worst(wanted.p99),
            distance_rad_s: worst(wanted.distance),
            distance_transient_rad_s: worst(!self.transients.is_empty()),
            outside: wanted.outside.then(outside),
            force_mn: worst(wanted.force),
            non_finite,
            ..Score::default()
        }
    }

    fn errors(&self, scored: &[f32]) -> impl Iterator<Item = f64> {
        let truth = &self.omega[self.skip..];
        scored.iter().zip(truth).map(|(&e, w)| f64::from(e) - w)
    }

    /// Distance of each estimate from the haptic interval, rad/s; negative inside it. `first` is
    /// the index of `estimates[0]` among the scored samples.
    fn distances(&self, first: usize, estimates: &[f32]) -> impl Iterator<Item = f64> {
        let truth = &self.omega[self.skip + first..];
        let tolerance = &self.tolerance[first..];
        estimates
            .iter()
            .zip(truth)
            .zip(tolerance)
            .map(|((&e, w), tolerance)| (f64::from(e) - w).abs() - tolerance)
    }

    fn error_size(&self, scored: &[f32]) -> (f64, f64) {
        let (sum, max) = self.errors(scored).fold((0.0, 0.0_f64), |(sum, max), e| {
            (sum + e * e, max.max(e.abs()))
        });
        ((sum / scored.len() as f64).sqrt(), max)
    }

    fn distance(&self, scored: &[f32]) -> (f64, f64) {
        let (sum, outside) =
            self.distances(0, scored)
                .fold((0.0, 0.0), |(sum, outside), distance| {
                    let is_outside = f64::from(u8::from(distance > 0.0));
                    (sum + distance.max(0.0), outside + is_outside)
                });
        let n = scored.len() as f64;
        (sum / n, outside / n)
    }

    fn distance_in_transients(&self, scored: &[f32]) -> Option<f64> {
        let (mut sum, mut n) = (0.0, 0);
        for range in &self.transients {
            let first = range.start - self.skip;
            let estimates = &scored[first..range.end - self.skip];
            n += estimates.len();
            sum += self
                .distances(first, estimates)
                .map(|distance| distance.max(0.0))
                .sum::<f64>();
        }
        (n > 0).then(|| sum / n as f64)
    }

    fn noise(&self, scored: &[f32]) -> Option<f64> {
        let errors: Vec<f64> = self.welch.as_ref().map(|_| self.errors(scored).collect())?;
        let density = self.welch.as_ref()?.density(&errors)?;
        density.rms_within(TACTILE_BAND_HZ)
    }

    fn chatter(&self, scored: &[f32]) -> f64 {
        let variation: f64 = scored
            .windows(2)
            .map(|pair| (f64::from(pair[1]) - f64::from(pair[0])).abs())
            .sum();
        (variation - self.variation).max(0.0) / scored.len() as f64
    }
}

#[cfg(test)]
#[path = "truth_tests.rs"]
mod tests;
