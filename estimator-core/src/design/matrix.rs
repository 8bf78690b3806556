//! Matrices of three rows in f64, at compile time.
//!
//! The compiler evaluates constants statement by statement, and most statements of a loop count and
//! compare indices. A design of an observer multiplies thousands of matrices. Without loops in products, sums
//! and rows it takes a third of the time.

/// A 3 x 3 matrix, row after row.
pub(crate) type Matrix = [f64; 9];

pub(crate) const IDENTITY: Matrix = [1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0];

/// A matrix of two or three rows. Of two, the third row and column are zero, and stay so.
pub(crate) const fn matrix<const S: usize>(rows: &[[f64; S]; S]) -> Matrix {
    const { assert!(S == 2 || S == 3, "two or three states") };
    let mut m = [0.0; 9];
    let mut i = 0;
    while i < S {
        let mut j = 0;
        while j < S {
            m[3 * i + j] = rows[i][j];
            j += 1;
        }
        i += 1;
    }
    m
}

/// Largest sum of magnitudes in a row, or NaN if there is one anywhere.
pub(crate) const fn norm(m: &Matrix) -> f64 {
    let [a, b, c, d, e, f, g, h, i] = *m;
    let rows = [
        a.abs() + b.abs() + c.abs(),
        d.abs() + e.abs() + f.abs(),
        g.abs() + h.abs() + i.abs(),
    ];
    let mut largest = 0.0;
    let mut row = 0;
    while row < 3 {
        if rows[row].is_nan() {
            return rows[row];
        }
        if rows[row] > largest {
            largest = rows[row];
        }
        row += 1;
    }
    largest
}

pub(crate) const fn transposed([a, b, c, d, e, f, g, h, i]: Matrix) -> Matrix {
    [a, d, g, b, e, h, c, f, i]
}

#[rustfmt::skip]
pub(crate) const fn sum(x: &Matrix, y: &Matrix) -> Matrix {
    let [a, b, c, d, e, f, g, h, i] = *x;
    let [j, k, l, m, n, o, p, q, r] = *y;
    [
        a + j, b + k, c + l,
        d + m, e + n, f + o,
        g + p, h + q, i + r,
    ]
}

#[rustfmt::skip]
pub(crate) const fn product(x: &Matrix, y: &Matrix) -> Matrix {
    let [a, b, c, d, e, f, g, h, i] = *x;
    let [j, k, l, m, n, o, p, q, r] = *y;
    [
        a * j + b * m + c * p, a * k + b * n + c * q, a * l + b * o + c * r,
        d * j + e * m + f * p, d * k + e * n + f * q, d * l + e * o + f * r,
        g * j + h * m + i * p, g * k + h * n + i * q, g * l + h * o + i * r,
    ]
}

/// Gauss-Jordan with partial pivoting; `None` where a pivot vanishes or is not finite.
pub(crate) const fn inverted([a, b, c, d, e, f, g, h, i]: Matrix) -> Option<Matrix> {
    // Each row with that of the inverse.
    let mut rows = [
        [a, b, c, 1.0, 0.0, 0.0],
        [d, e, f, 0.0, 1.0, 0.0],
        [g, h, i, 0.0, 0.0, 1.0],
    ];
    let mut column = 0;
    while column < 3 {
        let mut pivot = column;
        let mut row = column + 1;
        while row < 3 {
            if rows[row][column].abs() > rows[pivot][column].abs() {
                pivot = row;
            }
            row += 1;
        }
        (rows[column], rows[pivot]) = (rows[pivot], rows[column]);
        let scale = 1.0 / rows[column][column];
        if !scale.is_finite() {
            return None;
        }
        let [a, b, c, d, e, f] = rows[column];
        let [a, b, c, d, e, f] = [
            a * scale,
            b * scale,
            c * scale,
            d * scale,
            e * scale,
            f * scale,
        ];
        rows[column] = [a, b, c, d, e, f];
        let mut row = 0;
        while row < 3 {
            if row != column {
                let k = rows[row][column];
                let [u, v, w, x, y, z] = rows[row];
                rows[row] = [
                    u - k * a,
                    v - k * b,
                    w - k * c,
                    x - k * d,
                    y - k * e,
                    z - k * f,
                ];
            }
            row += 1;
        }
        column += 1;
    }
    let [[.., a, b, c], [.., d, e, f], [.., g, h, i]] = rows;
    Some([a, b, c, d, e, f, g, h, i])
}

