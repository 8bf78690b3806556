//! The triple integrator: only counts are measured, and the acceleration is a state.

use crate::design::DesignError;
use crate::memory::memory;
use crate::models::linear::{Input, Model, PRIOR_VELOCITY, QUANTISATION_VARIANCE, counts_per_rad};
use crate::sample::{Sample, Signals};
use crate::sealed::Sealed;
use crate::units::Hertz;

/// (1 count per tick²)².
const PRIOR_ACCELERATION: f64 = 1.0;

impl Model<3, NoInput> {
    /// Triple integrator with white jerk as process noise (eqs. 9 to 12).
    ///
    /// In counts and ticks, with `s = counts_per_rev / 2 π` and period T:
    /// ```text
    ///     | 1 1 1/2 |                      | 1/20 1/8 1/6 |
    /// A = | 0 1  1  |     Q = ρ² s² T^5 .  | 1/8  1/3 1/2 |
    ///     | 0 0  1  |                      | 1/6  1/2  1  |
    /// ```
    /// `jerk_density` ρ is the jerk's spectral density, rad/s³ per √Hz.
    ///
    /// # Errors
    /// [`DesignError::RATE`], [`DesignError::COUNTS_PER_REV`], [`DesignError::JERK_DENSITY`].
    pub const fn triple_integrator(
        counts_per_rev: u32,
        rate: Hertz,
        jerk_density: f64,
    ) -> Result<Self, DesignError> {
        if !rate.is_positive() {
            return Err(DesignError::RATE);
        }
        if counts_per_rev == 0 {
            return Err(DesignError::COUNTS_PER_REV);
        }
        let t = rate.period_s();
        let q = jerk_density * counts_per_rad(counts_per_rev) * t * t;
        let q = q * q * t;
        if !(jerk_density > 0.0 && q > 0.0 && q.is_finite()) {
            return Err(DesignError::JERK_DENSITY);
        }
        Ok(Self {
            a: [[1.0, 1.0, 0.5], [0.0, 1.0, 1.0], [0.0, 0.0, 1.0]],
            input: NoInput,
            q: [
                [q / 20.0, q / 8.0, q / 6.0],
                [q / 8.0, q / 3.0, q / 2.0],
                [q / 6.0, q / 2.0, q],
            ],
            r: QUANTISATION_VARIANCE,
            prior: [QUANTISATION_VARIANCE, PRIOR_VELOCITY, PRIOR_ACCELERATION],
        })
    }
}

/// No measured input: the [`Model`] is a triple integrator, computed by additions alone.
///
/// The state is `[e, v, h]` with h = a/2; one tick is
/// ```text
/// c = v + h                    mean velocity of the coming tick
/// e = d - c + (1 - k0) e       d: displacement of the count, k0: of the tick before
/// h = h + k2/2 e
/// v = c + h + (k1 - k2/2) e
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[repr(C)]
pub struct NoInput;

memory!(NoInput {});

impl Sealed for NoInput {}

impl Input<3> for NoInput {
    const NEEDS: Signals = Signals::COUNT;

    #[inline(always)]
    fn tick(&self, x: &mut [f32; 3], displacement: f32, _: &Sample, gain: &[f32; 3]) {
        let [e, v, h] = *x;
        let c = v + h;
        let e = displacement - c + gain[0] * e;
        let h = h + gain[2] * e;
        *x = [e, c + h + gain[1] * e, h];
    }

    /// P / r of position, c and h with `c = v - h`, the mean velocity of the tick that ended:
    /// the next adds 2 h to c, then c to the position. In these, with q = Q_22 / r,
    /// ```text
    ///           | 1/20 1/24 1/12 |                     | 0    0     0   |
    /// Q / r = q | 1/24 1/12  0   |     p = P / r + q   | 0 -1/24  1/12 |
    ///           | 1/12  0   1/4  |                     | 0  1/12   0   |
    /// ```
    /// The offset of p is the process noise of the next tick: with it in the covariances of c, the
    /// sums give the covariances of the position their shares 1/24 and 1/12.
    #[inline(always)]
    fn gain(&self, p: &mut [[f32; 3]; 3], q: &[[f32; 3]; 3]) -> [f32; 3] {
        let [[p00, p01, p02], [_, p11, p12], [_, _, p22]] = *p;
        let q = q[2][2];
        let left = 1.0 - p00;

        // c += 2 h, with q/12 in p_12 before and after.
        let c01 = p01 + 2.0 * p02;
        let c12 = p12 + 2.0 * p22;
        let c11 = p11 + 2.0 * (p12 + c12) - q / 4.0;
        // position += c
        let n01 = c01 + c11;
        let n00 = p00 + c01 + n01 + q / 120.0;
        let n02 = p02 + c12;
        let n22 = p22 + q / 4.0;

        let inverse = 1.0 / (n00 + 1.0);
        let [k0, kc, kh] = [n00 * inverse, n01 * inverse, n02 * inverse];
        p[0] = [k0, kc, kh];
        p[1][1] = c11 - kc * n01;
        p[1][2] = c12 - kc * n02;
        p[2][2] = n22 - kh * n02;
        [left, kc, kh]
    }

    fn triangle(&self, covariance: &[[f32; 3]; 3], q: &[[f32; 3]; 3]) -> [[f32; 3]; 3] {
        let [[xx, xv, xa], [_, vv, va], [_, _, aa]] = *covariance;
        let (xh, vh, hh) = (xa / 2.0, va / 2.0, aa / 4.0);
        [
            [xx, xv - xh, xh],
            [
                0.0,
                vv - 2.0 * vh + hh - q[2][2] / 24.0,
                vh - hh + q[2][2] / 12.0,
            ],
            [0.0, 0.0, hh],
        ]
    }

    fn covariance(&self, p: &[[f32; 3]; 3], q: &[[f32; 3]; 3]) -> [[f32; 3]; 3] {
        let [[xx, xc, xh], [_, cc, ch], [_, _, hh]] = *p;
        let (cc, ch) = (cc + q[2][2] / 24.0, ch - q[2][2] / 12.0);
        let (xv, xa) = (xc + xh, 2.0 * xh);
        let vv = cc + 2.0 * ch + hh;
        let va = 2.0 * (ch + hh);
        [[xx, xv, xa], [xv, vv, va], [xa, va, 4.0 * hh]]
    }
}
