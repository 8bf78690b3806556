//! Steady Kalman gain of `x_k = A x_{k-1} + w`, `y_k = [1 0 ..] x_k + n`, at compile time.

use super::matrix::{IDENTITY, Matrix, inverted, matrix, norm, product, sum, transposed};
use crate::design::DesignError;

/// Doublings until a filter that has not settled, in 2^20 ticks, is refused.
const DOUBLINGS: usize = 20;

/// Limit of the recursion.
#[derive(Clone, Copy)]
pub(crate) struct Steady<const S: usize> {
    /// The gain K.
    pub(crate) gain: [f32; S],
    /// Variance `H P Hᵀ + r` of the innovation.
    pub(crate) innovation: f64,
    /// Variance P_11 of the second state, the velocity, before and after a correction.
    pub(crate) velocity: [f64; 2],
}

/// The limit of the recursion. See [`Model::steady_gain`](crate::Model::steady_gain).
pub(crate) const fn steady<const S: usize>(
    a: &[[f64; S]; S],
    q: &[[f64; S]; S],
    r: f64,
) -> Result<Steady<S>, DesignError> {
    let limit = match steady_of_three(&matrix(a), &matrix(q), r) {
        Ok(limit) => limit,
        Err(error) => return Err(error),
    };
    let mut gain = [0.0; S];
    let mut i = 0;
    while i < S {
        gain[i] = limit.gain[i];
        i += 1;
    }
    Ok(Steady {
        gain,
        innovation: limit.innovation,
        velocity: limit.velocity,
    })
}

/// [`steady`] of three states, of which the third may be none.
pub(crate) const fn steady_of_three(
    a: &Matrix,
    q: &Matrix,
    r: f64,
) -> Result<Steady<3>, DesignError> {
    let Some(covariance) = predicted_covariance(a, q, r) else {
        return Err(DesignError::NOT_CONVERGED);
    };
    let exact = gain(&covariance, r);
    let further = gain(&next_covariance(a, q, r, &covariance), r);
    let mut rounded = [0.0; 3];
    let mut i = 0;
    while i < 3 {
        if !((further[i] - exact[i]).abs() <= 1e-9 * exact[i].abs()) {
            return Err(DesignError::NOT_CONVERGED);
        }
        rounded[i] = exact[i] as f32;
        i += 1;
    }
    if shrinks(closed_loop(a, &rounded)) {
        let [p00, p01, _, _, p11, ..] = covariance;
        Ok(Steady {
            gain: rounded,
            innovation: p00 + r,
            velocity: [p11, p11 - exact[1] * p01],
        })
    } else {
        Err(DesignError::NOT_STABLE)
    }
}

/// The gains of the first N ticks after a start with uncorrelated variances `prior`, and the
/// variance P_11 of the velocity before each, from the correction before.
pub(crate) const fn first_gains<const S: usize, const N: usize>(
    a: &[[f64; S]; S],
    q: &[[f64; S]; S],
    r: f64,
    prior: &[f64; S],
) -> ([[f64; S]; N], [f64; N]) {
    let (a, q) = (&matrix(a), &matrix(q));
    let mut covariance = [0.0; 9];
    let mut i = 0;
    while i < S {
        covariance[4 * i] = prior[i];
        i += 1;
    }
    covariance = later_noise(a, q, &covariance);
    let mut gains = [[0.0; S]; N];
    let mut velocity = [0.0; N];
    let mut corrected = prior[1];
    let mut tick = 0;
    while tick < N {
        let k = gain(&covariance, r);
        let mut i = 0;
        while i < S {
            gains[tick][i] = k[i];
            i += 1;
        }
        velocity[tick] = corrected;
        corrected = covariance[4] - k[1] * covariance[1];
        covariance = next_covariance(a, q, r, &covariance);
        tick += 1;
    }
    (gains, velocity)
}

/// Process noise of n + 1 ticks from that of n: `A Q_n Aᵀ + Q`.
pub(crate) const fn later_noise(a: &Matrix, q: &Matrix, q_n: &Matrix) -> Matrix {
    sum(&product(&product(a, q_n), &transposed(*a)), q)
}

/// Limit of the predicted covariance, by the doubling algorithm (Anderson 1978) in its
/// structure-preserving form: after k doublings `h` is the covariance after 2^k ticks from certainty, and `e` the
/// transition of the estimation error over them.
const fn predicted_covariance(a: &Matrix, q: &Matrix, r: f64) -> Option<Matrix> {
    let mut e = transposed(*a);
    let mut g = [0.0; 9];
    g[0] = 1.0 / r;
    let mut h = *q;
    let mut doubling = 0;
    while doubling < DOUBLINGS {
        let Some(inverse) = inverted(sum(&IDENTITY, &product(&g, &h))) else {
            return None;
        };
        let we = product(&inverse, &e);
        let g_next = sum(
            &g,
            &product(&product(&e, &product(&inverse, &g)), &transposed(e)),
        );
        let h_next = sum(&h, &product(&product(&transposed(e), &h), &we));
        e = product(&e, &we);
        if settled(&h, &h_next) {
            return Some(h_next);
        }
        g = g_next;
        h = h_next;
        doubling += 1;
    }
    None
}

