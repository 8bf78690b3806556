use super::environment::is_gain;
use crate::design_error::DesignError;
use crate::units::{NewtonMetres, RadPerS, Radians};

/// A spring and a damper: `torque = -K (θ - θ_0) - B ω`.
///
/// K in N·m/rad, B in N·m·s/rad, both at least zero.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Impedance {
    pub(super) stiffness: f32,
    pub(super) damping: f32,
}

impl Impedance {
    pub(super) const fn new(stiffness: f32, damping: f32) -> Result<Self, DesignError> {
        if is_gain(stiffness) && is_gain(damping) {
            Ok(Self { stiffness, damping })
        } else {
            Err(DesignError::Scene)
        }
    }

    /// Torque at an angle; the spring's torque is zero at `rest`.
    pub(super) fn torque(&self, rest: Radians, angle: Radians, velocity: RadPerS) -> NewtonMetres {
        let spring = self.stiffness * (angle.0 - rest.0);
        NewtonMetres(-spring - self.damping * velocity.0)
    }
}
