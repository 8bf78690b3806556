//! Kalman filter with a covariance at run time.

use crate::design::DesignError;
use crate::estimator::{AccelerationEstimator, VelocityEstimator};
use crate::memory::{Memory, memory};
use crate::models::CurrentInput;
use crate::models::NoInput;
use crate::models::{Input, Model};
use crate::sample::{Sample, Signals};
use crate::units::{Count, CountsPerTick, CountsPerTickSquared};

/// The paper's triple-integrator filter (eqs. 9 to 12).
pub type KalmanTriple = Kalman<3, NoInput>;

/// The paper's realistic filter (eqs. 14 and 16).
pub type KalmanMotor = Kalman<2, CurrentInput>;

/// Largest variance of the process noise in one tick, for the velocity (512 counts/tick)².
///
/// Above it the update cancels more digits than an f32 has, and P becomes indefinite.
const LARGEST_PROCESS_NOISE: f64 = 262_144.0;

/// Kalman filter over a [`Model`], with its covariance at run time:
/// ```text
/// predict   x = A x + B i          P = A P Aᵀ + Q
/// update    e = y - x_0            S = P_00 + r         K = P_·0 / S
///           x = x + K e            P = P - K P_0·
/// ```
/// x is S × 1, P is S × S. [`NoInput`] and [`CurrentInput`] write the products out. P is kept in
/// units of r and as a triangle, so it is symmetric by construction. Its first row after the update
/// is K, so the variance of the position stays positive. The position is relative to the newest
/// count, so f32 is exact enough at any distance.
///
/// The initial standard deviation of the velocity is 32 counts/tick. The gain converges to the steady
/// gain, with which [`SteadyKalman`](crate::SteadyKalman) gives the same velocity in fewer
/// instructions.
///
/// ```
/// use estimator_core::{Count, Hertz, KalmanTriple, Model, Sample, VelocityEstimator, Kalman, preset};
/// const FILTER: KalmanTriple =
///     preset!(Kalman::new(&preset!(Model::triple_integrator(4096, Hertz(1000.0), 1e4))));
/// let mut state = FILTER.start(&Sample::new(Count(0)));
/// let mut v = 0.0;
/// for tick in 1..200 {
///     v = FILTER.update(&mut state, &Sample::new(Count(7 * tick))).0;
/// }
/// assert!((v - 7.0).abs() < 1e-5);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(C)]
pub struct Kalman<const S: usize, U> {
    input: U,
    /// Q / r.
    q: [[f32; S]; S],
    r: f32,
    /// Variances of the state before the first sample, over r.
    prior: [f32; S],
}

memory!([const S: usize, U: Memory] Kalman<S, U> { input, q, r, prior });

impl<const S: usize, U: Copy> Kalman<S, U> {
    /// The filter over `model`.
    ///
    /// # Errors
    /// The errors of [`Model::steady_gain`]: a filter that does not settle is refused.
    /// [`DesignError::PROCESS_NOISE`] if a variance of Q is above 2^18.
    pub const fn new(model: &Model<S, U>) -> Result<Self, DesignError> {
        const { assert!(S >= 2, "position and velocity at least") };
        if let Err(error) = model.steady_gain() {
            return Err(error);
        }
        let mut filter = Self {
            input: model.input,
            q: [[0.0; S]; S],
            r: model.r as f32,
            prior: [0.0; S],
        };
        let mut i = 0;
        while i < S {
            if !(model.q[i][i] <= LARGEST_PROCESS_NOISE) {
                return Err(DesignError::PROCESS_NOISE);
            }
            filter.prior[i] = (model.prior[i] / model.r) as f32;
            let mut j = 0;
            while j < S {
                filter.q[i][j] = (model.q[i][j] / model.r) as f32;
                j += 1;
            }
            i += 1;
        }
        Ok(filter)
    }
}

/// State of a [`Kalman`]: x relative to the newest count, and P.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct KalmanState<const S: usize> {
    anchor: Count,
    /// The state of [`Input::tick`].
    x: [f32; S],
    /// The triangle of [`Input::gain`].
    p: [[f32; S]; S],
}

impl<const S: usize, U: Input<S>> Kalman<S, U> {
    /// Covariance P of the state, in counts and ticks.
    #[must_use]
    pub fn covariance(&self, state: &KalmanState<S>) -> [[f32; S]; S] {
        let p = self.input.covariance(&state.p, &self.q);
        p.map(|row| row.map(|element| element * self.r))
    }
}

impl<const S: usize, U: Input<S>> VelocityEstimator for Kalman<S, U> {
    type State = KalmanState<S>;
    const NEEDS: Signals = U::NEEDS;

    fn start(&self, first: &Sample) -> KalmanState<S> {
        let mut prior = [[0.0; S]; S];
        for (i, row) in prior.iter_mut().enumerate() {
            row[i] = self.prior[i];
        }
        KalmanState {
            anchor: first.count,
            x: [0.0; S],
            p: self.input.triangle(&prior, &self.q),
        }
    }

    // Multiplications by a preset's zeros and ones are removed only where the preset is visible.
    #[inline(always)]
    fn update(&self, state: &mut KalmanState<S>, sample: &Sample) -> CountsPerTick {
        let displacement = (sample.count - state.anchor).to_f32();
        state.anchor = sample.count;
        let gain = self.input.gain(&mut state.p, &self.q);
        self.input.tick(&mut state.x, displacement, sample, &gain);
        CountsPerTick(state.x[1])
    }
}

impl AccelerationEstimator for KalmanTriple {
    fn acceleration(&self, state: &KalmanState<3>) -> CountsPerTickSquared {
        CountsPerTickSquared(2.0 * state.x[2])
    }
}
