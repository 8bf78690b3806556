//! Square matrices in f64, at compile time.

pub(crate) type Matrix<const S: usize> = [[f64; S]; S];

/// Largest sum of magnitudes in a row, or NaN if there is one anywhere.
pub(crate) const fn norm<const S: usize>(m: &Matrix<S>) -> f64 {
    let mut largest = 0.0;
    let mut i = 0;
    while i < S {
        let mut row = 0.0;
        let mut j = 0;
        while j < S {
            row += m[i][j].abs();
            j += 1;
        }
        if row.is_nan() {
            return row;
        }
        if row > largest {
            largest = row;
        }
        i += 1;
    }
    largest
}

pub(crate) const fn identity<const S: usize>() -> Matrix<S> {
    let mut m = [[0.0; S]; S];
    let mut i = 0;
    while i < S {
        m[i][i] = 1.0;
        i += 1;
    }
    m
}

pub(crate) const fn transposed<const S: usize>(m: &Matrix<S>) -> Matrix<S> {
    let mut t = [[0.0; S]; S];
    let mut i = 0;
    while i < S {
        let mut j = 0;
        while j < S {
            t[j][i] = m[i][j];
            j += 1;
        }
        i += 1;
    }
    t
}

pub(crate) const fn sum<const S: usize>(x: &Matrix<S>, y: &Matrix<S>) -> Matrix<S> {
    let mut z = *x;
    let mut i = 0;
    while i < S {
        let mut j = 0;
        while j < S {
            z[i][j] += y[i][j];
            j += 1;
        }
        i += 1;
    }
    z
}

pub(crate) const fn product<const S: usize>(x: &Matrix<S>, y: &Matrix<S>) -> Matrix<S> {
    let mut z = [[0.0; S]; S];
    let mut i = 0;
    while i < S {
        let mut j = 0;
        while j < S {
            let mut k = 0;
            while k < S {
                z[i][j] += x[i][k] * y[k][j];
                k += 1;
            }
            j += 1;
        }
        i += 1;
    }
    z
}

/// Gauss-Jordan with partial pivoting; `None` where a pivot vanishes or is not finite.
pub(crate) const fn inverted<const S: usize>(mut m: Matrix<S>) -> Option<Matrix<S>> {
    let mut inverse = identity();
    let mut column = 0;
    while column < S {
        let mut pivot = column;
        let mut row = column + 1;
        while row < S {
            if m[row][column].abs() > m[pivot][column].abs() {
                pivot = row;
            }
            row += 1;
        }
        (m[column], m[pivot]) = (m[pivot], m[column]);
        (inverse[column], inverse[pivot]) = (inverse[pivot], inverse[column]);
        let scale = 1.0 / m[column][column];
        if !scale.is_finite() {
            return None;
        }
        let mut j = 0;
        while j < S {
            m[column][j] *= scale;
            inverse[column][j] *= scale;
            j += 1;
        }
        let mut row = 0;
        while row < S {
            let factor = if row == column { 0.0 } else { m[row][column] };
            let mut j = 0;
            while j < S {
                m[row][j] -= factor * m[column][j];
                inverse[row][j] -= factor * inverse[column][j];
                j += 1;
            }
            row += 1;
        }
        column += 1;
    }
    Some(inverse)
}

#[cfg(test)]
mod tests {
    use super::{identity, inverted, norm, product};

    #[test]
    fn inverse_takes_the_largest_pivot() {
        // Without exchange of rows the first divides by zero, the second loses all digits.
        for m in [
            [[0.0, 1.0, 0.0], [0.0, 0.0, 2.0], [4.0, 0.0, 0.0]],
            [[1e-18, 1.0, 2.0], [3.0, -1.0, 0.5], [-2.0, 7.0, 1.0]],
            [[2.0, 0.0, 1.0], [0.0, 1e-17, 3.0], [1.0, 5.0, -1.0]],
        ] {
            let inverse = inverted(m).expect("regular");
            let (left, right) = (product(&inverse, &m), product(&m, &inverse));
            for i in 0..3 {
                for j in 0..3 {
                    let unit = identity::<3>()[i][j];
                    assert!((left[i][j] - unit).abs() < 1e-14, "{left:?}");
                    assert!((right[i][j] - unit).abs() < 1e-14, "{right:?}");
                }
            }
        }
        assert!(inverted([[1.0, 2.0], [2.0, 4.0]]).is_none());
        assert!(inverted([[0.0, 0.0], [0.0, 1.0]]).is_none());
    }

    #[test]
    fn norm_is_the_largest_sum_of_a_row() {
        assert_eq!(norm(&[[1.0, -2.0], [3.0, 4.0]]), 7.0);
        assert_eq!(norm(&[[-5.0, -4.0], [3.0, 4.0]]), 9.0);
        assert_eq!(norm(&[[0.0]]), 0.0);
    }

    #[test]
    fn norm_of_a_matrix_with_a_nan_is_nan() {
        assert!(norm(&[[f64::NAN, 0.0], [0.0, 0.1]]).is_nan());
        assert!(norm(&[[0.1, 0.0], [0.0, f64::NAN]]).is_nan());
    }
}
