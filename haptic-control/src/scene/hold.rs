use super::{Handle, Scene};
use crate::design_error::DesignError;
use crate::need::Wanted;
use crate::units::{NewtonMetres, RadPerS, Radians};

/// Holds the handle where it was when the scene began: `torque = -K (θ - θ_start) - B ω`.
///
/// K in N·m/rad, B in N·m·s/rad, both at least zero.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hold {
    stiffness: f32,
    damping: f32,
}

impl Hold {
    /// A hold of that stiffness and damping.
    ///
    /// # Errors
    /// [`DesignError::Scene`] unless both are finite and at least zero.
    pub const fn new(stiffness: f32, damping: f32) -> Result<Self, DesignError> {
        if super::is_gain(stiffness) && super::is_gain(damping) {
            Ok(Self { stiffness, damping })
        } else {
            Err(DesignError::Scene)
        }
    }
}

impl Scene for Hold {
    type Velocity = Wanted;
    type Continuous = Wanted;
    type Transient = Wanted;
    /// Where it began.
    type State = Radians;

    fn start(&self, angle: Radians) -> Radians {
        angle
    }

    fn torque(&self, start: &mut Radians, handle: &Handle<RadPerS>) -> NewtonMetres {
        let spring = self.stiffness * (handle.angle.0 - start.0);
        NewtonMetres(-spring - self.damping * handle.velocity.0)
    }
}
