//! Alpha-beta-gamma filter with fading memory.

use crate::design::DesignError;
use crate::estimator::{AccelerationEstimator, VelocityEstimator};
use crate::memory::memory;
use crate::sample::{Sample, Signals};
use crate::units::{Count, CountsPerTick, CountsPerTickSquared, Hertz};

use super::pole::pole;

/// Alpha-beta-gamma filter with fading memory: the parabola through all past counts whose squared
/// errors, weighted by `p^(2 age)`, are least, with `p = exp(-2 π f / rate)`:
/// ```text
/// e = y_k - (θ + v + a/2)      θ = θ + v + a/2 + (1 - p³) e
/// v = v + a + 3/2 (1 - p)² (1 + p) e           a = a + (1 - p)³ e
/// ```
/// Units: counts and ticks. The position θ then lies p³ e behind the newest count, so the innovation e
/// stands for it: `e = y_k - y_{k-1} - v - a/2 + p³ e`, without a distance that loses digits.
///
/// All three poles lie at p. The velocity follows a ramp of position and a constant acceleration
/// without error; it overshoots a step of velocity by 20 to 25 % for f up to rate/9, by 43 % at rate/2, and is
/// 3 dB down at 1.64 f for f << rate. Valid for f from 1e-6 to 1/2 of the rate. Source: the fading-memory filter of second
/// degree, Morrison, Introduction to Sequential Smoothing and Prediction, 1969.
///
/// ```
/// use estimator_core::{Count, AlphaBetaGamma, Hertz, Sample, VelocityEstimator, preset};
/// const FILTER: AlphaBetaGamma = preset!(AlphaBetaGamma::new(Hertz(20.0), Hertz(1000.0)));
/// let mut state = FILTER.start(&Sample::new(Count(0)));
/// let mut v = 0.0;
/// for k in 1..400u32 {
///     // Position k², acceleration 2 counts per tick².
///     v = FILTER.update(&mut state, &Sample::new(Count(k * k))).0;
/// }
/// assert!((v - 2.0 * 399.0).abs() < 1e-2);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(C)]
pub struct AlphaBetaGamma {
    /// The part of the innovation that the position gain leaves: p³.
    leftover: f32,
    /// Velocity gain β, 3/2 (1 - p)² (1 + p).
    beta: f32,
    /// Acceleration gain γ, (1 - p)³.
    gamma: f32,
}

memory!(AlphaBetaGamma {
    leftover,
    beta,
    gamma
});

impl AlphaBetaGamma {
    /// A filter with its three poles at the frequency `bandwidth`, updated at `rate`.
    ///
    /// # Errors
    /// [`DesignError::RATE`], [`DesignError::BANDWIDTH`].
    pub const fn new(bandwidth: Hertz, rate: Hertz) -> Result<Self, DesignError> {
        let pole = match pole(bandwidth, rate, DesignError::BANDWIDTH) {
            Ok(pole) => pole,
            Err(error) => return Err(error),
        };
        let forgotten = 1.0 - pole;
        Ok(Self {
            leftover: (pole * pole * pole) as f32,
            beta: (1.5 * forgotten * forgotten * (1.0 + pole)) as f32,
            gamma: (forgotten * forgotten * forgotten) as f32,
        })
    }
}

/// State of an [`AlphaBetaGamma`]: the innovation, which stands for the position behind the newest
/// count, velocity and acceleration.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AlphaBetaGammaState {
    anchor: Count,
    innovation: f32,
    velocity: f32,
    acceleration: f32,
}

impl VelocityEstimator for AlphaBetaGamma {
    type State = AlphaBetaGammaState;
    const NEEDS: Signals = Signals::COUNT;

    fn start(&self, first: &Sample) -> AlphaBetaGammaState {
        AlphaBetaGammaState {
            anchor: first.count,
            innovation: 0.0,
            velocity: 0.0,
            acceleration: 0.0,
        }
    }

    #[inline(always)]
    fn update(&self, state: &mut AlphaBetaGammaState, sample: &Sample) -> CountsPerTick {
        self.tick(state, sample, state.acceleration)
    }
}

impl AlphaBetaGamma {
    /// The update, with the acceleration over the tick that ends with `sample`: that of the state, and a
    /// part that is known.
    #[inline(always)]
    pub(super) fn tick(
        &self,
        state: &mut AlphaBetaGammaState,
        sample: &Sample,
        acceleration: f32,
    ) -> CountsPerTick {
        let displacement = (sample.count - state.anchor).to_f32();
        state.anchor = sample.count;
        let predicted = state.velocity + 0.5 * acceleration;
        state.innovation = displacement - predicted + self.leftover * state.innovation;
        state.velocity += acceleration + self.beta * state.innovation;
        state.acceleration += self.gamma * state.innovation;
        CountsPerTick(state.velocity)
    }
}

impl AlphaBetaGammaState {
    /// The acceleration of the state, counts/tick².
    #[inline(always)]
    pub(super) const fn acceleration(&self) -> f32 {
        self.acceleration
    }
}

impl AccelerationEstimator for AlphaBetaGamma {
    fn acceleration(&self, state: &AlphaBetaGammaState) -> CountsPerTickSquared {
        CountsPerTickSquared(state.acceleration)
    }
}
