//! A Gaussian truncated to the quantisation interval.

/// A Gaussian truncated to ±1/2.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Truncated {
    /// Shift of the mean.
    pub(super) shift: f32,
    /// Factor of the variance, 0 to 1.
    pub(super) kept: f32,
    /// Probability of the interval before.
    pub(super) likelihood: Likelihood,
}

/// `factor · divisor^-16`: a likelihood whose exponential part is too small for an f32 by itself. The
/// part `divisor^-16` stands for `exp(-x)`, with `divisor = 1 + x / 16`.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Likelihood {
    pub(super) factor: f32,
    /// At least 1.
    pub(super) divisor: f32,
}

impl Likelihood {
    /// The likelihood `factor`.
    const fn plain(factor: f32) -> Self {
        Self {
            factor,
            divisor: 1.0,
        }
    }

    /// `factor · exp(-x)`, with the tail of a Student distribution for large x.
    #[inline(always)]
    pub(super) const fn new(factor: f32, x: f32) -> Self {
        Self {
            factor,
            divisor: 1.0 + x * (1.0 / 16.0),
        }
    }

    /// The likelihood of certainty.
    pub(super) const CERTAIN: Self = Self::plain(1.0);

    /// The likelihood over `smallest^-16`, the exponential part of the most likely member, and never 0.
    #[inline(always)]
    pub(super) fn relative(self, smallest: f32) -> f32 {
        let y = smallest / self.divisor;
        let y = y * y;
        let y = y * y;
        let y = y * y;
        let y = y * y;
        self.factor * if y > LEAST { y } else { LEAST }
    }
}

/// The smallest exponential part: a sum of weights stays a normal number.
const LEAST: f32 = 1e-12;

/// What the ends of the interval have truncated before.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Ends {
    /// Square of the deviations from an end beyond which the end truncates nothing.
    reach: f32,
    /// Shift by an end at the least distance so far, deviations.
    shift: f32,
    /// 1 / factor of the variance, and 1 / probability, at this distance.
    per_kept: f32,
    per_probability: f32,
}

impl Ends {
    /// The ends of the interval of a new count.
    const NEW: Self = Self {
        reach: 3.5 * 3.5,
        shift: 0.0,
        per_kept: 1.0,
        per_probability: 1.0,
    };

    /// The ends of an interval in which the count was a tick ago. The density that is left there fills it to
    /// its ends, which are √3 deviations from the mean of a uniform density. The Gaussian that stands for it
    /// has tails beyond them that are no probability. Truncated again at each tick, they would shrink the
    /// density of a shaft that does not move to a point.
    const FILLED: Self = {
        let (shift, kept, probability) = end(1.732_050_8);
        Self {
            reach: 3.0,
            shift,
            per_kept: 1.0 / kept,
            per_probability: 1.0 / probability.factor,
        }
    };

    /// The ends after a tick, in which the count changed or not.
    #[inline(always)]
    pub(super) const fn of(changed: bool) -> &'static Self {
        if changed { &Self::NEW } else { &Self::FILLED }
    }

    /// Truncation by the end at `u` deviations, beyond the one so far.
    #[inline(always)]
    const fn truncate(&self, u: f32) -> (f32, f32, Likelihood) {
        let (shift, kept, mut probability) = end(u);
        probability.factor *= self.per_probability;
        (shift - self.shift, kept * self.per_kept, probability)
    }
}

/// Variance above which a Gaussian is wide: 0.35².
const WIDE: f32 = 0.1225;

