//! A Gaussian truncated to the quantisation interval.

/// A Gaussian truncated to ±1/2.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Truncated {
    /// Shift of the mean.
    pub(super) shift: f32,
    /// Factor of the variance, 0 to 1.
    pub(super) kept: f32,
    /// Probability of the interval before.
    pub(super) probability: f32,
}

/// Deviations from an end beyond which the end truncates nothing.
const REACH: f32 = 3.5;

/// Variance above which a Gaussian is wide: 0.35².
const WIDE: f32 = 0.1225;

/// Truncates the Gaussian of mean `position` and variance `variance` to ±1/2. `None` if it is inside.
///
/// Up to a standard deviation of 0.35, each end is truncated by itself:
/// [`end`] gives its shift, its variance and its probability. Above, the density inside is
/// `exp(κ y - y²/2σ²)` with κ = x / σ². Its variance at κ = 0 is 1 / (12 + 0.45/σ²) to 2 %, its mean
/// the rational function of κ with this slope and the limit 1/2, its variance the derivative of the
/// mean. The probability is the density at x of a Gaussian of variance σ² + 1/12.
#[inline(always)]
pub(super) fn truncate(position: f32, variance: f32) -> Option<Truncated> {
    let away = position.abs();
    let inside = 0.5 - away;
    if inside > 0.0 && inside * inside > REACH * REACH * variance {
        return None;
    }
    let (inwards, kept, probability) = if variance > WIDE {
        wide(away, variance)
    } else {
        let per_std_dev = inverse_root(variance);
        let near = end(inside * per_std_dev);
        let far = (1.0 - inside) * per_std_dev;
        let (mut inwards, mut kept, mut probability) = near;
        if far < REACH {
            let far = end(far);
            inwards -= far.0;
            kept -= 1.0 - far.1;
            probability -= 1.0 - far.2;
        }
        (inwards * variance * per_std_dev, kept, probability)
    };
    Some(Truncated {
        shift: if position > 0.0 { -inwards } else { inwards },
        kept,
        probability,
    })
}

/// Shift, factor of the variance and probability for a wide Gaussian.
#[inline(always)]
fn wide(away: f32, variance: f32) -> (f32, f32, f32) {
    let per_variance = 1.0 / variance;
    let narrowest = 1.0 / (12.0 + 0.45 * per_variance);
    let z = away * per_variance * narrowest;
    let twice = z + z;
    let per = 1.0 / (1.0 + twice + twice * twice);
    let mean = z * (1.0 + twice) * per;
    let kept = narrowest * (1.0 + twice + twice) * per * per * per_variance;
    let blurred = variance + 1.0 / 12.0;
    let per_std_dev = inverse_root(blurred);
    let probability =
        DENSITY_AT_MEAN * per_std_dev * density(0.5 * away * away * per_std_dev * per_std_dev);
    (away - mean, kept, probability)
}

/// 1 / √2π.
const DENSITY_AT_MEAN: f32 = 0.398_942_3;

/// Truncation of a standard Gaussian above `u`: shift λ = φ/Φ downwards, factor 1 - λ (λ + u) of the
/// variance, probability Φ. For u above 0 λ is a fourth power, below 0 it is |u| + 1/g with a
/// parabola g, and the factor is the derivative g'/g².
#[inline(always)]
fn end(u: f32) -> (f32, f32, f32) {
    if u > 0.0 {
        let root = 0.945 - u * (0.205 + 0.0145 * u);
        let root = if root > 0.0 { root } else { 0.0 };
        let square = root * root;
        let shift = square * square;
        (
            shift,
            1.0 - shift * (shift + u),
            1.0 - shift * (0.63 - 0.11 * u),
        )
    } else {
        let per = 1.0 / (1.2533 - u * (0.571 - 0.066 * u));
        let shift = per - u;
        let kept = (0.571 - 0.132 * u) * per * per;
        // Φ = φ / λ, and 1 / λ = g / (1 + g |u|).
        let probability = DENSITY_AT_MEAN * density(0.5 * u * u) / shift;
        (shift, kept, probability)
    }
}

/// The smallest density: a sum of weights stays a normal number.
const LEAST: f32 = 1e-12;

/// `exp(-x)` for small x >= 0, `(1 + x / 16)^-16` in general, and never less than 1e-12.
#[inline(always)]
pub(super) fn density(x: f32) -> f32 {
    let y = 1.0 / (1.0 + x * (1.0 / 16.0));
    let y = y * y;
    let y = y * y;
    let y = y * y;
    let y = y * y;
    if y > LEAST { y } else { LEAST }
}

/// `1 / √x` for a positive normal x, to 1e-6.
///
/// The exponent of x, halved and negated in its bits, gives the root to 12 %. Three steps of Newton's
/// iteration follow.
#[inline(always)]
fn inverse_root(x: f32) -> f32 {
    let one = 1.0f32.to_bits();
    let half = 0.5 * x;
    let mut y = f32::from_bits(one + one / 2 - (x.to_bits() >> 1));
    for _ in 0..3 {
        y *= 1.5 - half * y * y;
    }
    y
}
