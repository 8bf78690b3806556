//! Bierman's update of a factored covariance.

use super::LARGEST_INNOVATION;
use crate::design::const_math::limited;

/// Largest element of U.
const LARGEST_SHARE: f32 = 1e3;

/// Largest variance `hᵀ P h + r` of a measurement.
const LARGEST_VARIANCE: f32 = LARGEST_INNOVATION * LARGEST_INNOVATION;

/// Bierman's update of `P = U D Uᵀ` by a measurement `h` of variance `r` > 0; returns its gain.
///
/// `None`, and no update, if the variance of the measurement is not a number up to
/// [`LARGEST_VARIANCE`]: the elements of D shrink by no more than `r / LARGEST_VARIANCE`, so none of
/// them underflows to zero, and none is multiplied by infinity.
#[inline(always)]
pub(super) fn bierman(
    upper: &mut [f32; 3],
    diagonal: &mut [f32; 3],
    h: [f32; 3],
    r: f32,
) -> Option<[f32; 3]> {
    let [u01, u02, u12] = *upper;
    let f = [h[0], h[1] + u01 * h[0], h[2] + u02 * h[0] + u12 * h[1]];
    let g = [diagonal[0] * f[0], diagonal[1] * f[1], diagonal[2] * f[2]];
    let a0 = r + f[0] * g[0];
    let a1 = a0 + f[1] * g[1];
    let a2 = a1 + f[2] * g[2];
    if !(a2 <= LARGEST_VARIANCE) {
        return None;
    }
    let (per_a0, per_a1, per_a2) = (1.0 / a0, 1.0 / a1, 1.0 / a2);
    diagonal[0] *= r * per_a0;
    diagonal[1] *= a0 * per_a1;
    diagonal[2] *= a1 * per_a2;
    let bound = |u: f32| limited(u, LARGEST_SHARE);
    let ratio = f[1] * per_a0;
    let k0 = g[0] + g[1] * u01;
    upper[0] = bound(u01 - ratio * g[0]);
    let ratio = f[2] * per_a1;
    upper[1] = bound(u02 - ratio * k0);
    upper[2] = bound(u12 - ratio * g[1]);
    Some([
        (k0 + g[2] * u02) * per_a2,
        (g[1] + g[2] * u12) * per_a2,
        g[2] * per_a2,
    ])
}

#[cfg(test)]
mod tests {
    use super::bierman;

    type Matrix = [[f64; 3]; 3];

    fn dense([u01, u02, u12]: [f32; 3], d: [f32; 3]) -> Matrix {
        let u = [[1.0, u01, u02], [0.0, 1.0, u12], [0.0, 0.0, 1.0]].map(|row| row.map(f64::from));
        let mut p = [[0.0; 3]; 3];
        for i in 0..3 {
            for j in 0..3 {
                p[i][j] = (0..3).map(|k| u[i][k] * f64::from(d[k]) * u[j][k]).sum();
            }
        }
        p
    }

    #[test]
    fn measurement_out_of_range_changes_nothing() {
        let (upper, diagonal) = ([0.3, -0.7, 0.2], [0.5, 0.1, 2.0]);
        // Of a variance of 65536² the third parameter alone makes h = 46341: √2 times that is 65536.
        for (at, h, refused) in [
            (0, f32::NAN, true),
            (1, f32::INFINITY, true),
            (2, 1e30, true),
            (0, -1e12, true),
            (2, 46_342.0, true),
            (2, 46_340.0, false),
            (2, -46_342.0, true),
            (2, -46_340.0, false),
        ] {
            let mut direction = [0.0; 3];
            direction[at] = h;
            let (mut u, mut d) = (upper, diagonal);
            let gain = bierman(&mut u, &mut d, direction, 0.1);
            assert_eq!(gain.is_none(), refused, "{h} in {at}");
            assert_eq!((u, d) == (upper, diagonal), refused, "{h} in {at}");
        }
    }

    #[test]
    fn bierman_update_agrees_with_the_textbook() {
        let (mut upper, mut diagonal) = ([0.3, -0.7, 0.2], [0.5, 0.1, 2.0]);
        for (h, r) in [
            ([1.0, 0.0, 0.0], 0.1),
            ([0.4, -2.0, 0.9], 0.03),
            ([0.0, 0.1, 5.0], 4.0),
        ] {
            let before = dense(upper, diagonal);
            let k = bierman(&mut upper, &mut diagonal, h, r).expect("in range");
            let after = dense(upper, diagonal);
            let h = h.map(f64::from);
            let ph = before.map(|row| (0..3).map(|j| row[j] * h[j]).sum::<f64>());
            let s = f64::from(r) + (0..3).map(|i| h[i] * ph[i]).sum::<f64>();
            for i in 0..3 {
                assert!((f64::from(k[i]) - ph[i] / s).abs() < 1e-5);
                for j in 0..3 {
                    let textbook = before[i][j] - ph[i] * ph[j] / s;
                    assert!((after[i][j] - textbook).abs() < 1e-5, "{i} {j}");
                }
            }
        }
    }
}
