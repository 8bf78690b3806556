//! Linear regression that forgets, and tells what it explains from chance.

/// Sums over rows, of which older ones are forgotten: the normal equations of a regression of y on N
/// terms.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Regression<const N: usize> {
    /// A: the lower triangle by rows.
    normal: [[f32; N]; N],
    /// b.
    right: [f32; N],
    /// Sum of y².
    square: f32,
    /// Number of rows.
    rows: f32,
}

/// Part of each diagonal element that is added to it.
const RIDGE: f32 = 1e-3;

/// Least diagonal element: a division by it is finite.
const LEAST: f32 = 1e-20;

/// Variance of y by quantisation, counts²: that of a second difference of counts, 6/12.
const QUANTISATION: f32 = 0.5;

/// Least number of rows beyond those that determine the gains.
const LEAST_FREEDOM: f32 = 0.5;

/// Factor of what terms explain by chance: the differences of successive blocks overlap, and the
/// acceleration by other forces is not white.
const CAUTION: f32 = 4.0;

impl<const N: usize> Regression<N> {
    /// No rows.
    pub(super) const NONE: Self = Self {
        normal: [[0.0; N]; N],
        right: [0.0; N],
        square: 0.0,
        rows: 0.0,
    };

    /// Adds a row and keeps the part `kept` of those before.
    pub(super) fn add(&mut self, terms: &[f32; N], y: f32, kept: f32) {
        for i in 0..N {
            for j in 0..=i {
                self.normal[i][j] = kept * self.normal[i][j] + terms[i] * terms[j];
            }
            self.right[i] = kept * self.right[i] + terms[i] * y;
        }
        self.square = kept * self.square + y * y;
        self.rows = kept * self.rows + 1.0;
    }

    /// The gains, by L D Lᵀ, and the share of them to use.
    pub(super) fn solve(&self) -> ([f32; N], f32) {
        let mut l = self.normal;
        let mut per_pivot = [0.0; N];
        let mut x = self.right;
        for i in 0..N {
            l[i][i] += RIDGE * l[i][i] + LEAST;
            for j in 0..i {
                // L_ij D_j.
                let product = l[i][j];
                l[i][j] *= per_pivot[j];
                for k in j + 1..=i {
                    l[i][k] -= product * l[k][j];
                }
                x[i] -= l[i][j] * x[j];
            }
            per_pivot[i] = 1.0 / l[i][i];
        }
        for i in (0..N).rev() {
            x[i] *= per_pivot[i];
            for k in i + 1..N {
                x[i] -= l[k][i] * x[k];
            }
        }
        let mut explained = 0.0;
        for i in 0..N {
            explained += x[i] * self.right[i];
        }
        (x, self.share(explained))
    }

    /// The share of gains that explain `explained` of the sum of y².
    fn share(&self, explained: f32) -> f32 {
        let residual = self.square - explained;
        let residual = if residual > 0.0 { residual } else { 0.0 };
        let freedom = self.rows - N as f32;
        let freedom = if freedom > LEAST_FREEDOM {
            freedom
        } else {
            LEAST_FREEDOM
        };
        let chance = CAUTION * N as f32 * (residual / freedom + QUANTISATION);
        if explained > chance {
            1.0 - chance / explained
        } else {
            0.0
        }
    }
}

#[cfg(test)]
mod tests {
    extern crate std;
    use super::{RIDGE, Regression};
    use crate::filters::draws::draw;
    use nalgebra::{SMatrix, SVector};

    /// A draw from -1 to 1.
    fn uniform(seed: &mut u64) -> f64 {
        (draw(seed) >> 11) as f64 / (1u64 << 52) as f64 - 1.0
    }

    /// Rows of three terms, the second of which resembles the first.
    fn rows(count: usize, noise: f64) -> std::vec::Vec<([f64; 3], f64)> {
        let mut seed = 7;
        (0..count)
            .map(|_| {
                let [a, b, c, n] = [(); 4].map(|()| uniform(&mut seed));
                let terms = [a, 0.9 * a + 0.3 * b, 5.0 * c];
                (
                    terms,
                    3.0 * terms[0] - 2.0 * terms[1] + 0.5 * terms[2] + noise * n,
                )
            })
            .collect()
    }

