//! Least squares with a lag in one column, and confidence intervals for correlated residuals.

use super::test_function::LAG_TERMS;

/// One window's equation: `response = a drive(lag) + sum of b_k others_k`.
#[derive(Clone, Debug)]
pub(super) struct Equation {
    pub(super) response: f64,
    /// The integral of the current by powers of the lag.
    pub(super) drive: [f64; LAG_TERMS],
    pub(super) others: Vec<f64>,
    /// The displacement of the other shaft, as the slip has it.
    pub(super) other_moved: f64,
    /// Change of the response and of the first of the others, if the counts of both encoders were read at half their
    /// resolution.
    pub(super) halved: Vec<f64>,
}

impl Equation {
    /// The equation from counts at half the resolution. The two phases of the halving, signs 1 and -1, have opposite
    /// changes.
    fn halved(&self, sign: f64) -> Self {
        let mut equation = self.clone();
        let (response, others) = self.halved.split_first().unwrap_or((&0.0, &[]));
        equation.response += sign * response;
        for (value, change) in equation.others.iter_mut().zip(others) {
            *value += sign * change;
        }
        equation
    }
}

/// Coefficients, coefficients without each block of equations, and the residual.
#[derive(Clone, Debug)]
pub(super) struct Fit {
    /// Coefficient of the drive, then those of the others.
    pub(super) coefficients: Vec<f64>,
    /// Lag of the drive, s; negative if the current acts before its time in the recording.
    pub(super) lag_s: f64,
    /// RMS of the residual, in the response's unit.
    pub(super) unexplained: f64,
    /// RMS of the drive's part of the response.
    pub(super) driven: f64,
    without: Vec<(Vec<f64>, f64)>,
    /// The fits of both phases of the counts at half their resolution.
    halved: [(Vec<f64>, f64); 2],
}

/// A value and the half-width of its 95 % interval.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Estimate {
    /// The value.
    pub value: f64,
    /// Half the width of its interval.
    pub half: f64,
    /// Whether the interval is wide mainly by the quantisation of the encoders.
    pub by_counts: bool,
}

/// Number of blocks of the jackknife.
const BLOCKS: usize = 14;
/// Gauss-Newton iterations.
const STEPS: usize = 8;

impl Fit {
    /// Fits the equations; `None` if they are too few for confidence intervals.
    pub(super) fn new(equations: &[Equation]) -> Option<Self> {
        let columns = equations.first()?.others.len() + 2;
        if equations.len() < 2 * BLOCKS.max(columns) {
            return None;
        }
        let (lag_s, drive) = converged(equations);
        // Neighbouring windows have correlated residuals, so whole blocks are left out.
        let blocks: Vec<Normal> = (0..BLOCKS)
            .map(|b| {
                let bounds = [b, b + 1].map(|b| b * equations.len() / BLOCKS);
                Normal::of(&equations[bounds[0]..bounds[1]], lag_s, drive)
            })
            .collect();
        let mut all = Normal::new(columns);
        blocks.iter().for_each(|block| all.add(block, 1.0));
        let with_lag = |solution| split(solution, lag_s);
        let halved = [1.0, -1.0].map(|sign| {
            let equations: Vec<_> = equations.iter().map(|e| e.halved(sign)).collect();
            let (lag_s, drive) = converged(&equations);
            split(Normal::of(&equations, lag_s, drive).solve(), lag_s)
        });
        let without = blocks.iter().map(|block| {
            let mut rest = all.clone();
            rest.add(block, -1.0);
            with_lag(rest.solve())
        });
        let without = without.collect();
        let (coefficients, lag_s) = with_lag(all.solve());
        let mean_square = |f: &dyn Fn(&Equation) -> f64| {
            let sum: f64 = equations.iter().map(|e| f(e) * f(e)).sum();
            (sum / equations.len() as f64).sqrt()
        };
        let driven = |e: &Equation| coefficients[0] * lagged(&e.drive, lag_s).0;
        let unexplained = |e: &Equation| {
            let others = e.others.iter().zip(&coefficients[1..]);
            e.response - driven(e) - others.map(|(x, b)| x * b).sum::<f64>()
        };
        Some(Self {
            unexplained: mean_square(&unexplained),
            driven: mean_square(&driven),
            coefficients,
            lag_s,
            without,
            halved,
        })
    }

