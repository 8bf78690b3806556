//! Rule by which a tuned value is scaled to another encoder and another control rate.

use crate::parameter::Parameter;

/// How the best value of a parameter changes with the counts per revolution N and the control rate f.
///
/// The band of a filter is a compromise between two errors. Quantisation is white noise of variance
/// `R = q²/12`, `q = 2 π/N`, at each tick of `T = 1/f`: its spectral density is `R T`. The motion is
/// white noise of a fixed spectral density S in the first derivative that the filter takes for constant.
/// The best band therefore grows as [`Powers`] of N and f.
///
/// A band is never widened beyond the tuned one: it would pay only for motions as fast as those of the
/// tuning, and slower motions are common. With a finer encoder the tuned band already passes less noise.
/// `docs/theory/presets.md` derives the rule and shows what it gains.
///
/// ```
/// use estimator_catalogue::{Powers, Scaling};
/// // A sixteenth of the counts: 16^(-1/3) of the bandwidth.
/// let ratio = Scaling::Bandwidth(Powers::THREE_POLES).factor(1.0 / 16.0, 1.0);
/// assert!((ratio - 16f64.powf(-1.0 / 3.0)).abs() < 1e-12);
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Scaling {
    /// A quantity of the motion or of the device in SI units, or one in counts. The design itself
    /// accounts for encoder and rate.
    Unscaled,
    /// A frequency of the filter, in proportion to the band.
    Bandwidth(Powers),
    /// A time of the filter, in inverse proportion to the band.
    Time(Powers),
    /// A length of a window in intervals, whose time is in inverse proportion to the band.
    Intervals(Powers),
    /// A standard deviation of a quantity that is drawn anew each tick and has a fixed spectral density:
    /// it grows as the square root of the rate.
    DrawnEachTick,
}

/// Powers of the counts per revolution and of the control rate with which the best band grows, in
/// twelfths: `N^(counts/12) f^(rate/12)`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Powers {
    /// Power of the counts per revolution, twelfths.
    pub counts: u8,
    /// Power of the control rate, twelfths.
    pub rate: u8,
}

impl Powers {
    /// One pole over the finite difference: `(S/R)^(1/3)`.
    pub const ONE_POLE: Self = Self { counts: 8, rate: 0 };
    /// Two poles, or a line: the velocity is taken for constant, `(S/(R T))^(1/4)`.
    pub const TWO_POLES: Self = Self { counts: 6, rate: 3 };
    /// Three poles, or a parabola: the acceleration is taken for constant, `(S/(R T))^(1/6)`.
    pub const THREE_POLES: Self = Self { counts: 4, rate: 2 };
    /// The longest window in which an acceleration a bends a line by a fixed number of counts:
    /// `sqrt(a/q)`.
    pub const STRAIGHT: Self = Self { counts: 6, rate: 0 };

    /// Ratio of the band to the tuned one, at most 1.
    const fn band(self, counts: f64, rate: f64) -> f64 {
        let best = power(counts, self.counts) * power(rate, self.rate);
        if best < 1.0 { best } else { 1.0 }
    }
}

impl Scaling {
    /// Ratio of the scaled to the tuned value, for the ratios of the counts per revolution and of the
    /// control rates. It is exactly 1 where both ratios are 1. A ratio that is not positive and finite
    /// counts as 1.
    #[must_use]
    pub const fn factor(self, counts: f64, rate: f64) -> f64 {
        let (counts, rate) = (positive(counts), positive(rate));
        match self {
            Self::Unscaled => 1.0,
            Self::Bandwidth(powers) => powers.band(counts, rate),
            Self::Time(powers) => 1.0 / powers.band(counts, rate),
            Self::Intervals(powers) => rate / powers.band(counts, rate),
            Self::DrawnEachTick => power(rate, 6),
        }
    }
}