#[cfg(test)]
mod tests {
    use super::{IDENTITY, inverted, matrix, norm, product, transposed};

    #[test]
    fn inverse_takes_the_largest_pivot() {
        // Without exchange of rows the first divides by zero, the second loses all digits.
        for m in [
            [0.0, 1.0, 0.0, 0.0, 0.0, 2.0, 4.0, 0.0, 0.0],
            [1e-18, 1.0, 2.0, 3.0, -1.0, 0.5, -2.0, 7.0, 1.0],
            [2.0, 0.0, 1.0, 0.0, 1e-17, 3.0, 1.0, 5.0, -1.0],
            [2.0, -1.0, 3.0, 0.5, 4.0, -2.0, 1.0, 7.0, 5.0],
            [0.25, 4.0, -2.0, -7.0, 3.0, 1.0, 0.5, -1.0, 9.0],
        ] {
            let inverse = inverted(m).expect("regular");
            for one in [product(&inverse, &m), product(&m, &inverse)] {
                for (one, unit) in one.iter().zip(IDENTITY) {
                    assert!((one - unit).abs() < 1e-14, "{m:?}");
                }
            }
        }
        assert!(inverted([1.0, 2.0, 0.0, 2.0, 4.0, 0.0, 0.0, 0.0, 1.0]).is_none());
        assert!(inverted([0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0]).is_none());
    }

    #[test]
    fn operations_are_those_of_another_library() {
        let (x, y) = (
            [0.5, -1.0, 2.0, 3.0, 0.25, -0.75, 1.5, 4.0, -2.0],
            [1.0, 7.0, -3.0, 0.5, 2.0, 5.0, -4.0, 6.0, 0.125],
        );
        let other = nalgebra::Matrix3::from_row_slice;
        // Exact: all are multiples of 1/32.
        assert_eq!(other(&product(&x, &y)), other(&x) * other(&y));
        assert_eq!(other(&super::sum(&x, &y)), other(&x) + other(&y));
        assert_eq!(other(&transposed(x)), other(&x).transpose());
    }

    #[test]
    fn two_rows_have_zeros_beside_them() {
        let m = matrix(&[[1.0, 2.0], [3.0, 4.0]]);
        assert_eq!(m, [1.0, 2.0, 0.0, 3.0, 4.0, 0.0, 0.0, 0.0, 0.0]);
        let m = matrix(&[[1.0, 2.0, 3.0], [4.0, 5.0, 6.0], [7.0, 8.0, 9.0]]);
        assert_eq!(m, [1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0, 9.0]);
    }

    #[test]
    fn norm_is_the_largest_sum_of_a_row() {
        assert_eq!(norm(&matrix(&[[1.0, -2.0], [3.0, 4.0]])), 7.0);
        assert_eq!(norm(&matrix(&[[-5.0, -4.0], [3.0, 4.0]])), 9.0);
        for element in 0..9 {
            let mut m = [-1.0; 9];
            m[element] = -4.0;
            assert_eq!(norm(&m), 6.0);
        }
    }

    #[test]
    fn norm_of_a_matrix_with_a_nan_is_nan() {
        assert!(norm(&matrix(&[[f64::NAN, 0.0], [0.0, 0.1]])).is_nan());
        assert!(norm(&matrix(&[[0.1, 0.0], [0.0, f64::NAN]])).is_nan());
    }
}