    /// A function of coefficients and lag with its interval: jackknife over the blocks with the factor
    /// of Student's distribution, and the bias by quantisation. Noise of a column biases its coefficient by the
    /// variance of the noise, and every block equally. Counts at half the resolution have a further error of half a
    /// count, of three times the variance; the mean of both phases of the halving cancels what is linear in it.
    pub(super) fn estimate(&self, f: impl Fn(&[f64], f64) -> f64) -> Estimate {
        let count = self.without.len() as f64;
        let values = self.without.iter().map(|(c, lag)| f(c, *lag));
        let values: Vec<f64> = values.collect();
        let mean = values.iter().sum::<f64>() / count;
        let squares: f64 = values.iter().map(|v| (v - mean) * (v - mean)).sum();
        let value = f(&self.coefficients, self.lag_s);
        let [one, other] = [0, 1].map(|k| f(&self.halved[k].0, self.halved[k].1));
        let bias = 0.5 * (one + other) - value;
        let spread = student(count - 1.0) * (squares * (count - 1.0) / count).sqrt();
        Estimate {
            value,
            half: spread.hypot(bias),
            by_counts: bias.abs() > spread,
        }
    }
}

/// Lag and coefficient of the drive by Gauss-Newton steps.
fn converged(equations: &[Equation]) -> (f64, f64) {
    let (mut lag_s, mut drive) = (0.0, 0.0);
    for _ in 0..STEPS {
        let solution = Normal::of(equations, lag_s, drive).solve();
        drive = solution[0];
        lag_s += solution[1];
    }
    (lag_s, drive)
}

/// The coefficients of a solution without the lag's step, and the lag after the step.
fn split(solution: Vec<f64>, lag_s: f64) -> (Vec<f64>, f64) {
    let mut coefficients = solution;
    let step = coefficients.remove(1);
    (coefficients, lag_s + step)
}

/// The drive at a lag, and its derivative with respect to the lag. A first-order lag is the series
/// `1 + s + s^2 + ...` in powers of the lag times d/dt; a lead is a shift in time.
fn lagged(terms: &[f64; LAG_TERMS], lag_s: f64) -> (f64, f64) {
    let (mut value, mut slope, mut power, mut factorial) = (terms[0], 0.0, 1.0, 1.0);
    for (m, term) in terms.iter().enumerate().skip(1) {
        if lag_s < 0.0 {
            factorial *= m as f64;
        }
        slope += m as f64 * power * term / factorial;
        power *= lag_s;
        value += power * term / factorial;
    }
    (value, slope)
}

/// The 97.5 % quantile of Student's distribution: expansion about that of the normal distribution (Abramowitz
/// and Stegun, 26.7.5), 3 digits from 5 degrees of freedom on and 4 from 10 on.
fn student(freedom: f64) -> f64 {
    let z: f64 = 1.959_964;
    let first = (z.powi(3) + z) / 4.0;
    let second = (5.0 * z.powi(5) + 16.0 * z.powi(3) + 3.0 * z) / 96.0;
    let third = (3.0 * z.powi(7) + 19.0 * z.powi(5) + 17.0 * z.powi(3) - 15.0 * z) / 384.0;
    let per = 1.0 / freedom;
    z + per * (first + per * (second + per * third))
}

/// Normal equations.
#[derive(Clone)]
struct Normal {
    size: usize,
    matrix: Vec<f64>,
    right: Vec<f64>,
}

impl Normal {
    fn new(size: usize) -> Self {
        Self {
            size,
            matrix: vec![0.0; size * size],
            right: vec![0.0; size],
        }
    }

