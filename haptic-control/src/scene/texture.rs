use estimator_core::{Hertz, Skip};

use super::environment::is_gain;
use super::sine::sine;
use super::{Handle, Scene};
use crate::design_error::DesignError;
use crate::need::Wanted;
use crate::tuning::parameters;
use crate::units::{NewtonMetres, Radians};

/// Texture: a vibration of 50 to 300 Hz, `torque = A sin(2π f t)`.
///
/// The small motor alone renders it, so the controller has neither a velocity estimator nor the
/// large motor's loop. The phase is an integer that wraps once a period, so it never drifts.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Texture {
    amplitude: f32,
    /// Phase per tick, in 2^-32 of a period.
    step: u32,
}

impl Texture {
    /// A vibration of `amplitude` N·m at `frequency`, in a controller that runs at `rate`.
    ///
    /// # Errors
    /// [`DesignError::Scene`] unless the amplitude is finite and at least zero and the frequency
    /// 50 to 300 Hz and at most half the rate.
    pub const fn new(amplitude: f32, frequency: Hertz, rate: Hertz) -> Result<Self, DesignError> {
        let in_band = frequency.0 >= 50.0 && frequency.0 <= 300.0 && frequency.0 <= rate.0 / 2.0;
        if is_gain(amplitude) && in_band && rate.0 <= 100e3 {
            Ok(Self {
                amplitude,
                step: (frequency.0 / rate.0 * PHASE_PER_PERIOD) as u32,
            })
        } else {
            Err(DesignError::Scene)
        }
    }

    /// Frequency in a controller that runs at `rate`, a whole number of Hz, to 2^-16 Hz.
    fn frequency(&self, rate: Hertz) -> f32 {
        let product = u64::from(self.step) * u64::from(rate.0 as u32);
        ((product + (1 << 15)) >> 16) as u32 as f32 / 65_536.0
    }
}

/// A phase of 2^32 is one period.
const PHASE_PER_PERIOD: f64 = 4_294_967_296.0;

parameters! { Texture, |texture, bounds, rate| {
    "amplitude" amplitude: Amplitude = texture.amplitude;
    "frequency" frequency: Frequency = texture.frequency(rate);
} => match frequency == texture.frequency(rate) {
    // The step keeps all its bits.
    true => Ok(Self { amplitude, ..*texture }),
    false => Self::new(amplitude, Hertz(f64::from(frequency)), rate),
}}

impl Scene for Texture {
    type Velocity = Skip;
    type Acceleration = Skip;
    type Continuous = Skip;
    type Transient = Wanted;
    /// Phase, in 2^-32 of a period.
    type State = u32;

    fn start(&self, _: Radians) -> u32 {
        0
    }

    fn torque(&self, phase: &mut u32, _: &Handle<()>) -> NewtonMetres {
        *phase = phase.wrapping_add(self.step);
        NewtonMetres(self.amplitude * sine(*phase as i32 as f32 / 2_147_483_648.0))
    }
    fn vibration(&self) -> NewtonMetres {
        NewtonMetres(self.amplitude)
    }
}
