use estimator_core::Skip;

use super::{Handle, Scene, sine};
use crate::design_error::DesignError;
use crate::need::Wanted;
use crate::units::{NewtonMetres, Radians};

/// Detents: `torque = -A sin(n θ)`, a rest at every n-th of a turn.
///
/// Knows the handle's position only and renders with the small motor alone, so it holds no
/// velocity estimator. A in N·m, at least zero; n from 1 to 1000.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Detents {
    amplitude: f32,
    /// Half periods of the sine per radian.
    half_periods_per_rad: f32,
}

impl Detents {
    /// `per_rev` detents a turn of `amplitude`.
    ///
    /// # Errors
    /// [`DesignError::Scene`] out of range.
    pub const fn new(amplitude: f32, per_rev: u16) -> Result<Self, DesignError> {
        if super::is_gain(amplitude) && per_rev >= 1 && per_rev <= 1000 {
            Ok(Self {
                amplitude,
                half_periods_per_rad: per_rev as f32 / core::f32::consts::PI,
            })
        } else {
            Err(DesignError::Scene)
        }
    }

    /// Amplitude, and detents a turn to the nearest whole number.
    pub(crate) const fn parameters(&self) -> (f32, f32) {
        let per_rev = self.half_periods_per_rad * core::f32::consts::PI + 0.5;
        (self.amplitude, per_rev as u16 as f32)
    }
}

impl Scene for Detents {
    type Velocity = Skip;
    type Acceleration = Skip;
    type Continuous = Skip;
    type Transient = Wanted;
    type State = ();

    fn start(&self, _: Radians) {}

    fn torque(&self, (): &mut (), handle: &Handle<()>) -> NewtonMetres {
        let half_periods = handle.angle.0 * self.half_periods_per_rad;
        // Into [-1, 1] by whole periods; the cast saturates, far beyond any handle's turns.
        let nearest = if half_periods < 0.0 {
            half_periods - 1.0
        } else {
            half_periods + 1.0
        };
        let phase = half_periods - 2.0 * (nearest * 0.5) as i32 as f32;
        NewtonMetres(-self.amplitude * sine(phase))
    }
}
