//! The ladder of process noises, and the prediction over one tick.

use super::member::Member;
use crate::design::const_math::{exp, phi1, phi2};

/// Number of rungs.
pub(super) const RUNGS: usize = 18;

/// Spectral density of the first rung, counts²/s⁵. Each rung has ten times that of the rung below.
const LOWEST: f64 = 10.0;

/// Rung of the first member at the start.
pub(super) const FIRST_RUNG: usize = 4;

/// Correlation time τ of the acceleration, s.
const CORRELATION_TIME: f64 = 0.01;

/// Spectral density of the white part of the acceleration over q τ².
const WHITE_SHARE: f64 = 0.1;

/// Prediction over one tick of a position, a velocity and an acceleration that decays.
#[derive(Clone, Copy, Debug, PartialEq)]
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
}

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
        }
    }

    /// Predicts a member on `rung` over one tick, relative to a count that moved by `displacement`.
    #[inline(always)]
    pub(super) fn predict(&self, member: &mut Member, rung: usize, displacement: f32) {
        let (f02, f12, f22) = (
            self.position_by_acceleration,
            self.velocity_by_acceleration,
            self.left,
        );
        let a = member.acceleration;
        member.position += member.velocity + f02 * a - displacement;
        member.velocity += f12 * a;
        member.acceleration = f22 * a;
        // `min` is no limit, as no rung lies above: it removes the panic of an index.
        let density = self.densities[if rung < RUNGS { rung } else { RUNGS - 1 }];
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