/// Truncates the Gaussian of mean `position` and variance `variance` to ±1/2, by what exceeds the earlier
/// truncation by `ends`. `None` if it is inside.
///
/// Up to a standard deviation of 0.35, each end truncates by itself:
/// [`end`] gives its shift, its variance and its probability. Above, the density inside is
/// `exp(κ y - y²/2σ²)` with κ = x / σ². Its variance at κ = 0 is 1 / (12 + 0.45/σ²) to 2 %, its mean
/// the rational function of κ with this slope and the limit 1/2, its variance the derivative of the
/// mean. The probability is the density at x of a Gaussian of variance σ² + 1/12.
#[inline(always)]
pub(super) fn truncate(position: f32, variance: f32, ends: &Ends) -> Option<Truncated> {
    let away = position.abs();
    let inside = 0.5 - away;
    if inside > 0.0 && inside * inside > ends.reach * variance {
        return None;
    }
    let (inwards, kept, likelihood) = if variance > WIDE {
        wide(away, variance)
    } else {
        let per_std_dev = inverse_root(variance);
        let near = ends.truncate(inside * per_std_dev);
        let far = (1.0 - inside) * per_std_dev;
        let (mut inwards, mut kept, mut likelihood) = near;
        if far * far < ends.reach {
            let far = ends.truncate(far);
            inwards -= far.0;
            kept -= 1.0 - far.1;
            likelihood.factor -= 1.0 - far.2.factor;
        }
        (inwards * variance * per_std_dev, kept, likelihood)
    };
    Some(Truncated {
        shift: if position > 0.0 { -inwards } else { inwards },
        kept,
        likelihood,
    })
}

/// Shift, factor of the variance and probability for a wide Gaussian.
#[inline(always)]
fn wide(away: f32, variance: f32) -> (f32, f32, Likelihood) {
    let per_variance = 1.0 / variance;
    let narrowest = 1.0 / (12.0 + 0.45 * per_variance);
    let z = away * per_variance * narrowest;
    let twice = z + z;
    let per = 1.0 / (1.0 + twice + twice * twice);
    let mean = z * (1.0 + twice) * per;
    let kept = narrowest * (1.0 + twice + twice) * per * per * per_variance;
    let blurred = variance + 1.0 / 12.0;
    let per_std_dev = inverse_root(blurred);
    let exponent = 0.5 * away * away * per_std_dev * per_std_dev;
    let likelihood = Likelihood::new(DENSITY_AT_MEAN * per_std_dev, exponent);
    (away - mean, kept, likelihood)
}

/// 1 / √2π.
const DENSITY_AT_MEAN: f32 = 0.398_942_3;

/// Truncation of a standard Gaussian above `u`: shift λ = φ/Φ downwards, factor 1 - λ (λ + u) of the
/// variance, probability Φ. For u above 0 λ is a fourth power, below 0 it is |u| + 1/g with a
/// parabola g, and the factor is the derivative g'/g².
#[inline(always)]
const fn end(u: f32) -> (f32, f32, Likelihood) {
    if u > 0.0 {
        let root = 0.945 - u * (0.205 + 0.0145 * u);
        let root = if root > 0.0 { root } else { 0.0 };
        let square = root * root;
        let shift = square * square;
        (
            shift,
            1.0 - shift * (shift + u),
            Likelihood::plain(1.0 - shift * (0.63 - 0.11 * u)),
        )
    } else {
        let per = 1.0 / (1.2533 - u * (0.571 - 0.066 * u));
        let shift = per - u;
        let kept = (0.571 - 0.132 * u) * per * per;
        // Φ = φ / λ, and 1 / λ = g / (1 + g |u|).
        let likelihood = Likelihood::new(DENSITY_AT_MEAN / shift, 0.5 * u * u);
        (shift, kept, likelihood)
    }
}

/// `1 / √x` for a positive normal x, less at most 5e-6 of it.
///
/// The exponent of x, halved and negated in its bits, gives the root to 3.4 %, with the offset that makes
/// the error after a step of Newton's iteration smallest (Lomont 2003). Two steps follow.
#[inline(always)]
fn inverse_root(x: f32) -> f32 {
    let one = 1.0f32.to_bits();
    let offset = 1.067_55_f32.to_bits() - one;
    let half = 0.5 * x;
    // A NaN with its sign bit set would overflow, and panic in a debug build.
    let mut y = f32::from_bits((one + one / 2 - offset).wrapping_sub(x.to_bits() >> 1));
    for _ in 0..2 {
        y *= 1.5 - half * y * y;
    }
    y
}

#[cfg(test)]
mod tests {
    extern crate std;
    use super::{Ends, inverse_root, truncate};

    /// Shift of the mean, factor of the variance and probability, by numerical integration.
    fn integrated(x: f64, variance: f64) -> (f64, f64, f64) {
        let (mut sums, steps) = ([0.0; 3], 20_000);
        for step in 0..steps {
            let y = (f64::from(step) + 0.5) / f64::from(steps) - 0.5;
            let density = (-0.5 * (y - x) * (y - x) / variance).exp();
            sums[0] += density;
            sums[1] += density * y;
            sums[2] += density * y * y;
        }
        let mean = sums[1] / sums[0];
        let kept = (sums[2] / sums[0] - mean * mean) / variance;
        let whole = f64::from(steps) * (core::f64::consts::TAU * variance).sqrt();
        (mean - x, kept, sums[0] / whole)
    }

