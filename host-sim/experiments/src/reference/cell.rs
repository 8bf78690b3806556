//! A Gaussian position and the count of an encoder: moments and probability.
//!
//! The encoder reads `y = x + n` with the sensor noise `n ~ N(0, R)` and reports the count 0 if `y` is
//! in `[0, 1]`. For `x ~ N(mean, variance)` the probability of that count is
//!
//! ```text
//! Z = Phi(b) - Phi(a)     a = -mean / s,  b = (1 - mean) / s,  s^2 = variance + R
//! ```
//!
//! and the derivatives of `ln Z` give the moments of `x` after the count is known.

use std::f64::consts::{FRAC_1_SQRT_2, PI};

/// Above this deviation, counts, the probability density is constant within the cell.
const FLAT: f64 = 30.0;

/// A Gaussian factor that replaces an observation of the position, in the information form.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Site {
    /// Inverse variance, 1/counts^2.
    pub precision: f64,
    /// Inverse variance times the mean, 1/counts.
    pub information: f64,
}

/// The factor of the count 0 for a position of this mean and variance without that count, and the
/// logarithm of the count's probability.
pub(super) fn observe(mean: f64, variance: f64, noise: f64) -> (Site, f64) {
    let total = variance + noise;
    let s = total.sqrt();
    if s > FLAT {
        let spread = total + 1.0 / 12.0;
        let log = -0.5 * ((0.5 - mean).powi(2) / spread + (2.0 * PI * spread).ln());
        let precision = 1.0 / (noise + 1.0 / 12.0);
        let site = Site {
            precision,
            information: 0.5 * precision,
        };
        return (site, log);
    }
    // By symmetry the nearer end of the cell is on the left.
    let mirrored = mean > 0.5;
    let near = if mirrored { 1.0 - mean } else { mean };
    let (a, b) = (-near / s, (1.0 - near) / s);
    let (density_a, density_b, log) = densities(a, b);
    let gradient = (density_a - density_b) / s;
    let curvature = (b * density_b - a * density_a) / total + gradient * gradient;
    let gradient = if mirrored { -gradient } else { gradient };
    // The variance after the count is variance (1 - variance curvature), between 0 and the variance.
    let part = (variance * curvature).clamp(1e-12, 1.0 - 1e-9);
    let curvature = part / variance;
    let site = Site {
        precision: curvature / (1.0 - part),
        information: (gradient + mean * curvature) / (1.0 - part),
    };
    (site, log)
}

/// `phi(a) / Z`, `phi(b) / Z` and `ln Z` with `Z = Phi(b) - Phi(a)`, for `a < b` and `a + b >= 0`.
fn densities(a: f64, b: f64) -> (f64, f64, f64) {
    let root = (2.0 * PI).sqrt();
    let phi = |x: f64| (-0.5 * x * x).exp() / root;
    if a <= 0.0 {
        let z = 0.5 * (libm::erf(b * FRAC_1_SQRT_2) - libm::erf(a * FRAC_1_SQRT_2));
        return (phi(a) / z, phi(b) / z, z.ln());
    }
    // Relative to the density at a, so that nothing underflows.
    let ratio = (-0.5 * (b * b - a * a)).exp();
    let z = 0.5 * (scaled_erfc(a * FRAC_1_SQRT_2) - ratio * scaled_erfc(b * FRAC_1_SQRT_2));
    (1.0 / (root * z), ratio / (root * z), z.ln() - 0.5 * a * a)
}

/// `exp(x^2) erfc(x)` for `x >= 0`.
fn scaled_erfc(x: f64) -> f64 {
    if x < 20.0 {
        return (x * x).exp() * libm::erfc(x);
    }
    let y = 1.0 / (2.0 * x * x);
    (1.0 - y * (1.0 - 3.0 * y * (1.0 - 5.0 * y))) / (x * PI.sqrt())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Mean, variance and probability by quadrature over the position.
    fn by_quadrature(mean: f64, variance: f64, noise: f64) -> (f64, f64, f64) {
        let s = variance.sqrt();
        let n = 200_000;
        let (mut z, mut first, mut second) = (0.0, 0.0, 0.0);
        let step = 24.0 * s / f64::from(n);
        for i in 0..n {
            let x = mean + s * 24.0 * ((f64::from(i) + 0.5) / f64::from(n) - 0.5);
            let density =
                (-0.5 * (x - mean).powi(2) / variance).exp() / (2.0 * PI * variance).sqrt();
            let r = (2.0 * noise).sqrt();
            // erfc, not erf: far outside the cell the difference of two erf is 0.
            let inside = 0.5 * (libm::erfc((x - 1.0) / r) - libm::erfc(x / r));
            let p = density * inside * step;
            z += p;
            first += p * x;
            second += p * x * x;
        }
        (first / z, second / z - (first / z).powi(2), z)
    }

    #[test]
    fn moments_agree_with_quadrature() {
        for (mean, variance, noise) in [
            (0.5, 0.01, 1e-3),
            (0.2, 0.3, 1e-3),
            (1.4, 0.05, 1e-2),
            (-0.7, 0.09, 1e-2),
            (0.5, 4.0, 1e-3),
            (3.0, 100.0, 0.04),
        ] {
            let (site, log) = observe(mean, variance, noise);
            let precision = 1.0 / variance + site.precision;
            let got_mean = (mean / variance + site.information) / precision;
            let (m, v, z) = by_quadrature(mean, variance, noise);
            let close = |a: f64, b: f64| (a - b).abs() < 1e-5 * (1.0 + b.abs());
            assert!(close(got_mean, m), "{mean} {variance}: {got_mean} {m}");
            assert!(
                (1.0 / precision / v - 1.0).abs() < 1e-4,
                "{mean} {variance}: {} {v}",
                1.0 / precision
            );
            assert!(
                (log - z.ln()).abs() < 1e-4,
                "{mean} {variance}: {log} {}",
                z.ln()
            );
        }
    }

    #[test]
    fn moments_are_continuous_where_the_formula_changes() {
        for mean in [0.5, 20.0] {
            // The noise is less than the step of the variance, 6e-5.
            let below = observe(mean, (FLAT - 1e-6).powi(2), 1e-5);
            let above = observe(mean, (FLAT + 1e-6).powi(2), 1e-5);
            assert!((below.1 - above.1).abs() < 1e-5);
            assert!((below.0.precision / above.0.precision - 1.0).abs() < 1e-2);
            assert!((below.0.information / above.0.information - 1.0).abs() < 1e-2);
        }
    }

    #[test]
    fn position_far_outside_the_cell_is_moved_to_its_nearer_end() {
        for (mean, end) in [(60.0, 1.0), (-60.0, 0.0)] {
            let (site, log) = observe(mean, 0.01, 1e-4);
            let precision = 100.0 + site.precision;
            let after = (100.0 * mean + site.information) / precision;
            // The noise takes its share of the distance: 1e-4 of 1.01e-2.
            let expected = end + (mean - end) * 1e-4 / 1.01e-2;
            assert!((after - expected).abs() < 0.01, "{after} {expected}");
            assert!(log.is_finite() && log < -1e4);
        }
    }
}
