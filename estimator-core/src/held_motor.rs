//! The motor on a held coupler: the current is known, and the acceleration follows from it.

use crate::const_math::{exp, phi1, phi2};
use crate::design_error::DesignError;
use crate::device::Device;
use crate::model::{Input, Model, PRIOR_VELOCITY, QUANTISATION_VARIANCE, counts_per_rad};
use crate::sample::{Sample, Signals};
use crate::units::Hertz;

impl Model<2, CurrentInput> {
    /// Motor with known current on a held coupler (eqs. 14 and 16): `J dω/dt = Kt i - b ω`.
    ///
    /// Eq. 16 carries the current as a third state that the measured value replaces at every
    /// tick; its row of A is zero, so eliminating it is exact and leaves, with `β = b T / J`,
    /// `φ1 = (1 - e^-β) / β`, `φ2 = (β - 1 + e^-β) / β²`, `s = counts_per_rev / 2 π`:
    /// ```text
    /// A = | 1   φ1   |     B = s Kt T² / J . | φ2 |     Q = σ² B Bᵀ
    ///     | 0 exp(-β)|                       | φ1 |
    /// ```
    /// Discretised exactly for a current held over the period, where the paper steps forward.
    /// `current_noise` σ is the standard deviation of the current's error, A, drawn anew at
    /// each tick. For eq. 15, literally, see [`LateCurrent`](crate::LateCurrent).
    ///
    /// The paper's model has no friction and a still handle: both end up in the error.
    ///
    /// # Errors
    /// [`DesignError::RATE`]; the errors of [`Device::checked`]; [`DesignError::RATE_FOR_DAMPING`],
    /// [`DesignError::RATE_FOR_CURRENT`]; [`DesignError::CURRENT_NOISE`].
    pub const fn motor(
        device: &Device,
        rate: Hertz,
        current_noise: f64,
    ) -> Result<Self, DesignError> {
        if !rate.is_positive() {
            return Err(DesignError::RATE);
        }
        let device = match device.checked() {
            Ok(device) => device,
            Err(error) => return Err(error),
        };
        let t = rate.period_s();
        let beta = device.damping * t / device.inertia;
        let per_amp =
            counts_per_rad(device.counts_per_rev) * device.torque_constant * t * t / device.inertia;
        if !(beta < 700.0) {
            return Err(DesignError::RATE_FOR_DAMPING);
        }
        if !(per_amp > 0.0 && per_amp < 1e9) {
            return Err(DesignError::RATE_FOR_CURRENT);
        }
        let b = [per_amp * phi2(beta), per_amp * phi1(beta)];
        let g = [current_noise * b[0], current_noise * b[1]];
        if !(current_noise > 0.0 && g[0] * g[0] > 0.0 && (g[1] * g[1]).is_finite()) {
            return Err(DesignError::CURRENT_NOISE);
        }
        Ok(Self {
            a: [[1.0, phi1(beta)], [0.0, exp(-beta)]],
            input: CurrentInput {
                per_amp: b[1] as f32,
                loss: (beta * phi1(beta)) as f32,
                share: (phi2(beta) / phi1(beta)) as f32,
            },
            q: [[g[0] * g[0], g[0] * g[1]], [g[0] * g[1], g[1] * g[1]]],
            r: QUANTISATION_VARIANCE,
            prior: [QUANTISATION_VARIANCE, PRIOR_VELOCITY],
        })
    }
}

/// The applied current drives the [`Model`]: a motor on a held coupler.
///
/// The state is `[e, v]` and moves by
/// ```text
/// u = per_amp i - loss v         what current and damping add to the velocity
/// e = d - v - share u + (1 - k0) e      d: displacement of the count, k0: of the tick before
/// v = v + (u + k1 e)
/// ```
/// which is `A x + B i` with the small increment added last, where rounding costs least.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CurrentInput {
    /// B_1: counts per tick, per A.
    per_amp: f32,
    /// 1 - A_11: the share of the velocity that damping takes in a tick.
    loss: f32,
    /// B_0 / B_1: the share of its increment that the velocity has in the mean of a tick; 1/2
    /// without damping.
    share: f32,
}

impl CurrentInput {
    /// B: counts and counts per tick that an ampere adds in a tick.
    #[must_use]
    pub const fn per_amp(&self) -> [f32; 2] {
        [self.share * self.per_amp, self.per_amp]
    }
}

impl Input<2> for CurrentInput {
    const NEEDS: Signals = Signals::COUNT_AND_CURRENT;

    #[inline(always)]
    fn tick(&self, x: &mut [f32; 2], displacement: f32, sample: &Sample, gain: &[f32; 2]) {
        let [e, v] = *x;
        let increment = self.per_amp * sample.current.get() - self.loss * v;
        let e = displacement - v - self.share * increment + gain[0] * e;
        *x = [e, v + (increment + gain[1] * e)];
    }

    /// P / r of position and velocity.
    #[inline(always)]
    fn gain(&self, p: &mut [[f32; 2]; 2], q: &[[f32; 2]; 2]) -> [f32; 2] {
        let [[p00, p01], [_, p11]] = *p;
        let [[q00, q01], [_, q11]] = *q;
        let (a01, a11) = (1.0 - self.share * self.loss, 1.0 - self.loss);
        let left = 1.0 - p00;

        let half = p01 + a01 * p11;
        let n00 = p00 + (a01 * (p01 + half) + q00);
        let n01 = a11 * half + q01;
        let n11 = a11 * a11 * p11 + q11;

        let inverse = 1.0 / (n00 + 1.0);
        let [k0, k1] = [n00 * inverse, n01 * inverse];
        p[0] = [k0, k1];
        p[1][1] = n11 - k1 * n01;
        [left, k1]
    }

    fn triangle(&self, covariance: &[[f32; 2]; 2], _: &[[f32; 2]; 2]) -> [[f32; 2]; 2] {
        let [[xx, xv], [_, vv]] = *covariance;
        [[xx, xv], [0.0, vv]]
    }

    fn covariance(&self, p: &[[f32; 2]; 2], _: &[[f32; 2]; 2]) -> [[f32; 2]; 2] {
        let [[xx, xv], [_, vv]] = *p;
        [[xx, xv], [xv, vv]]
    }
}