impl Parameter {
    /// A value tuned for one encoder and rate, scaled to another one by [`Self::scaling`]: within the
    /// range of the parameter, and whole where it must be. A window keeps at least two intervals, because
    /// one interval is the finite difference. The ratios are those of [`Scaling::factor`].
    #[must_use]
    pub const fn scaled(&self, tuned: f64, counts: f64, rate: f64) -> f64 {
        let scaled = tuned * self.scaling.factor(counts, rate);
        let lowest = match self.scaling {
            Scaling::Intervals(_) if tuned >= 2.0 => 2.0,
            _ => self.lowest,
        };
        let scaled = scaled.clamp(lowest, self.highest);
        if self.whole {
            // Whole parameters are not negative.
            (scaled + 0.5) as u64 as f64
        } else {
            scaled
        }
    }
}

/// The ratio, or 1 if it is not positive and finite.
const fn positive(ratio: f64) -> f64 {
    if ratio > 0.0 && ratio < f64::INFINITY {
        ratio
    } else {
        1.0
    }
}

/// `ratio` to the power `twelfths`/12, for a positive and finite ratio.
const fn power(ratio: f64, twelfths: u8) -> f64 {
    let root = twelfth_root(if ratio < 1.0 { 1.0 / ratio } else { ratio });
    let (mut power, mut left) = (1.0, twelfths);
    while left > 0 {
        power *= root;
        left -= 1;
    }
    if ratio < 1.0 { 1.0 / power } else { power }
}

