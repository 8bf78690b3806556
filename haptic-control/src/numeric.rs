//! Linear algebra and analysis for designs at compile time, in f64.

/// `(cos x, sin x)` for 0 <= x <= π, by halving and doubling the angle.
pub(crate) const fn cos_sin(x: f64) -> (f64, f64) {
    let y = x / 16.0;
    let (mut cos, mut sin) = (1.0, y);
    let (mut even, mut odd) = (1.0, y);
    let mut n = 2.0;
    while n < 18.0 {
        even *= -y * y / (n * (n - 1.0));
        odd *= -y * y / (n * (n + 1.0));
        cos += even;
        sin += odd;
        n += 2.0;
    }
    let mut doublings = 0;
    while doublings < 4 {
        (cos, sin) = (cos * cos - sin * sin, 2.0 * cos * sin);
        doublings += 1;
    }
    (cos, sin)
}

/// Product of two polynomials of degree 2.
pub(crate) const fn multiply(x: [f64; 3], y: [f64; 3]) -> [f64; 5] {
    let mut z = [0.0; 5];
    let mut i = 0;
    while i < 3 {
        let mut j = 0;
        while j < 3 {
            z[i + j] += x[i] * y[j];
            j += 1;
        }
        i += 1;
    }
    z
}

/// Solves `m x = y` by elimination with partial pivoting; `None` if the solution is not unique.
pub(crate) const fn solve(mut m: [[f64; 4]; 4], mut y: [f64; 4]) -> Option<[f64; 4]> {
    let mut column = 0;
    while column < 4 {
        let mut pivot = column;
        let mut row = column + 1;
        while row < 4 {
            if m[row][column].abs() > m[pivot][column].abs() {
                pivot = row;
            }
            row += 1;
        }
        (m[column], m[pivot]) = (m[pivot], m[column]);
        (y[column], y[pivot]) = (y[pivot], y[column]);
        let scale = 1.0 / m[column][column];
        if !scale.is_finite() {
            return None;
        }
        let mut row = 0;
        while row < 4 {
            if row != column {
                let factor = m[row][column] * scale;
                let mut j = column;
                while j < 4 {
                    m[row][j] -= factor * m[column][j];
                    j += 1;
                }
                y[row] -= factor * y[column];
            }
            row += 1;
        }
        column += 1;
    }
    let mut i = 0;
    while i < 4 {
        y[i] /= m[i][i];
        i += 1;
    }
    Some(y)
}

#[cfg(test)]
mod tests {
    use super::{cos_sin, multiply, solve};
    extern crate std;

    #[test]
    fn sine_and_cosine_agree_with_the_standard_library() {
        for i in 0..=1000 {
            let x = f64::from(i) * core::f64::consts::PI / 1000.0;
            let (cos, sin) = cos_sin(x);
            assert!(
                (cos - x.cos()).abs() < 1e-13 && (sin - x.sin()).abs() < 1e-13,
                "{x}"
            );
        }
    }

    #[test]
    fn solution_satisfies_the_equations_and_a_singular_matrix_has_none() {
        let m = [
            [0.0, 2.0, 0.0, 1.0],
            [1.0, 0.0, 3.0, 0.0],
            [0.0, 1.0, 1.0, 0.0],
            [2.0, 0.0, 0.0, 5.0],
        ];
        let y = [1.0, 2.0, 3.0, 4.0];
        let x = solve(m, y).unwrap();
        for (row, y) in m.iter().zip(y) {
            let product: f64 = row.iter().zip(x).map(|(a, b)| a * b).sum();
            assert!((product - y).abs() < 1e-12);
        }
        assert_eq!(solve([[1.0, 1.0, 0.0, 0.0]; 4], y), None);
    }

    #[test]
    fn product_of_polynomials_has_the_convolved_coefficients() {
        assert_eq!(
            multiply([1.0, 2.0, 3.0], [4.0, 5.0, 6.0]),
            [4.0, 13.0, 28.0, 27.0, 18.0]
        );
    }
}