/// `K = P Hᵀ / (H P Hᵀ + r)`.
const fn gain(covariance: &Matrix, r: f64) -> [f64; 3] {
    let [p00, _, _, p10, _, _, p20, ..] = *covariance;
    let innovation = p00 + r;
    [p00 / innovation, p10 / innovation, p20 / innovation]
}

/// One tick of the plain recursion: update, then predict.
const fn next_covariance(a: &Matrix, q: &Matrix, r: f64, covariance: &Matrix) -> Matrix {
    let updated = corrected_by(covariance, gain(covariance, r));
    sum(&product(&product(a, &updated), &transposed(*a)), q)
}

/// `(I - K H) A`: transition of the estimation error over one tick.
const fn closed_loop(a: &Matrix, [k0, k1, k2]: &[f32; 3]) -> Matrix {
    corrected_by(a, [*k0 as f64, *k1 as f64, *k2 as f64])
}

/// `(I - K H) M`.
#[rustfmt::skip]
const fn corrected_by(m: &Matrix, [k0, k1, k2]: [f64; 3]) -> Matrix {
    let [a, b, c, d, e, f, g, h, i] = *m;
    [
        a - k0 * a, b - k0 * b, c - k0 * c,
        d - k1 * a, e - k1 * b, f - k1 * c,
        g - k2 * a, h - k2 * b, i - k2 * c,
    ]
}

/// Whether some power `m^(2^k)` has a norm below 1/2, which proves a spectral radius below 1.
const fn shrinks(mut m: Matrix) -> bool {
    let mut squaring = 0;
    while squaring <= DOUBLINGS {
        if norm(&m) < 0.5 {
            return true;
        }
        m = product(&m, &m);
        squaring += 1;
    }
    false
}

/// Whether no element changed by more than 1e-12 of the geometric mean of its diagonal elements, a
/// measure that does not depend on the units of the states.
const fn settled(old: &Matrix, new: &Matrix) -> bool {
    let mut i = 0;
    while i < 3 {
        let mut j = 0;
        while j < 3 {
            let change = new[3 * i + j] - old[3 * i + j];
            if !(change * change <= 1e-24 * new[4 * i] * new[4 * j]) {
                return false;
            }
            j += 1;
        }
        i += 1;
    }
    true
}

#[cfg(test)]
mod tests {
    use super::super::matrix::matrix;

    fn settled(old: &[[f64; 2]; 2], new: &[[f64; 2]; 2]) -> bool {
        super::settled(&matrix(old), &matrix(new))
    }

    fn shrinks(m: [[f64; 2]; 2]) -> bool {
        super::shrinks(matrix(&m))
    }

    #[test]
    fn settled_means_a_change_below_1e_12_of_the_diagonal() {
        let old = [[4.0, 0.0], [0.0, 1e-10]];
        let moved = |i: usize, j: usize, by: f64| {
            let mut new = old;
            new[i][j] += by;
            settled(&old, &new)
        };
        assert!(moved(0, 0, 3.9e-12) && !moved(0, 0, 4.1e-12));
        assert!(moved(1, 1, 0.9e-22) && !moved(1, 1, 1.1e-22));
        // Off the diagonal by the geometric mean of 4 and 1e-10, 2e-5.
        assert!(moved(0, 1, 1.9e-17) && !moved(0, 1, 2.1e-17));
        assert!(moved(1, 0, -1.9e-17) && !moved(1, 0, -2.1e-17));
        assert!(!settled(&old, &[[f64::NAN, 0.0], [0.0, 1e-10]]));
    }

    #[test]
    fn nan_is_not_stable() {
        let m = [[f64::NAN, 0.0], [0.0, 0.1]];
        assert!(!shrinks(m) && !shrinks([[0.1, 0.0], [0.0, f64::NAN]]));
    }

    #[test]
    fn powers_shrink_only_below_a_spectral_radius_of_one() {
        // A large norm with small eigenvalues grows first and shrinks then.
        assert!(shrinks([[0.9, 100.0], [0.0, 0.9]]));
        assert!(!shrinks([[1.0, 0.0], [0.0, 0.5]]));
        assert!(!shrinks([[0.0, 1.1], [-1.1, 0.0]]));
    }
}
