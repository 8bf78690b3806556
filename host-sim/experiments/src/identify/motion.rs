//! Angle and direction of a shaft from its counts.

use std::f64::consts::TAU;

/// Time over which the direction of motion is determined, s.
const DIRECTION_S: f64 = 8e-3;
/// Smallest displacement in [`DIRECTION_S`] with a certain direction, counts.
const SURE_COUNTS: f64 = 1.5;

/// Motion of one shaft over a recording.
#[derive(Clone, Debug)]
pub(super) struct Motion {
    /// Angle from the first sample, rad.
    pub(super) angle: Vec<f64>,
    /// Direction: -1 or 1, or 0 if it is uncertain.
    pub(super) direction: Vec<i8>,
    rad_per_count: f64,
}

impl Motion {
    /// The motion from counts of a modular counter.
    pub(super) fn new(counts: &[u32], counts_per_rev: u32, period_s: f64) -> Self {
        let rad_per_count = TAU / f64::from(counts_per_rev);
        let mut place = 0_i64;
        let mut last = counts.first().copied().unwrap_or_default();
        let angle: Vec<f64> = counts
            .iter()
            .map(|&count| {
                place += i64::from(count.wrapping_sub(last) as i32);
                last = count;
                place as f64 * rad_per_count
            })
            .collect();
        let side = ((0.5 * DIRECTION_S / period_s).round() as usize).max(2);
        // Slope of the least-squares line over 2 side + 1 samples, times their duration.
        let squares: f64 = (1..=side).map(|j| 2.0 * (j * j) as f64).sum();
        let per_sure = 2.0 * side as f64 / squares / (SURE_COUNTS * rad_per_count);
        let direction = (0..angle.len())
            .map(|k| {
                if k < side || k + side >= angle.len() {
                    return 0;
                }
                let around = &angle[k - side..=k + side];
                let steps = around.windows(2).map(|pair| pair[1] - pair[0]);
                let (back, forth) = steps.fold((false, false), |(back, forth), step| {
                    (back | (step < 0.0), forth | (step > 0.0))
                });
                // Two reversals within the samples of the slope do not make the direction uncertain.
                if back && forth {
                    return 0;
                }
                let slope: f64 = (1..=side)
                    .map(|j| j as f64 * (angle[k + j] - angle[k - j]))
                    .sum();
                (slope * per_sure).clamp(-1.0, 1.0) as i8
            })
            .collect();
        Self {
            angle,
            direction,
            rad_per_count,
        }
    }

    /// The change of the angle of this sample, if the counter had no lowest bit, rad.
    pub(super) fn odd(&self, sample: usize) -> f64 {
        let place = (self.angle[sample] / self.rad_per_count).round() as i64;
        -((place & 1) as f64) * self.rad_per_count
    }

    /// The smallest and largest mean velocity over windows of `window_s`, rad/s, with those of `before`.
    pub(super) fn velocities(
        &self,
        window_s: f64,
        period_s: f64,
        before: Option<[f64; 2]>,
    ) -> Option<[f64; 2]> {
        let samples = ((window_s / period_s).round() as usize).max(1);
        let windows = self.angle.windows(samples + 1).step_by(samples);
        let seconds = samples as f64 * period_s;
        let velocity = windows.map(|angle| (angle[samples] - angle[0]) / seconds);
        velocity.fold(before, |ends, omega| {
            let [low, high] = ends.unwrap_or([omega; 2]);
            Some([low.min(omega), high.max(omega)])
        })
    }

    /// Largest minus smallest angle, rad.
    pub(super) fn travel(&self) -> f64 {
        let low = self.angle.iter().copied().fold(f64::INFINITY, f64::min);
        let high = self.angle.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        high - low
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn direction_is_constant_over_a_wrap_and_zero_at_rest() {
        let counts: Vec<u32> = (0..100_u32)
            .map(|k| (k.min(50) * 3).wrapping_sub(60))
            .collect();
        let motion = Motion::new(&counts, 4096, 1e-3);
        assert!((motion.travel() - 150.0 * TAU / 4096.0).abs() < 1e-12);
        assert_eq!(motion.direction[20], 1);
        assert_eq!(motion.direction[80], 0);
        let back: Vec<u32> = counts.iter().map(|count| count.wrapping_neg()).collect();
        assert_eq!(Motion::new(&back, 4096, 1e-3).direction[20], -1);
    }
}
