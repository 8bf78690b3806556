use estimator_core::{Hertz, Skip};

use super::{Handle, Scene, sine};
use crate::design_error::DesignError;
use crate::need::Wanted;
use crate::units::{NewtonMetres, Radians};

/// Texture: a vibration of 50 to 300 Hz, `torque = A sin(2π f t)`.
///
/// Rendered with the small motor alone, so it holds neither a velocity estimator nor the large
/// motor's loop. The phase is an integer that wraps once a period, so it never drifts.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Texture {
    amplitude: f32,
    /// 2^-32 of a period a tick.
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
        if super::is_gain(amplitude) && in_band && rate.0 <= 100e3 {
            Ok(Self {
                amplitude,
                step: (frequency.0 / rate.0 * 4_294_967_296.0) as u32,
            })
        } else {
            Err(DesignError::Scene)
        }
    }

    /// Amplitude.
    pub(crate) const fn amplitude(&self) -> f32 {
        self.amplitude
    }

    /// The same vibration with another amplitude.
    pub(crate) const fn with_amplitude(self, amplitude: f32) -> Self {
        Self { amplitude, ..self }
    }
}

impl Scene for Texture {
    type Velocity = Skip;
    type Acceleration = Skip;
    type Continuous = Skip;
    type Transient = Wanted;
    /// Phase, 2^-32 of a period.
    type State = u32;

    fn start(&self, _: Radians) -> u32 {
        0
    }

    fn torque(&self, phase: &mut u32, _: &Handle<()>) -> NewtonMetres {
        *phase = phase.wrapping_add(self.step);
        NewtonMetres(self.amplitude * sine(*phase as i32 as f32 / 2_147_483_648.0))
    }
}
