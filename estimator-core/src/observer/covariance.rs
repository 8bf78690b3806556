//! Covariance of position and velocity, its propagation, and its truncation by a count.

use crate::design::const_math::{exp, phi1};
use crate::memory::memory;

/// Covariance P of position and velocity, factored as in
/// [`QuantisedUpdate`](super::QuantisedUpdate): `p = P_00`, `g = P_01 / P_00`,
/// `s = P_11 - P_01² / P_00`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Covariance {
    /// p, counts².
    pub(super) position: f32,
    /// g, per tick.
    pub(super) coupling: f32,
    /// s, (counts/tick)².
    pub(super) velocity: f32,
}

/// Variance of a uniform distribution over ±1/2: of a position in its quantisation interval, counts²,
/// and of a velocity below half a count a tick, (counts/tick)².
const UNIFORM: f32 = 1.0 / 12.0;

impl Covariance {
    /// The covariance before the first tick, of which only the count is known.
    pub(super) const fn at_start() -> Self {
        Self {
            position: UNIFORM,
            coupling: 0.0,
            velocity: UNIFORM,
        }
    }

    /// `[p, s]`: variance of the position, counts², and variance of the velocity given the position,
    /// (counts/tick)².
    #[must_use]
    pub const fn diagonal(&self) -> [f32; 2] {
        [self.position, self.velocity]
    }

    /// g: error of the velocity per error of the position, 1/tick.
    #[must_use]
    pub const fn coupling(&self) -> f32 {
        self.coupling
    }

    /// Variance P_11 of the velocity, (counts/tick)².
    #[must_use]
    pub fn velocity_variance(&self) -> f32 {
        self.velocity + self.coupling * self.coupling * self.position
    }
}

/// Propagation of a [`Covariance`] over a tick.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(C)]
pub(super) struct Propagation {
    /// φ0 and φ1.
    left: f32,
    moved: f32,
    /// k.
    mixed: f32,
    /// w, (counts/tick)².
    pub(super) white: f32,
}

memory!(Propagation {
    left,
    moved,
    mixed,
    white
});

impl Propagation {
    pub(super) const fn new(beta: f64, white: f64) -> Self {
        let (left, moved) = (exp(-beta), phi1(beta));
        Self {
            left: left as f32,
            moved: moved as f32,
            mixed: (moved * moved - left * moved + left * left / 3.0) as f32,
            white: white as f32,
        }
    }

    /// Propagates the covariance over one tick of motion.
    #[inline(always)]
    pub(super) fn propagate(&self, covariance: &mut Covariance) {
        let w = self.white;
        let (p, s) = (covariance.position, covariance.velocity);
        let stays = 1.0 + self.moved * covariance.coupling;
        let turns = self.left * covariance.coupling;
        let kept = p * stays;
        let from_velocity = s * self.moved;
        let position = kept * stays + from_velocity * self.moved + w * (1.0 / 3.0);
        let shared = kept * turns + from_velocity * self.left + 0.5 * w;
        let apart = 1.5 * stays - turns;
        let of_position = p * apart * apart * (1.0 / 3.0) + 0.25 * kept * stays;
        let of_velocity = p * self.left * self.left + w * self.mixed;
        let velocity = s * of_velocity + w * (of_position + w * (1.0 / 12.0));
        let per = 1.0 / position;
        covariance.position = position;
        covariance.coupling = shared * per;
        covariance.velocity = velocity * per;
    }
}

/// Half-width of the parabolic density, in standard deviations of the Gaussian that it approximates.
pub(super) const HALF_WIDTH: f32 = 3.0;

/// Truncation of a parabolic density around `position` to the quantisation interval ±1/2: the shift
/// of the mean, counts, and the factor of the variance, 0 to 1. `h` is the half-width of the density
/// and `per_width` is 1 / 2 h. `None` if the density is inside the interval.
#[inline(always)]
pub(super) fn truncate(position: f32, h: f32, per_width: f32) -> Option<(f32, f32)> {
    let away = position.abs();
    let beyond = away - 0.5;
    let near = beyond + h;
    if !(near > 0.0) {
        return None;
    }
    let (inwards, kept) = if beyond > h {
        (beyond, 0.0)
    } else if h > away + 0.5 {
        (away - away * per_width, per_width)
    } else {
        (0.5 * near * near * per_width, (h - beyond) * per_width)
    };
    Some((if position > 0.0 { -inwards } else { inwards }, kept))
}