    fn of(rows: &[([f64; 3], f64)], kept: f32) -> Regression<3> {
        let mut regression = Regression::NONE;
        for (terms, y) in rows {
            regression.add(&terms.map(|term| term as f32), *y as f32, kept);
        }
        regression
    }

    /// A with its ridge, and b.
    fn normal_equations(
        rows: &[([f64; 3], f64)],
        kept: f64,
    ) -> (SMatrix<f64, 3, 3>, SVector<f64, 3>) {
        let (mut a, mut b) = (SMatrix::zeros(), SVector::zeros());
        for (terms, y) in rows {
            let phi = SVector::from(*terms);
            a = a * kept + phi * phi.transpose();
            b = b * kept + phi * *y;
        }
        for i in 0..3 {
            a[(i, i)] *= 1.0 + f64::from(RIDGE);
        }
        (a, b)
    }

    #[test]
    fn gains_are_those_of_the_normal_equations() {
        let rows = rows(60, 0.7);
        let (a, b) = normal_equations(&rows, 0.97);
        let expected = a.try_inverse().expect("regular") * b;
        let (found, _) = of(&rows, 0.97).solve();
        for (found, expected) in found.iter().zip(expected.iter()) {
            assert!(
                (f64::from(*found) / expected - 1.0).abs() < 1e-4,
                "{found} {expected}"
            );
        }
    }

    #[test]
    fn terms_that_explain_y_are_used_and_chance_is_not() {
        let mut exact = rows(200, 0.0);
        let share = |rows: &[([f64; 3], f64)]| of(rows, 1.0).solve().1;
        for (_, y) in &mut exact {
            *y *= 1000.0;
        }
        // 200 rows of a variance far above quantisation.
        assert!(share(&exact) > 0.99);
        let mut seed = 8;
        for (_, y) in &mut exact {
            *y = 1000.0 * uniform(&mut seed);
        }
        assert_eq!(share(&exact), 0.0);
        // Below the quantisation of y nothing can be told.
        for (terms, y) in &mut exact {
            *y = 1e-3 * terms[0];
        }
        assert_eq!(share(&exact), 0.0);
        assert_eq!(Regression::<3>::NONE.solve(), ([0.0; 3], 0.0));
    }
    #[test]
    fn share_is_that_of_james_and_stein() {
        // The count's second difference has a variance of 1/2 by quantisation.
        for (noise, scale) in [(0.7, 1.0), (0.7, 20.0), (3.0, 20.0), (10.0, 2.0)] {
            let mut rows = rows(300, noise);
            for (_, y) in &mut rows {
                *y *= scale;
            }
            let (a, b) = normal_equations(&rows, 1.0);
            let explained = b.dot(&(a.try_inverse().expect("regular") * b));
            let residuals = rows.iter().map(|(_, y)| y * y).sum::<f64>() - explained;
            // 4 times the number of terms.
            let chance = 12.0 * (residuals / (300.0 - 3.0) + 0.5);
            let expected = (1.0 - chance / explained).max(0.0);
            let (_, found) = of(&rows, 1.0).solve();
            assert!(
                (f64::from(found) - expected).abs() < 1e-4,
                "{noise} {scale}: {found} for {expected}"
            );
        }
    }

    #[test]
    fn chance_is_taken_for_an_effect_once_in_a_hundred_times() {
        let mut seed = 9;
        let mut taken = 0;
        for _ in 0..1000 {
            let mut rows = rows(60, 0.0);
            for (_, y) in &mut rows {
                *y = 1000.0 * uniform(&mut seed);
            }
            taken += u32::from(of(&rows, 1.0).solve().1 > 0.0);
        }
        // The variance ratio of 3 and 57 degrees of freedom exceeds 4 with a probability of 1.2 %, and 1
        // with 40 %.
        assert!((3..30).contains(&taken), "{taken}");
    }
}
