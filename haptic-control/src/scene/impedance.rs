use crate::design_error::DesignError;
use crate::units::{NewtonMetres, RadPerS, Radians};

/// A spring and a damper: `torque = -K (θ - θ_0) - B ω`.
///
/// K in N·m/rad, B in N·m·s/rad, both at least zero.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Impedance {
    stiffness: f32,
    damping: f32,
}

impl Impedance {
    pub(super) const fn new(stiffness: f32, damping: f32) -> Result<Self, DesignError> {
        if super::is_gain(stiffness) && super::is_gain(damping) {
            Ok(Self { stiffness, damping })
        } else {
            Err(DesignError::Scene)
        }
    }

    /// Stiffness and damping.
    pub(super) const fn parameters(&self) -> [f32; 2] {
        [self.stiffness, self.damping]
    }

    /// The torque at an angle, with the spring's rest at `rest`.
    pub(super) fn torque(&self, rest: Radians, angle: Radians, velocity: RadPerS) -> NewtonMetres {
        let spring = self.stiffness * (angle.0 - rest.0);
        NewtonMetres(-spring - self.damping * velocity.0)
    }
}