#[cfg(test)]
mod tests {
    use super::{Covariance, HALF_WIDTH, Propagation, UNIFORM, truncate};

    const WHITE: f64 = 3e-3;

    type Matrix = [[f64; 2]; 2];

    fn dense(covariance: &Covariance) -> Matrix {
        let [p, g, s] = [
            covariance.position,
            covariance.coupling,
            covariance.velocity,
        ]
        .map(f64::from);
        [[p, g * p], [g * p, s + g * g * p]]
    }

    fn near(a: &Matrix, b: &Matrix) -> bool {
        let pairs = a.iter().flatten().zip(b.iter().flatten());
        pairs
            .into_iter()
            .all(|(a, b)| (a - b).abs() <= 1e-5 * b.abs() + 1e-9)
    }

    fn of(position: f32, coupling: f32, velocity: f32) -> Covariance {
        Covariance {
            position,
            coupling,
            velocity,
        }
    }

    #[test]
    fn propagation_agrees_with_the_textbook() {
        let propagation = Propagation::new(0.08, WHITE);
        let (left, moved) = ((-0.08f64).exp(), (1.0 - (-0.08f64).exp()) / 0.08);
        for (p, g, s) in [
            (UNIFORM, 0.0, 3e-3),
            (1e-3, 0.9, 0.02),
            (2.0, 0.1, 4.0),
            (1e-4, 1.5, 1e-5),
        ] {
            let mut after = of(p, g, s);
            let [[a, b], [_, c]] = dense(&after);
            propagation.propagate(&mut after);
            let b_after = left * (b + moved * c) + WHITE / 2.0;
            let textbook = [
                [
                    a + 2.0 * moved * b + moved * moved * c + WHITE / 3.0,
                    b_after,
                ],
                [b_after, left * left * c + WHITE],
            ];
            assert!(near(&dense(&after), &textbook), "{after:?} {textbook:?}");
        }
    }

    /// Shift of the mean of a Gaussian around `x` by truncation to ±1/2, and the factor of its
    /// variance, by numerical integration.
    fn gaussian(x: f64, sigma: f64) -> (f64, f64) {
        let (mut sums, steps) = ([0.0; 3], 4000);
        for step in 0..steps {
            let y = (f64::from(step) + 0.5) / f64::from(steps) - 0.5;
            let density = (-0.5 * ((y - x) / sigma).powi(2)).exp();
            sums[0] += density;
            sums[1] += density * y;
            sums[2] += density * y * y;
        }
        let mean = sums[1] / sums[0];
        (
            mean - x,
            (sums[2] / sums[0] - mean * mean) / (sigma * sigma),
        )
    }

    #[test]
    fn parabola_approximates_a_gaussian() {
        // Where most corrections are: from two deviations inside a boundary to one outside.
        let mut off = [0.0f64; 2];
        for sigma in [0.05, 0.1, 0.2, 0.3] {
            for tenth in -20..=10 {
                let x = 0.5 + 0.1 * f64::from(tenth) * sigma;
                let h = HALF_WIDTH * sigma as f32;
                let (shift, kept) = truncate(x as f32, h, 0.5 / h).unwrap_or((0.0, 1.0));
                let (exact, left) = gaussian(x, sigma);
                off[0] = off[0].max((f64::from(shift) - exact).abs() / sigma);
                off[1] = off[1].max((f64::from(kept) - left).abs());
            }
        }
        assert!(off[0] < 0.2 && off[1] < 0.16, "{off:?}");
    }

    #[test]
    fn truncation_is_odd_continuous_and_moves_inwards() {
        for h in [0.01, 0.2, 0.5, 0.9] {
            let mut before = None;
            for step in -3000..=3000 {
                let position = step as f32 / 1000.0;
                let (error, kept) = truncate(position, h, 0.5 / h).unwrap_or((0.0, 1.0));
                let (mirrored, same) = truncate(-position, h, 0.5 / h).unwrap_or((0.0, 1.0));
                assert_eq!((error, kept), (-mirrored, same), "{position}");
                assert!((position + error).abs() <= 0.5 + 1e-6, "{position} {h}");
                assert!(error * position <= 0.0, "{position} {h}");
                assert!((0.0..=1.0).contains(&kept), "{position} {h}: {kept}");
                if let Some(before) = before {
                    let jump: f32 = error - before;
                    assert!(jump.abs() < 1.1e-3, "{position} {h}: {jump}");
                }
                before = Some(error);
            }
        }
    }
}