    #[test]
    fn truncation_is_that_of_a_gaussian() {
        let mut worst = [0.0f64; 3];
        for deviation in [0.02, 0.1, 0.2, 0.3, 0.34, 0.36, 0.5, 1.0, 3.0, 10.0] {
            for tenth in -60..=60 {
                // From far inside to two and a half deviations outside.
                let x = f64::from(tenth) / 60.0 * (0.5 + 2.5 * deviation);
                let variance = deviation * deviation;
                let (shift, kept, probability) = integrated(x, variance);
                let found = truncate(x as f32, variance as f32, Ends::of(true));
                let found = found.map_or([0.0, 1.0, 1.0], |found| {
                    let probability = found.likelihood.relative(1.0);
                    [found.shift, found.kept, probability].map(f64::from)
                });
                let off = [
                    (found[0] - shift).abs() / deviation,
                    (found[1] - kept).abs(),
                    (found[2] - probability).abs(),
                ];
                for (worst, off) in worst.iter_mut().zip(off) {
                    *worst = worst.max(off);
                }
            }
        }
        let bounds = [0.02, 0.04, 0.04];
        for (worst, bound) in worst.iter().zip(bounds) {
            assert!(*worst < bound, "{worst:?}");
        }
    }

    /// The shaft does not move: what the ends truncate once, they do not truncate again. Mean and variance
    /// stay those of the density after the first tick if it is uniform, and near if it falls from an end.
    #[test]
    fn truncation_of_a_shaft_that_does_not_move_happens_once() {
        for (position, variance) in [(0.0, 10.0), (0.0, 0.11), (0.4, 0.04), (-0.55, 0.01)] {
            let (shift, kept, _) = integrated(position, variance);
            let (mean, after) = (position + shift, kept * variance);
            let [mut x, mut p] = [position, variance].map(|x| x as f32);
            for tick in 0..10_000 {
                if let Some(found) = truncate(x, p, Ends::of(tick == 0)) {
                    x += found.shift;
                    p *= found.kept;
                }
            }
            let off = f64::from(x) - mean;
            let ratio = f64::from(p) / after;
            let [far, least] = if position == 0.0 {
                [1e-6, 0.98]
            } else {
                [0.25, 0.65]
            };
            let case = std::format!("{position} {variance}: {off} {ratio}");
            assert!(off.abs() <= far * after.sqrt(), "{case}");
            assert!(ratio > least && ratio < 1.03, "{case}");
        }
    }

    #[test]
    fn truncation_is_odd_and_ends_inside() {
        for variance in [1e-6, 1e-3, 0.02, 0.12, 0.125, 1.0, 1e4, 1e8] {
            for step in -4000..=4000 {
                let x = step as f32 / 500.0;
                let Some(found) = truncate(x, variance, Ends::of(true)) else {
                    assert!(x.abs() < 0.5, "{x} {variance}");
                    continue;
                };
                let mirrored = truncate(-x, variance, Ends::of(true)).expect("symmetric");
                assert_eq!(found.shift, -mirrored.shift, "{x} {variance}");
                assert!(
                    (x + found.shift).abs() <= 0.5 + 1e-4,
                    "{x} {variance} {found:?}"
                );
                assert!(
                    found.kept >= 0.0 && found.kept <= 1.0,
                    "{x} {variance} {found:?}"
                );
                let probability = found.likelihood.relative(1.0);
                assert!(
                    probability > 0.0 && probability < 1.05,
                    "{x} {variance} {found:?}"
                );
            }
        }
    }

    #[test]
    fn inverse_root_is_exact_to_5e_6() {
        let mut x = 1e-30f32;
        while x < 1e30 {
            let exact = 1.0 / f64::from(x).sqrt();
            let off = f64::from(inverse_root(x)) / exact - 1.0;
            assert!(off < 1e-6 && off > -5e-6, "{x}: {off}");
            x *= 1.037;
        }
    }
}
