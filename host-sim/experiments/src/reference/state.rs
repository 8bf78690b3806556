//! Position, velocity and acceleration with white jerk, in counts and periods.

use super::cell::Site;

/// A vector of the state: position, velocity, acceleration.
pub(super) type Vector = [f64; 3];

/// A matrix, by rows.
pub(super) type Matrix = [[f64; 3]; 3];

/// A Gaussian state by its mean and covariance.
#[derive(Clone, Copy, Debug)]
pub(super) struct Moments {
    pub mean: Vector,
    pub covariance: Matrix,
}

/// What later observations say of a state: `exp(-x' precision x / 2 + information' x)`.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Message {
    pub precision: Matrix,
    pub information: Vector,
}

/// Covariance that the white jerk of this intensity adds in the time `t`.
fn added(jerk: f64, t: f64) -> Matrix {
    let q = |divisor: f64, power: i32| jerk * t.powi(power) / divisor;
    let (pp, pv, pa) = (q(20.0, 5), q(8.0, 4), q(6.0, 3));
    let (vv, va, aa) = (q(3.0, 3), q(2.0, 2), q(1.0, 1));
    [[pp, pv, pa], [pv, vv, va], [pa, va, aa]]
}

/// `transition(t) x`.
fn moved(x: Vector, t: f64) -> Vector {
    [x[0] + t * (x[1] + 0.5 * t * x[2]), x[1] + t * x[2], x[2]]
}

/// `x' transition(t)` as a vector.
fn moved_back(x: Vector, t: f64) -> Vector {
    [x[0], t * x[0] + x[1], 0.5 * t * t * x[0] + t * x[1] + x[2]]
}

fn transposed(a: Matrix) -> Matrix {
    std::array::from_fn(|i| std::array::from_fn(|j| a[j][i]))
}

fn dot(a: Vector, b: Vector) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn times(a: &Matrix, b: &Matrix) -> Matrix {
    let columns = transposed(*b);
    a.map(|row| columns.map(|column| dot(row, column)))
}

fn symmetric(a: Matrix) -> Matrix {
    std::array::from_fn(|i| std::array::from_fn(|j| 0.5 * (a[i][j] + a[j][i])))
}

fn inverse(m: &Matrix) -> Matrix {
    let cofactor = |i: usize, j: usize| {
        let ([r, s], [c, d]) = ([(i + 1) % 3, (i + 2) % 3], [(j + 1) % 3, (j + 2) % 3]);
        m[r][c] * m[s][d] - m[r][d] * m[s][c]
    };
    let determinant = (0..3).map(|j| m[0][j] * cofactor(0, j)).sum::<f64>();
    std::array::from_fn(|i| std::array::from_fn(|j| cofactor(j, i) / determinant))
}

/// The lower triangular `l` with `l l' = a`, for a symmetric `a` without negative eigenvalues.
fn root(a: &Matrix) -> Matrix {
    let mut l = Matrix::default();
    for j in 0..3 {
        let square = a[j][j] - dot(l[j], l[j]);
        // A direction that rounding makes negative has no variance.
        l[j][j] = square.max(0.0).sqrt();
        for i in j + 1..3 {
            let rest = a[i][j] - dot(l[i], l[j]);
            l[i][j] = if l[j][j] > 0.0 { rest / l[j][j] } else { 0.0 };
        }
    }
    l
}

/// `(a^-1 + b)^-1` of symmetric matrices without negative eigenvalues; `a` may be singular.
///
/// With `l l' = a` it is `l (1 + l' b l)^-1 l'`. The matrix to invert has eigenvalues of 1 and more,
/// so the result has none that is negative, however different the units of the state are.
fn parallel(a: &Matrix, b: &Matrix) -> Matrix {
    let l = root(a);
    let columns = transposed(l);
    let mut sum = times(&columns, &times(b, &l));
    (0..3).for_each(|i| sum[i][i] += 1.0);
    // r r' = 1 + l' b l, and the rows of `half` are r^-1 l'.
    let r = root(&symmetric(sum));
    let mut half = columns;
    for i in 0..3 {
        for j in 0..i {
            half[i] = std::array::from_fn(|k| half[i][k] - r[i][j] * half[j][k]);
        }
        half[i] = half[i].map(|x| x / r[i][i]);
    }
    let half = transposed(half);
    half.map(|row| half.map(|column| dot(row, column)))
}

impl Moments {
    /// The state after the time `t`, its position from an origin that is `shift` lower.
    pub(super) fn predicted(&self, t: f64, jerk: f64, shift: f64) -> Self {
        let mut mean = moved(self.mean, t);
        mean[0] += shift;
        let half = self.covariance.map(|row| moved(row, t));
        let full = transposed(half).map(|row| moved(row, t));
        let added = added(jerk, t);
        let sum = |i: usize, j: usize| full[i][j] + added[i][j];
        let covariance = std::array::from_fn(|i| std::array::from_fn(|j| sum(i, j)));
        Self {
            mean,
            covariance: symmetric(covariance),
        }
    }

    /// The state with one more observation of its position.
    pub(super) fn with(&self, site: Site) -> Self {
        let column = self.covariance.map(|row| row[0]);
        let gain = 1.0 / (1.0 + site.precision * column[0]);
        let innovation = gain * (site.information - site.precision * self.mean[0]);
        let taken = gain * site.precision;
        Self {
            mean: std::array::from_fn(|i| self.mean[i] + column[i] * innovation),
            covariance: std::array::from_fn(|i| {
                std::array::from_fn(|j| self.covariance[i][j] - taken * column[i] * column[j])
            }),
        }
    }

    /// The state with what later observations say.
    pub(super) fn joined(&self, later: &Message) -> Self {
        let covariance = parallel(&self.covariance, &later.precision);
        let known = later.precision.map(|row| dot(row, self.mean));
        let innovation: Vector = std::array::from_fn(|i| later.information[i] - known[i]);
        let correction = covariance.map(|row| dot(row, innovation));
        Self {
            mean: std::array::from_fn(|i| self.mean[i] + correction[i]),
            covariance,
        }
    }
}

impl Message {
    /// The message with one more observation of the position.
    pub(super) fn with(mut self, site: Site) -> Self {
        self.precision[0][0] += site.precision;
        self.information[0] += site.information;
        self
    }

    /// The message to the state a time `t` before, whose origin is `shift` higher.
    pub(super) fn before(&self, t: f64, jerk: f64, shift: f64) -> Self {
        // The inverse of 1 + precision added, whose determinant is at least 1.
        let mut sum = times(&self.precision, &added(jerk, t));
        (0..3).for_each(|i| sum[i][i] += 1.0);
        let inverse = inverse(&sum);
        let column = self.precision.map(|row| row[0]);
        let moved: Vector = std::array::from_fn(|i| self.information[i] - shift * column[i]);
        let precision = symmetric(times(&inverse, &self.precision));
        let half = precision.map(|row| moved_back(row, t));
        let full = transposed(half).map(|row| moved_back(row, t));
        Self {
            precision: symmetric(full),
            information: moved_back(inverse.map(|row| dot(row, moved)), t),
        }
    }
}
