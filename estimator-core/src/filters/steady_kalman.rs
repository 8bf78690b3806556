//! Kalman filter with a preset steady gain.

use crate::design::DesignError;
use crate::estimator::{AccelerationEstimator, VelocityEstimator};
use crate::memory::{Memory, memory};
use crate::models::CurrentInput;
use crate::models::NoInput;
use crate::models::linear::{Input, Model, as_taken, widened};
use crate::sample::{Sample, Signals};
use crate::units::{Count, CountsPerTick, CountsPerTickSquared};

/// [`KalmanTriple`](crate::KalmanTriple) with its steady gain.
pub type SteadyKalmanTriple = SteadyKalman<3, NoInput>;

/// [`KalmanMotor`](crate::KalmanMotor) with its steady gain.
pub type SteadyKalmanMotor = SteadyKalman<2, CurrentInput>;

/// Kalman filter over a [`Model`] with the limit of the gain:
/// `x = A x + B i`, then `x = x + K (y - x_0)`.
///
/// x and K are S × 1; K is [`Model::steady_gain`], so no covariance is kept at run time. The position
/// is relative to the newest count.
///
/// ```
/// use estimator_core::*;
/// const FILTER: SteadyKalmanTriple =
///     preset!(SteadyKalman::new(&preset!(Model::triple_integrator(4096, Hertz(1000.0), 1e4))));
/// let mut state = FILTER.start(&Sample::new(Count(0)));
/// let mut v = 0.0;
/// for tick in 1..400 {
///     v = FILTER.update(&mut state, &Sample::new(Count(7 * tick))).0;
/// }
/// assert!((v - 7.0).abs() < 1e-5);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(C)]
pub struct SteadyKalman<const S: usize, U> {
    input: U,
    /// K in the form of [`Input::tick`].
    gain: [f32; S],
    /// P_11 of the limit, after a correction.
    velocity_variance: f32,
}

memory!([const S: usize, U: Memory] SteadyKalman<S, U> { input, gain, velocity_variance });

impl<const S: usize, U: Copy> SteadyKalman<S, U> {
    /// The filter over `model` with its steady gain.
    ///
    /// # Errors
    /// The errors of [`Model::steady_gain`].
    pub const fn new(model: &Model<S, U>) -> Result<Self, DesignError> {
        let steady = match model.steady() {
            Ok(steady) => steady,
            Err(error) => return Err(error),
        };
        let k = widened(&steady.gain);
        Ok(Self {
            input: model.input,
            gain: as_taken(k[0], &k),
            velocity_variance: steady.velocity[1] as f32,
        })
    }

    pub(crate) const fn velocity_variance(&self) -> f32 {
        self.velocity_variance
    }
}

/// State of a [`SteadyKalman`]: x relative to the newest count.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SteadyKalmanState<const S: usize> {
    anchor: Count,
    /// The state of [`Input::tick`].
    x: [f32; S],
}

impl<const S: usize, U: Input<S>> VelocityEstimator for SteadyKalman<S, U> {
    type State = SteadyKalmanState<S>;
    const NEEDS: Signals = U::NEEDS;

    fn start(&self, first: &Sample) -> SteadyKalmanState<S> {
        SteadyKalmanState {
            anchor: first.count,
            x: [0.0; S],
        }
    }

    #[inline(always)]
    fn update(&self, state: &mut SteadyKalmanState<S>, sample: &Sample) -> CountsPerTick {
        let displacement = (sample.count - state.anchor).to_f32();
        state.anchor = sample.count;
        self.input
            .tick(&mut state.x, displacement, sample, &self.gain);
        CountsPerTick(state.x[1])
    }
}

impl AccelerationEstimator for SteadyKalmanTriple {
    fn acceleration(&self, state: &SteadyKalmanState<3>) -> CountsPerTickSquared {
        CountsPerTickSquared(2.0 * state.x[2])
    }
}
