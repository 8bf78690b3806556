//! The ladder of process noises, and the prediction over one tick or another interval.

use super::member::Member;
use crate::design::const_math::{exp, phi1, phi2};
use crate::memory::memory;

/// Number of rungs.
pub(super) const RUNGS: usize = 18;

/// Spectral density of the first rung, counts²/s⁵. Each rung has ten times that of the rung below.
pub(super) const LOWEST: f64 = 10.0;

/// Rung of the first member at the start.
pub(super) const FIRST_RUNG: u32 = 4;

/// Correlation time τ of the acceleration, s.
pub(super) const CORRELATION_TIME: f64 = 0.02;

/// Spectral density of the white part of the acceleration over q τ².
pub(super) const WHITE_SHARE: f64 = 0.025;

/// Prediction of a member.
pub(super) trait Predict {
    /// Predicts a member on `rung`, relative to a count that moved by `displacement`.
    fn predict(&self, member: &mut Member, rung: usize, displacement: f32);
}

/// Prediction over one tick of a position, a velocity and an acceleration that decays.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(C)]
pub(super) struct Ladder {
    /// F_02.
    position_by_acceleration: f32,
    /// F_12.
    velocity_by_acceleration: f32,
    /// F_22.
    left: f32,
    /// Q of q T⁵ = 1: 00, 01, 02, 11, 12, 22.
    noise: [f32; 6],
    /// q T⁵ of each rung, counts².
    densities: [f32; RUNGS],
    /// T / τ.
    pub(super) rate: f32,
}

memory!(Ladder {
    position_by_acceleration,
    velocity_by_acceleration,
    left,
    noise,
    densities,
    rate
});

impl Ladder {
    /// The ladder for the control period `period`, s.
    pub(super) const fn new(period: f64) -> Self {
        let rate = period / CORRELATION_TIME;
        // White acceleration: q τ² share T³, in units of q T⁵.
        let white = WHITE_SHARE / (rate * rate);
        let mut noise = integrated(rate);
        noise[0] += white / 3.0;
        noise[1] += white / 2.0;
        noise[3] += white;
        let mut densities = [0.0; RUNGS];
        let mut density = LOWEST * period * period * period * period * period;
        let mut i = 0;
        while i < RUNGS {
            densities[i] = density as f32;
            density *= 10.0;
            i += 1;
        }
        Self {
            position_by_acceleration: phi2(rate) as f32,
            velocity_by_acceleration: phi1(rate) as f32,
            left: exp(-rate) as f32,
            noise: [
                noise[0] as f32,
                noise[1] as f32,
                noise[2] as f32,
                noise[3] as f32,
                noise[4] as f32,
                noise[5] as f32,
            ],
            densities,
            rate: rate as f32,
        }
    }

    /// τ, ticks.
    pub(super) fn correlation_time(&self) -> f32 {
        1.0 / self.rate
    }

    /// q T⁵ of a rung, counts².
    #[inline(always)]
    pub(super) fn density(&self, rung: usize) -> f32 {
        // No rung lies above: the comparison removes the panic of an index.
        self.densities[if rung < RUNGS { rung } else { RUNGS - 1 }]
    }
}

impl Predict for Ladder {
    /// Predicts over one tick.
    #[inline(always)]
    fn predict(&self, member: &mut Member, rung: usize, displacement: f32) {
        let (f02, f12, f22) = (
            self.position_by_acceleration,
            self.velocity_by_acceleration,
            self.left,
        );
        let a = member.acceleration;
        member.position += member.velocity + f02 * a - displacement;
        member.velocity += f12 * a;
        member.acceleration = f22 * a;
        let density = self.density(rung);
        let [p00, p01, p02, p11, p12, p22] = member.covariance;
        let r00 = p00 + p01 + f02 * p02;
        let r01 = p01 + p11 + f02 * p12;
        let r02 = p02 + p12 + f02 * p22;
        let r11 = p11 + f12 * p12;
        let r12 = p12 + f12 * p22;
        member.covariance = [
            r00 + r01 + f02 * r02 + density * self.noise[0],
            r01 + f12 * r02 + density * self.noise[1],
            f22 * r02 + density * self.noise[2],
            r11 + f12 * r12 + density * self.noise[3],
            f22 * r12 + density * self.noise[4],
            f22 * f22 * p22 + density * self.noise[5],
        ];
    }
}