/// The twelfth root of `x >= 1` by Newton's iteration from above. The first value is above the root by
/// Bernoulli's inequality.
const fn twelfth_root(x: f64) -> f64 {
    let mut root = 1.0 + (x - 1.0) / 12.0;
    loop {
        let square = root * root;
        let fourth = square * square;
        let next = root - (root - x / (fourth * fourth * square * root)) / 12.0;
        // Rounding ends the descent, and so does a NaN.
        if next < root {
            root = next;
        } else {
            return root;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{ROWS, Search};

    const COUNTS: [f64; 7] = [1e-5, 64.0 / 4096.0, 0.999, 1.0, 1.1, 4.0, 1e6];
    const RATES: [f64; 6] = [1e-3, 0.5, 1.0, 1.5, 11.6, 1e4];

    #[test]
    fn factor_is_the_power_of_both_ratios_and_widens_no_band() {
        for powers in [
            Powers::ONE_POLE,
            Powers::TWO_POLES,
            Powers::THREE_POLES,
            Powers::STRAIGHT,
        ] {
            let power = |ratio: f64, twelfths: u8| ratio.powf(f64::from(twelfths) / 12.0);
            for (counts, rate) in COUNTS.iter().flat_map(|n| RATES.map(|f| (*n, f))) {
                let best = power(counts, powers.counts) * power(rate, powers.rate);
                let band = best.min(1.0);
                for (scaling, exact) in [
                    (Scaling::Bandwidth(powers), band),
                    (Scaling::Time(powers), 1.0 / band),
                    (Scaling::Intervals(powers), rate / band),
                    (Scaling::DrawnEachTick, rate.sqrt()),
                    (Scaling::Unscaled, 1.0),
                ] {
                    let error = (scaling.factor(counts, rate) / exact - 1.0).abs();
                    // A rounding of the root becomes up to twelve of the power, for both ratios.
                    assert!(
                        error < 48.0 * f64::EPSILON,
                        "{scaling:?} {counts} {rate}: {error}"
                    );
                }
            }
            for wrong in [0.0, -1.0, f64::NAN, f64::INFINITY] {
                assert_eq!(Scaling::Intervals(powers).factor(wrong, wrong), 1.0);
            }
        }
    }

    #[test]
    fn value_is_unchanged_at_the_tuned_point_and_in_its_range_elsewhere() {
        for parameter in ROWS.iter().flat_map(|row| row.parameters) {
            let (low, high) = match parameter.search {
                Search::Log(low, high) => (low, high),
                Search::Each(low, high) => (f64::from(low), f64::from(high)),
                Search::Fixed(value) => (value, value),
            };
            for tuned in [low, high] {
                assert_eq!(parameter.scaled(tuned, 1.0, 1.0), tuned, "{parameter:?}");
                for ratio in [1e-9, 1e-3, 0.7, 3.0, 1e3, 1e9] {
                    for (counts, rate) in [(ratio, 1.0), (1.0, ratio)] {
                        let scaled = parameter.scaled(tuned, counts, rate);
                        let range = parameter.lowest..=parameter.highest;
                        assert!(range.contains(&scaled), "{parameter:?}: {scaled}");
                        assert!(!parameter.whole || scaled.fract() == 0.0);
                    }
                }
            }
        }
    }

    #[test]
    fn window_of_several_intervals_keeps_two() {
        let window = Parameter {
            scaling: Scaling::Intervals(Powers::STRAIGHT),
            ..Parameter::WINDOW
        };
        let scaled = [(2.0, 1.0), (2.0, 0.5), (5.0, 0.01), (1.0, 0.5)]
            .map(|(tuned, rate)| window.scaled(tuned, 1.0, rate));
        assert_eq!(scaled, [2.0, 2.0, 2.0, 1.0]);
        // 4.2 and 4.8 intervals.
        let rounded = [1.4, 1.6].map(|rate| window.scaled(3.0, 1.0, rate));
        assert_eq!(rounded, [4.0, 5.0]);
    }

    /// A coarser encoder never gets a wider band or a shorter window, and a higher rate never a
    /// narrower band nor fewer intervals. A sign of zero means that the value stays.
    #[test]
    fn bandwidth_and_window_are_monotonic_in_counts_and_rate() {
        let parameter = |row: &str, name: &str| {
            let row = ROWS.iter().find(|of| of.name == row).unwrap();
            row.parameters.iter().find(|of| of.name == name).unwrap()
        };
        let ratios = [1e-3, 0.1, 0.5, 0.9, 1.0, 1.2, 2.0, 10.0, 1e3];
        for (row, name, tuned, with_counts, with_rate) in [
            ("low-pass", "cutoff_hz", 100.0, 1.0, 0.0),
            ("pll", "bandwidth_hz", 100.0, 1.0, 1.0),
            ("alpha-beta-gamma", "bandwidth_hz", 100.0, 1.0, 1.0),
            ("linear-eso", "bandwidth_hz", 100.0, 1.0, 1.0),
            ("foaw-end-fit", "n", 12.0, -1.0, 1.0),
            ("foaw-best-fit", "n", 12.0, -1.0, 1.0),
            ("foaw-end-fit", "d", 1.0, 0.0, 0.0),
            ("savitzky-golay", "n", 12.0, -1.0, 1.0),
            ("tracking-differentiator", "filter_time", 1e-3, -1.0, -1.0),
            ("tracking-differentiator", "acceleration", 1e3, 0.0, 0.0),
            ("kalman-motor", "current_noise", 0.1, 0.0, 1.0),
            ("kalman-triple", "jerk", 4e3, 0.0, 0.0),
        ] {
            let parameter = parameter(row, name);
            let mut changed = [false; 2];
            for pair in ratios.windows(2) {
                let counts = [0, 1].map(|i| parameter.scaled(tuned, pair[i], 1.0));
                let rate = [0, 1].map(|i| parameter.scaled(tuned, 1.0, pair[i]));
                let both = [(counts, with_counts), (rate, with_rate)];
                for (i, ([low, high], sign)) in both.into_iter().enumerate() {
                    assert!(sign * (high - low) >= 0.0, "{row}.{name}: {low}, {high}");
                    changed[i] |= low != high;
                }
            }
            assert_eq!(
                changed,
                [with_counts != 0.0, with_rate != 0.0],
                "{row}.{name}"
            );
        }
    }
}