    /// Linearised about this lag; the second column belongs to the lag.
    fn of(equations: &[Equation], lag_s: f64, drive: f64) -> Self {
        let size = equations.first().map_or(0, |e| e.others.len() + 2);
        let mut normal = Self::new(size);
        let mut row = vec![0.0; size];
        for equation in equations {
            let (value, slope) = lagged(&equation.drive, lag_s);
            row[0] = value;
            // The lag is kept until the drive's coefficient is known.
            row[1] = drive * slope;
            row[2..].copy_from_slice(&equation.others);
            for (i, x) in row.iter().enumerate() {
                normal.right[i] += x * equation.response;
                for (j, other) in row.iter().enumerate() {
                    normal.matrix[i * size + j] += x * other;
                }
            }
        }
        normal
    }

    fn add(&mut self, other: &Self, sign: f64) {
        let pairs = self.matrix.iter_mut().zip(&other.matrix);
        let pairs = pairs.chain(self.right.iter_mut().zip(&other.right));
        pairs.for_each(|(mine, theirs)| *mine += sign * theirs);
    }

    /// Solution by Cholesky factors of the matrix, scaled to a unit diagonal. The coefficient of a
    /// linearly dependent column is arbitrary; the jackknife then gives it a wide interval.
    fn solve(&self) -> Vec<f64> {
        let n = self.size;
        let scale: Vec<f64> = (0..n)
            .map(|i| self.matrix[i * n + i].max(f64::MIN_POSITIVE).sqrt().recip())
            .collect();
        let mut factor = vec![0.0; n * n];
        for i in 0..n {
            for j in 0..=i {
                let known: f64 = (0..j).map(|k| factor[i * n + k] * factor[j * n + k]).sum();
                let rest = self.matrix[i * n + j] * scale[i] * scale[j] - known;
                factor[i * n + j] = match i == j {
                    true => rest.max(1e-13).sqrt(),
                    false => rest / factor[j * n + j],
                };
            }
        }
        let mut x: Vec<f64> = self.right.iter().zip(&scale).map(|(r, s)| r * s).collect();
        for i in 0..n {
            let known: f64 = (0..i).map(|k| factor[i * n + k] * x[k]).sum();
            x[i] = (x[i] - known) / factor[i * n + i];
        }
        for i in (0..n).rev() {
            let known: f64 = (i + 1..n).map(|k| factor[k * n + i] * x[k]).sum();
            x[i] = (x[i] - known) / factor[i * n + i];
        }
        x.iter().zip(&scale).map(|(x, s)| x * s).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Fits that leave out a block each, and those with the counts' odd part halved, of one coefficient.
    fn estimate(without: [f64; BLOCKS], halved: [f64; 2]) -> Estimate {
        let of = |value: f64| (vec![value], 0.0);
        let fit = Fit {
            coefficients: vec![5.0],
            lag_s: 0.0,
            unexplained: 0.0,
            driven: 1.0,
            without: without.map(of).to_vec(),
            halved: halved.map(of),
        };
        fit.estimate(|coefficients, _| coefficients[0])
    }

    /// The jackknife: the variance of a value is (n - 1) / n of the sum of squares of the n values that leave out a
    /// block. Student's factor for 13 degrees of freedom and 95 % is 2.1604.
    #[test]
    fn half_width_is_that_of_the_jackknife_and_of_the_bias_by_the_counts() {
        let alternating = std::array::from_fn(|k| if k % 2 == 0 { 5.1 } else { 4.9 });
        let spread = 2.1604 * (13.0_f64 / 14.0 * 14.0 * 0.01).sqrt();
        let none = estimate(alternating, [5.4, 4.6]);
        assert_eq!(none.value, 5.0);
        assert!((none.half / spread - 1.0).abs() < 1e-4, "{none:?}");
        assert!(!none.by_counts);
        // Half of both changes together is what the counts explain.
        let biased = estimate(alternating, [5.0, 7.0]);
        assert!((biased.half / spread.hypot(1.0) - 1.0).abs() < 1e-4);
        assert!(biased.by_counts, "{biased:?} {spread}");
    }
}
