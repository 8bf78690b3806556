//! The test function of the weak form, sampled.

/// Power of the test function: it and its first five derivatives vanish at its ends.
const POWER: usize = 6;
/// Coefficients of its antiderivative.
const TERMS: usize = 2 * POWER + 2;
/// Terms of the series in the amplifier's lag.
pub(super) const LAG_TERMS: usize = 5;

/// `phi(x) = (1 - x^2)^6` on [-1, 1], stretched over `2 half + 1` samples and scaled to area 1.
///
/// Integrals over samples are by the trapezoid rule, which on a function whose derivatives vanish
/// at both ends converges with the sixth power of the step; those over the current, which is
/// constant between samples, are exact.
#[derive(Clone, Debug)]
pub(super) struct TestFunction {
    /// Samples on each side of the centre.
    pub(super) half: usize,
    /// `integral of phi f = sum of weight f`; likewise its derivatives.
    pub(super) weight: Vec<f64>,
    pub(super) first: Vec<f64>,
    pub(super) second: Vec<f64>,
    /// `increments[m][j]`: increment of the (m-1)-th derivative of phi from sample j to j + 1; the
    /// (-1)-th derivative is the antiderivative.
    pub(super) increments: [Vec<f64>; LAG_TERMS],
}

impl TestFunction {
    /// The test function over `2 half` sampling periods of `period_s`.
    pub(super) fn new(half: usize, period_s: f64) -> Self {
        let samples = 2 * half + 1;
        let scale = half as f64 * period_s;
        let grid: Vec<f64> = (0..samples)
            .map(|j| (j as f64 - half as f64) / half as f64)
            .collect();
        let mut order = antiderivative();
        let area = value(&order, 1.0) - value(&order, -1.0);
        // The m-th entry: the (m-1)-th derivative in time of phi at the samples.
        let mut tables: Vec<Vec<f64>> = Vec::new();
        for m in 0..LAG_TERMS {
            let unit = scale.powi(-(m as i32)) / area;
            tables.push(grid.iter().map(|&x| unit * value(&order, x)).collect());
            order = derivative(&order);
        }
        let sampled = |m: usize| tables[m].iter().map(|v| v * period_s).collect();
        Self {
            half,
            weight: sampled(1),
            first: sampled(2),
            second: sampled(3),
            increments: std::array::from_fn(|m| {
                tables[m].windows(2).map(|pair| pair[1] - pair[0]).collect()
            }),
        }
    }
}

/// Antiderivative of `(1 - x^2)^6`, by powers of x.
fn antiderivative() -> [f64; TERMS] {
    let mut terms = [0.0; TERMS];
    let mut binomial = 1.0;
    for k in 0..=POWER {
        terms[2 * k + 1] = binomial / (2 * k + 1) as f64;
        binomial *= -((POWER - k) as f64) / (k + 1) as f64;
    }
    terms
}

fn derivative(terms: &[f64; TERMS]) -> [f64; TERMS] {
    std::array::from_fn(|k| match terms.get(k + 1) {
        Some(term) => (k + 1) as f64 * term,
        None => 0.0,
    })
}

fn value(terms: &[f64; TERMS], x: f64) -> f64 {
    terms.iter().rev().fold(0.0, |sum, term| sum * x + term)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sum(weights: &[f64], f: impl Fn(f64) -> f64) -> f64 {
        let half = (weights.len() / 2) as f64;
        let at = |j: usize| (j as f64 - half) * 1e-3;
        weights.iter().enumerate().map(|(j, w)| w * f(at(j))).sum()
    }

    #[test]
    fn weighted_sums_are_integrals_by_parts() {
        let phi = TestFunction::new(30, 1e-3);
        assert!((sum(&phi.weight, |_| 1.0) - 1.0).abs() < 1e-9);
        // The ends' sixth derivative is all that is left: by Euler and Maclaurin 2e-7 in the
        // first sum, and 1 / (30 ms) times 42 times that in the second.
        // By parts: the integral of phi' f is minus that of phi f'.
        let (f, slope, bend) = (
            |t: f64| 3.0 - 2.0 * t + 5.0 * t * t,
            |t: f64| -2.0 + 10.0 * t,
            |_: f64| 10.0,
        );
        assert!((sum(&phi.first, f) + sum(&phi.weight, slope)).abs() < 1e-6);
        assert!((sum(&phi.second, f) - sum(&phi.weight, bend)).abs() < 1e-3);
    }

    #[test]
    fn series_is_the_response_of_a_lag() {
        let phi = TestFunction::new(30, 1e-3);
        // A step of current in the middle, and the exact response of a lag of 0.5 ms to it.
        let lag = 0.5e-3_f64;
        let series: f64 = (0..LAG_TERMS)
            .map(|m| lag.powi(m as i32) * phi.increments[m][30..].iter().sum::<f64>())
            .sum();
        let fine = TestFunction::new(30_000, 1e-6);
        let exact = fine.weight[30_000..].iter().enumerate();
        let exact: f64 = exact
            .map(|(j, w)| w * (1.0 - (-(j as f64) * 1e-6 / lag).exp()))
            .sum();
        assert!((series - exact).abs() < 2e-5, "{series} {exact}");
    }
}
