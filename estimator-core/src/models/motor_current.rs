//! A motor whose current is measured, on a coupling that is held.

use crate::design::DesignError;
use crate::design::const_math::{exp, phi1, phi2};
use crate::memory::memory;
use crate::models::MotorModel;
use crate::models::linear::{Input, Model, PRIOR_VELOCITY, QUANTISATION_VARIANCE, counts_per_rad};
use crate::sample::{Sample, Signals};
use crate::sealed::Sealed;
use crate::units::Hertz;

impl Model<2, CurrentInput> {
    /// Motor with measured current, coupled to a shaft at rest (eqs. 14 and 16): `J dω/dt = Kt i - b ω`.
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
    /// The paper's model has no friction and a coupled shaft at rest. Friction and motion of the
    /// coupled shaft become errors of the velocity.
    ///
    /// # Errors
    /// [`DesignError::RATE`]; the errors of [`MotorModel::checked`]; [`DesignError::RATE_FOR_DAMPING`],
    /// [`DesignError::RATE_FOR_CURRENT`]; [`DesignError::CURRENT_NOISE`].
    pub const fn motor(
        motor: &MotorModel,
        rate: Hertz,
        current_noise: f64,
    ) -> Result<Self, DesignError> {
        if !rate.is_positive() {
            return Err(DesignError::RATE);
        }
        let motor = match motor.checked() {
            Ok(motor) => motor,
            Err(error) => return Err(error),
        };
        let t = rate.period_s();
        let beta = motor.damping * t / motor.inertia;
        let per_amp =
            counts_per_rad(motor.counts_per_rev) * motor.torque_constant * t * t / motor.inertia;
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

/// The motor current as input of the [`Model`].
///
/// The state is `[e, v]`; one tick is
/// ```text
/// u = per_amp i - loss v         change of the velocity by current and damping
/// e = d - v - share u + (1 - k0) e      d: displacement of the count, k0: of the tick before
/// v = v + (u + k1 e)
/// ```
/// which is `A x + B i` with the small increment added last, where rounding costs least.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(C)]
pub struct CurrentInput {
    /// B_1: counts per tick, per A.
    per_amp: f32,
    /// 1 - A_11: relative loss of velocity by damping in a tick.
    loss: f32,
    /// B_0 / B_1: part of the velocity's increment that acts in the mean of the tick; 1/2 without
    /// damping.
    share: f32,
}

memory!(CurrentInput {
    per_amp,
    loss,
    share
});

impl CurrentInput {
    /// B: change of position, counts, and of velocity, counts/tick, per ampere in a tick.
    #[must_use]
    pub const fn per_amp(&self) -> [f32; 2] {
        [self.share * self.per_amp, self.per_amp]
    }
}

impl Sealed for CurrentInput {}

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
