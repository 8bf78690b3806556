//! Linear models of the motion, built at compile time from a device description.

use crate::const_math::{exp, phi1, phi2};
use crate::design_error::DesignError;
use crate::device::Device;
use crate::riccati;
use crate::sample::{Sample, Signals};
use crate::units::Hertz;

/// Variance of the quantisation error of a count: uniform over one count, 1/12 counts².
pub(crate) const QUANTISATION_VARIANCE: f64 = 1.0 / 12.0;

/// A linear model of the motion seen through one encoder, in counts and ticks:
/// `x_k = A x_{k-1} + B i_{k-1} + w`, `y_k = H x_k + n`, `H = [1 0 ..]`, with covariances Q of w
/// and r = 1/12 of n.
///
/// State `x`: position (counts), velocity (counts per tick), and with `S = 3` acceleration
/// (counts per tick²). A is S × S and upper triangular, Q is S × S and symmetric. `U` says
/// whether the model has an input B, S × 1: [`NoInput`] or [`CurrentInput`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Model<const S: usize, U> {
    pub(crate) a: [[f64; S]; S],
    pub(crate) input: U,
    pub(crate) q: [[f64; S]; S],
    pub(crate) r: f64,
    /// Variances of the state before the first sample.
    pub(crate) prior: [f64; S],
}

/// What drives a [`Model`]: nothing, or the current.
pub trait Input<const S: usize>: Copy {
    /// What it reads of a sample.
    const NEEDS: Signals;

    /// Adds `B i` to the predicted state.
    fn drive(&self, x: &mut [f32; S], sample: &Sample);
}

/// A [`Model`] that nothing drives: no B, no code.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct NoInput;

impl<const S: usize> Input<S> for NoInput {
    const NEEDS: Signals = Signals::COUNT;

    #[inline]
    fn drive(&self, _: &mut [f32; S], _: &Sample) {}
}

/// A [`Model`] that the applied current drives: B, in counts (counts per tick) per A.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CurrentInput<const S: usize>(pub [f32; S]);

impl<const S: usize> Input<S> for CurrentInput<S> {
    const NEEDS: Signals = Signals::COUNT_AND_CURRENT;

    #[inline]
    fn drive(&self, x: &mut [f32; S], sample: &Sample) {
        for i in 0..S {
            x[i] += self.0[i] * sample.current.get();
        }
    }
}

impl Model<3, NoInput> {
    /// Triple integrator driven by white jerk (eqs. 9 to 12).
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
    /// [`DesignError::Rate`], [`DesignError::Device`] (no counts), [`DesignError::ProcessNoise`].
    pub const fn triple_integrator(
        counts_per_rev: u32,
        rate: Hertz,
        jerk_density: f64,
    ) -> Result<Self, DesignError> {
        if !rate.is_positive() {
            return Err(DesignError::Rate);
        }
        if counts_per_rev == 0 {
            return Err(DesignError::Device);
        }
        let t = rate.period_s();
        let q = jerk_density * counts_per_rad(counts_per_rev) * t * t;
        let q = q * q * t;
        if !(jerk_density > 0.0 && q > 0.0 && q.is_finite()) {
            return Err(DesignError::ProcessNoise);
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

impl Model<2, CurrentInput<2>> {
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
    /// [`DesignError::Rate`], [`DesignError::Device`], [`DesignError::ProcessNoise`].
    pub const fn motor(
        device: &Device,
        rate: Hertz,
        current_noise: f64,
    ) -> Result<Self, DesignError> {
        if !rate.is_positive() {
            return Err(DesignError::Rate);
        }
        let device = match device.checked() {
            Ok(device) => device,
            Err(error) => return Err(error),
        };
        let t = rate.period_s();
        let beta = device.damping * t / device.inertia;
        let per_amp =
            counts_per_rad(device.counts_per_rev) * device.torque_constant * t * t / device.inertia;
        if !(beta < 700.0 && per_amp > 0.0 && per_amp < 1e9) {
            return Err(DesignError::Device);
        }
        let b = [per_amp * phi2(beta), per_amp * phi1(beta)];
        let g = [current_noise * b[0], current_noise * b[1]];
        if !(current_noise > 0.0 && g[0] * g[0] > 0.0 && (g[1] * g[1]).is_finite()) {
            return Err(DesignError::ProcessNoise);
        }
        Ok(Self {
            a: [[1.0, phi1(beta)], [0.0, exp(-beta)]],
            input: CurrentInput([b[0] as f32, b[1] as f32]),
            q: [[g[0] * g[0], g[0] * g[1]], [g[0] * g[1], g[1] * g[1]]],
            r: QUANTISATION_VARIANCE,
            prior: [QUANTISATION_VARIANCE, PRIOR_VELOCITY],
        })
    }
}

impl<const S: usize, U: Copy> Model<S, U> {
    /// The limit K, S × 1, of the Kalman gain (eq. 12) as the recursion runs on.
    ///
    /// Found in f64 by doubling the Riccati recursion (2, 4, 8 .. 2^20 ticks), then checked: one
    /// further tick of the plain recursion leaves the gain in place, and powers of the closed
    /// loop `(I - K H) A`, with the gain rounded as it will run, shrink.
    ///
    /// # Errors
    /// [`DesignError::NotConverged`], [`DesignError::NotStable`].
    pub const fn steady_gain(&self) -> Result<[f32; S], DesignError> {
        riccati::steady_gain(&self.a, &self.q, self.r)
    }

    /// The same limit with its variances.
    pub(crate) const fn steady(&self) -> Result<riccati::Steady<S>, DesignError> {
        riccati::steady(&self.a, &self.q, self.r)
    }

    /// Transition matrix A.
    #[must_use]
    pub const fn transition(&self) -> &[[f64; S]; S] {
        &self.a
    }

    /// The input, B.
    #[must_use]
    pub const fn input(&self) -> &U {
        &self.input
    }

    /// Covariance Q of the process noise.
    #[must_use]
    pub const fn process_noise(&self) -> &[[f64; S]; S] {
        &self.q
    }

    /// Variance r of the measurement noise, counts².
    #[must_use]
    pub const fn measurement_noise(&self) -> f64 {
        self.r
    }

    /// Variances of the state, uncorrelated, before the first sample.
    #[must_use]
    pub const fn prior(&self) -> &[f64; S] {
        &self.prior
    }
}

/// (32 counts per tick)²: a start in motion is caught within a few ticks.
const PRIOR_VELOCITY: f64 = 1024.0;

/// (1 count per tick²)².
const PRIOR_ACCELERATION: f64 = 1.0;

const fn counts_per_rad(counts_per_rev: u32) -> f64 {
    counts_per_rev as f64 / (2.0 * core::f64::consts::PI)
}
