//! Functions in f64 that `core` does not have at compile time.

/// Largest argument of [`exp`] with a finite result: infinity has no half.
const LARGEST_EXPONENT: f64 = 700.0;

/// `exp(x)` for |x| <= 700, to 1e-15 relative near zero and 5e-13 at the ends. Beyond, infinity and 0.
///
/// ```
/// const DECAY: f64 = estimator_core::const_math::exp(-0.5);
/// assert!((DECAY - (-0.5_f64).exp()).abs() < 1e-15);
/// ```
#[must_use]
pub const fn exp(x: f64) -> f64 {
    if x < 0.0 {
        return 1.0 / exp(-x);
    }
    if x > LARGEST_EXPONENT {
        return f64::INFINITY;
    }
    // Halve the argument until the series is short, then square back.
    let mut halvings = 0;
    let mut small = x;
    while small > 0.0625 {
        small /= 2.0;
        halvings += 1;
    }
    // Squaring expm1 keeps the digits that squaring exp would lose near 1.
    let mut expm1 = small * phi1(-small);
    while halvings > 0 {
        expm1 *= 2.0 + expm1;
        halvings -= 1;
    }
    1.0 + expm1
}

/// `(1 - exp(-x)) / x`, 1 at zero: the mean of a decay over its step. For x >= -1.
pub(crate) const fn phi1(x: f64) -> f64 {
    if x.abs() > 0.25 {
        return (1.0 - exp(-x)) / x;
    }
    series(x, 1.0, 2.0)
}

/// `(x - 1 + exp(-x)) / x^2`, 1/2 at zero: the mean of its integral. For x >= -1.
pub(crate) const fn phi2(x: f64) -> f64 {
    if x.abs() > 0.25 {
        return (x - 1.0 + exp(-x)) / (x * x);
    }
    series(x, 0.5, 3.0)
}

/// `first (1 - x/d (1 - x/(d+1) (1 - ...)))`, enough terms for |x| <= 1.
const fn series(x: f64, first: f64, divisor: f64) -> f64 {
    let mut term = first;
    let mut sum = first;
    let mut d = divisor;
    while d < 24.0 {
        term *= -x / d;
        sum += term;
        d += 1.0;
    }
    sum
}

/// `value` limited to ±`limit`. Unlike `clamp` it does not panic for a limit below zero; NaN stays.
#[inline]
pub(crate) fn limited(value: f32, limit: f32) -> f32 {
    if value.abs() > limit {
        if value > 0.0 { limit } else { -limit }
    } else {
        value
    }
}

#[cfg(test)]
mod tests {
    extern crate std;
    use super::{exp, phi1, phi2};

    fn close(a: f64, b: f64) -> bool {
        (a - b).abs() <= 2e-15 * b.abs().max(1e-300)
    }

    #[test]
    fn exp_agrees_with_the_standard_library() {
        for i in -3000..=3000 {
            let x = f64::from(i) * 0.005;
            let (ours, theirs) = (exp(x), x.exp());
            assert!(
                (ours - theirs).abs() <= 4e-14 * theirs,
                "{x}: {ours} {theirs}"
            );
        }
    }

    #[test]
    fn exp_of_any_argument_ends() {
        for x in [700.1, 1e300, f64::INFINITY] {
            assert_eq!((exp(x), exp(-x)), (f64::INFINITY, 0.0));
        }
        assert!(exp(f64::NAN).is_nan());
    }

    #[test]
    fn decay_means_agree_with_their_definitions() {
        for i in 1..4000 {
            let x = f64::from(i) * 0.002;
            assert!(
                close(phi1(x), -(-x).exp_m1() / x) || (phi1(x) + (-x).exp_m1() / x).abs() < 1e-15,
                "{x}"
            );
            // The definition cancels near zero; its loss bounds the comparison.
            let direct = (x - 1.0 + (-x).exp()) / (x * x);
            assert!((phi2(x) - direct).abs() <= 4e-16 / (x * x) + 1e-15, "{x}");
        }
        assert!(close(phi1(0.0), 1.0) && close(phi2(0.0), 0.5));
    }
}
