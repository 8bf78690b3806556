//! The true velocity of one trace, prepared once for all estimates.

use std::ops::Range;

use super::{HapticInterval, Score, TACTILE_BAND_HZ, Wanted, delay, scored, skipped, transient};
use crate::percentile;
use crate::spectrum::Welch;

/// A true velocity, and the quantities of the scores that depend on it alone.
pub struct Truth<'a> {
    omega: &'a [f64],
    rate_hz: f64,
    interval: HapticInterval,
    wanted: Wanted,
    /// First sample that may be scored.
    skip: usize,
    /// Ranges of samples that are scored, in order.
    ranges: Vec<Range<usize>>,
    /// Their number.
    scored: usize,
    /// [`HapticInterval::tolerance`] of every sample from `skip` on; empty if no selected score
    /// needs it.
    tolerance: Vec<f64>,
    /// Ranges of scored samples in a transient.
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
        Self::where_known(omega, None, rate_hz, interval, wanted)
    }

    /// As [`Truth::new`]; samples at which the velocity is not `known` are not scored.
    ///
    /// # Errors
    /// As [`Truth::new`].
    ///
    /// # Panics
    /// If `known` has fewer values than `omega`.
    pub fn where_known(
        omega: &'a [f64],
        known: Option<&[bool]>,
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
        let ranges = scored(omega.len(), rate_hz, known);
        let skip = ranges.first().map_or(omega.len(), |range| range.start);
        let by_distance = wanted.distance || wanted.distance_transient || wanted.outside;
        let later = &omega[skip..];
        Ok(Self {
            omega,
            rate_hz,
            interval,
            wanted,
            skip,
            tolerance: if by_distance {
                later.iter().map(|&w| interval.tolerance(w)).collect()
            } else {
                Vec::new()
            },
            transients: if wanted.distance_transient {
                common(&transient::ranges(omega, rate_hz, skip), &ranges)
            } else {
                Vec::new()
            },
            variation: if wanted.chatter {
                let steps = neighbours(omega, &ranges);
                steps.map(|(before, after)| (after - before).abs()).sum()
            } else {
                0.0
            },
            welch: wanted.noise.then(|| Welch::new(rate_hz)),
            scored: ranges.iter().map(Range::len).sum(),
            ranges,
        })
    }

    /// Ranges of scored samples in a transient; empty if the transient distance is not selected.
    #[must_use]
    pub fn transients(&self) -> &[Range<usize>] {
        &self.transients
    }

    /// Number of samples that are scored.
    #[must_use]
    pub fn scored(&self) -> usize {
        self.scored
    }

    /// Sum of the squared differences of neighbouring scored samples, (rad/s)^2.
    pub(super) fn slope(&self) -> f64 {
        let steps = neighbours(self.omega, &self.ranges);
        steps.map(|(before, after)| (after - before).powi(2)).sum()
    }

    /// The errors of an estimate in the samples that are scored, rad/s.
    pub(super) fn errors(&self, estimate: &[f32]) -> impl Iterator<Item = f64> {
        self.ranges.iter().flat_map(|range| {
            let scored = estimate[range.clone()].iter();
            let pairs = scored.zip(&self.omega[range.clone()]);
            pairs.map(|(&e, w)| f64::from(e) - w)
        })
    }

    /// Share of the scored samples that are within two of their standard deviations `deviation` (rad/s)
    /// of this truth, 0 to 1; `None` if no sample is scored.
    ///
    /// # Panics
    /// If `estimate`, `deviation` and the truth differ in length.
    #[must_use]
    pub fn within_2_sigma(&self, estimate: &[f32], deviation: &[f32]) -> Option<f64> {
        for samples in [estimate.len(), deviation.len()] {
            assert_eq!(samples, self.omega.len(), "one value per sample");
        }
        let inside = |k: &usize| is_within_2_sigma(estimate[*k], deviation[*k], self.omega[*k]);
        let samples = self.ranges.iter().cloned().flatten();
        let inside = samples.filter(inside).count();
        (self.scored > 0).then(|| inside as f64 / self.scored as f64)
    }

    /// Scores an estimate (rad/s) of this truth. All scores are `None` if no sample is scored.
    ///
    /// # Panics
    /// If the estimate and the truth differ in length.
    #[must_use]
    pub fn score(&self, estimate: &[f32]) -> Score {
        assert_eq!(estimate.len(), self.omega.len(), "one estimate per sample");
        if self.scored == 0 {
            return Score::default();
        }
        let scored = self
            .ranges
            .iter()
            .flat_map(|range| &estimate[range.clone()]);
        let non_finite = scored.filter(|e| !e.is_finite()).count();
        if non_finite > 0 {
            return self.not_finite(estimate, non_finite);
        }
        let wanted = &self.wanted;
        let (rms, max) = if wanted.rms || wanted.max || wanted.force {
            self.error_size(estimate)
        } else {
            (0.0, 0.0)
        };
        let (distance, outside) = if wanted.distance || wanted.outside {
            self.distance(estimate)
        } else {
            (0.0, 0.0)
        };
        Score {
            rms_rad_s: wanted.rms.then_some(rms),
            max_rad_s: wanted.max.then_some(max),
            p99_rad_s: (wanted.p99).then(|| percentile(self.errors(estimate), 0.99)),
            distance_rad_s: wanted.distance.then_some(distance),
            distance_transient_rad_s: self.distance_in_transients(estimate),
            outside: wanted.outside.then_some(outside),
            delay_ms: (wanted.delay)
                .then(|| delay::samples(self.omega, estimate, skipped(self.rate_hz), &self.ranges))
                .flatten()
                .map(|samples| 1e3 * samples / self.rate_hz),
            noise_rad_s: self.noise(estimate),
            chatter_rad_s: wanted.chatter.then(|| self.chatter(estimate)),
            force_mn: wanted
                .force
                .then_some(rms * self.interval.force_mn_per_rad_s),
            ..Score::default()
        }
    }

    /// The scores of an estimate with `non_finite` scored samples that are NaN or infinite.
    fn not_finite(&self, estimate: &[f32], non_finite: usize) -> Score {
        let wanted = &self.wanted;
        let worst = |wanted: bool| wanted.then_some(f64::INFINITY);
        let outside = || {
            let distances = self.distances(estimate, &self.ranges);
            let outside = distances.filter(|d| d.is_nan() || *d > 0.0);
            outside.count() as f64 / self.scored as f64
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

    /// Distance of each estimate in `ranges` of scored samples from the haptic interval, rad/s; negative
    /// inside it.
    fn distances(&self, estimate: &[f32], ranges: &[Range<usize>]) -> impl Iterator<Item = f64> {
        ranges.iter().flat_map(|range| {
            let tolerance = &self.tolerance[range.start - self.skip..range.end - self.skip];
            let pairs = estimate[range.clone()]
                .iter()
                .zip(&self.omega[range.clone()]);
            pairs
                .zip(tolerance)
                .map(|((&e, w), tolerance)| (f64::from(e) - w).abs() - tolerance)
        })
    }

    fn error_size(&self, estimate: &[f32]) -> (f64, f64) {
        let (sum, max) = self.errors(estimate).fold((0.0, 0.0_f64), |(sum, max), e| {
            (sum + e * e, max.max(e.abs()))
        });
        ((sum / self.scored as f64).sqrt(), max)
    }

    fn distance(&self, estimate: &[f32]) -> (f64, f64) {
        let distances = self.distances(estimate, &self.ranges);
        let (sum, outside) = distances.fold((0.0, 0.0), |(sum, outside), distance| {
            let is_outside = f64::from(u8::from(distance > 0.0));
            (sum + distance.max(0.0), outside + is_outside)
        });
        let n = self.scored as f64;
        (sum / n, outside / n)
    }

    fn distance_in_transients(&self, estimate: &[f32]) -> Option<f64> {
        let n: usize = self.transients.iter().map(Range::len).sum();
        let distances = self.distances(estimate, &self.transients);
        let sum: f64 = distances.map(|distance| distance.max(0.0)).sum();
        (n > 0).then(|| sum / n as f64)
    }

    /// The spectrum needs samples without gaps. An unknown error is on the line from the last one before to the first
    /// one after it, which has next to no power in the band, and the mean square is that of the scored samples.
    fn noise(&self, estimate: &[f32]) -> Option<f64> {
        let welch = self.welch.as_ref()?;
        let end = self.ranges.last()?.end;
        let mut errors = Vec::with_capacity(end - self.skip);
        let mut known = self.errors(estimate);
        for range in &self.ranges {
            let mut within = known.by_ref().take(range.len());
            let first = within.next()?;
            let last = errors.last().copied().unwrap_or(first);
            let unknown = range.start - self.skip - errors.len();
            let part = |k: usize| k as f64 / (unknown + 1) as f64;
            errors.extend((1..=unknown).map(|k| last + part(k) * (first - last)));
            errors.push(first);
            errors.extend(within);
        }
        let share = self.scored as f64 / errors.len() as f64;
        let rms = welch.density(&errors)?.rms_within(TACTILE_BAND_HZ)?;
        Some(rms / share.sqrt())
    }

    fn chatter(&self, estimate: &[f32]) -> f64 {
        let steps = neighbours(estimate, &self.ranges);
        let variation: f64 = steps
            .map(|(before, after)| (f64::from(after) - f64::from(before)).abs())
            .sum();
        (variation - self.variation).max(0.0) / self.scored as f64
    }
}

/// Neighbouring values of the same range.
fn neighbours<T: Copy>(values: &[T], ranges: &[Range<usize>]) -> impl Iterator<Item = (T, T)> {
    let pairs = ranges
        .iter()
        .flat_map(|range| values[range.clone()].windows(2));
    pairs.map(|pair| (pair[0], pair[1]))
}

/// The samples that `some` and `others` have in common. Both are in order.
fn common(some: &[Range<usize>], others: &[Range<usize>]) -> Vec<Range<usize>> {
    let common = some.iter().flat_map(|a| {
        let first = others.partition_point(|b| b.end <= a.start);
        let meet = others[first..].iter().take_while(|b| b.start < a.end);
        meet.map(|b| a.start.max(b.start)..a.end.min(b.end))
    });
    common.collect()
}

/// Whether a velocity is within two of its standard deviations of the true one.
#[must_use]
pub fn is_within_2_sigma(velocity: f32, deviation: f32, truth: f64) -> bool {
    (f64::from(velocity) - truth).abs() <= 2.0 * f64::from(deviation)
}

#[cfg(test)]
#[path = "truth_tests.rs"]
mod tests;
