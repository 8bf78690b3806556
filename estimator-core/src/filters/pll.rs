//! Critically damped tracking loop.

use crate::design::DesignError;
use crate::estimator::VelocityEstimator;
use crate::memory::memory;
use crate::sample::{Sample, Signals};
use crate::units::{Count, CountsPerTick, Hertz};

use super::pole::pole;

/// Critically damped tracking loop, known as the PLL of motor controllers, in exact discrete form:
/// ```text
/// e = y_k - (θ + v)     θ = θ + v + (1 - p²) e     v = v + (1 - p)² e     p = exp(-2 π f / rate)
/// ```
/// θ lies p² e behind the newest count, so e replaces it and no large position is rounded:
/// `e = y_k - y_{k-1} - v + p² e`.
///
/// Both poles of the error are at p, the pole of frequency f in Hz at any rate, so the error settles
/// without overshoot. The velocity is 3 dB down at 0.64 f. A ramp is followed without error. Valid for
/// f from 1e-6 to 1/2 of the rate. The gains are those of the fading-memory filter of first degree
/// (Morrison 1969).
///
/// ```
/// use estimator_core::{Count, Hertz, Pll, Sample, VelocityEstimator, preset};
/// const LOOP: Pll = preset!(Pll::new(Hertz(50.0), Hertz(1000.0)));
/// let mut state = LOOP.start(&Sample::new(Count(0)));
/// let mut v = 0.0;
/// for tick in 1..200 {
///     v = LOOP.update(&mut state, &Sample::new(Count(7 * tick))).0;
/// }
/// assert!((v - 7.0).abs() < 1e-5);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(C)]
pub struct Pll {
    /// Part of the error that the position gain leaves: p².
    leftover: f32,
    /// Velocity gain, (1 - p)².
    gain: f32,
}

memory!(Pll { leftover, gain });

impl Pll {
    /// A loop of `bandwidth`, updated at `rate`.
    ///
    /// # Errors
    /// [`DesignError::RATE`], [`DesignError::BANDWIDTH`].
    pub const fn new(bandwidth: Hertz, rate: Hertz) -> Result<Self, DesignError> {
        let pole = match pole(bandwidth, rate, DesignError::BANDWIDTH) {
            Ok(pole) => pole,
            Err(error) => return Err(error),
        };
        Ok(Self {
            leftover: (pole * pole) as f32,
            gain: ((1.0 - pole) * (1.0 - pole)) as f32,
        })
    }
}

/// State of a [`Pll`]: the error, which replaces the position, and the velocity.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PllState {
    anchor: Count,
    error: f32,
    velocity: f32,
}

impl VelocityEstimator for Pll {
    type State = PllState;
    const NEEDS: Signals = Signals::COUNT;

    fn start(&self, first: &Sample) -> PllState {
        PllState {
            anchor: first.count,
            error: 0.0,
            velocity: 0.0,
        }
    }

    #[inline(always)]
    fn update(&self, state: &mut PllState, sample: &Sample) -> CountsPerTick {
        let displacement = (sample.count - state.anchor).to_f32();
        state.anchor = sample.count;
        state.error = displacement - state.velocity + self.leftover * state.error;
        state.velocity += self.gain * state.error;
        CountsPerTick(state.velocity)
    }
}