/// The integral of f fᵀ over one tick, with f the answer of position, velocity and acceleration to a
/// unit step of the acceleration that decays at `rate` per tick. By Simpson's rule.
const fn integrated(rate: f64) -> [f64; 6] {
    const STEPS: usize = 64;
    let mut sums = [0.0; 6];
    let mut step = 0;
    while step <= STEPS {
        let weight = if step == 0 || step == STEPS {
            1.0
        } else if step % 2 == 1 {
            4.0
        } else {
            2.0
        };
        let s = step as f64 / STEPS as f64;
        let f = [s * s * phi2(rate * s), s * phi1(rate * s), exp(-rate * s)];
        let mut at = 0;
        let mut i = 0;
        while i < 3 {
            let mut j = i;
            while j < 3 {
                sums[at] += weight / (3.0 * STEPS as f64) * f[i] * f[j];
                at += 1;
                j += 1;
            }
            i += 1;
        }
        step += 1;
    }
    sums
}

#[cfg(test)]
pub(super) mod tests {
    extern crate std;
    use super::{CORRELATION_TIME, LOWEST, Ladder, Predict, WHITE_SHARE};
    use crate::bank::member::Member;
    use nalgebra::{Matrix3, SMatrix, Vector3};

    /// Transition and process noise over `interval` ticks, by Van Loan's exponential of a block matrix, of the
    /// model in counts and ticks.
    pub(in crate::bank) fn van_loan(
        period: f64,
        interval: f64,
        density: f64,
    ) -> (Matrix3<f64>, Matrix3<f64>) {
        let rate = period / CORRELATION_TIME;
        let a = Matrix3::new(0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, -rate);
        let jerk = density * period.powi(5);
        let white = density * CORRELATION_TIME.powi(2) * WHITE_SHARE * period.powi(3);
        let q = Matrix3::from_diagonal(&Vector3::new(0.0, white, jerk));
        let mut block = SMatrix::<f64, 6, 6>::zeros();
        block
            .fixed_view_mut::<3, 3>(0, 0)
            .copy_from(&(-a * interval));
        block
            .fixed_view_mut::<3, 3>(0, 3)
            .copy_from(&(q * interval));
        let transposed = a.transpose() * interval;
        block.fixed_view_mut::<3, 3>(3, 3).copy_from(&transposed);
        let exponential = block.exp();
        let transition = exponential.fixed_view::<3, 3>(3, 3).transpose();
        let noise = transition * exponential.fixed_view::<3, 3>(0, 3);
        (transition, noise)
    }

    #[test]
    fn prediction_is_that_of_the_continuous_model() {
        for period in [1e-2, 2e-3, 1e-3, 5e-5, 1e-5] {
            let ladder = Ladder::new(period);
            // The noise of the first rung, and a rung whose noise matters.
            for rung in [0, 9, 17] {
                let density = LOWEST * 10f64.powi(i32::try_from(rung).expect("small"));
                let (transition, noise) = van_loan(period, 1.0, density);
                let p = Matrix3::new(0.3, 0.1, 0.02, 0.1, 0.4, -0.05, 0.02, -0.05, 0.2);
                for p in [p, Matrix3::zeros()] {
                    let x = Vector3::new(0.2, 3.0, -0.7);
                    let mut member = Member {
                        position: x[0] as f32,
                        velocity: x[1] as f32,
                        acceleration: x[2] as f32,
                        covariance: [(0, 0), (0, 1), (0, 2), (1, 1), (1, 2), (2, 2)]
                            .map(|at| p[at] as f32),
                    };
                    ladder.predict(&mut member, rung, 4.0);
                    let x = transition * x;
                    let found = [member.position, member.velocity, member.acceleration];
                    for (found, expected) in found.iter().zip([x[0] - 4.0, x[1], x[2]]) {
                        assert!((f64::from(*found) - expected).abs() < 1e-5, "{period}");
                    }
                    let p = transition * p * transition.transpose() + noise;
                    let places = [(0, 0), (0, 1), (0, 2), (1, 1), (1, 2), (2, 2)];
                    for (found, at) in member.covariance.iter().zip(places) {
                        let off = f64::from(*found) / p[at] - 1.0;
                        assert!(off.abs() < 1e-5, "{period} {rung} {at:?}: {off}");
                    }
                }
            }
        }
    }
}
