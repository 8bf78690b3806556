use super::{Handle, Scene};
use crate::design_error::DesignError;
use crate::need::Wanted;
use crate::units::{NewtonMetres, RadPerS, Radians};

/// Virtual wall: beyond an angle, `torque = -K (θ - θ_w) - B ω`, and never a pull.
///
/// K in N·m/rad, B in N·m·s/rad, both at least zero.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Wall {
    position: Radians,
    stiffness: f32,
    damping: f32,
}

impl Wall {
    /// A wall at `position`.
    ///
    /// # Errors
    /// [`DesignError::Scene`] unless all are finite, K and B at least zero.
    pub const fn new(position: Radians, stiffness: f32, damping: f32) -> Result<Self, DesignError> {
        if position.0.is_finite() && super::is_gain(stiffness) && super::is_gain(damping) {
            Ok(Self {
                position,
                stiffness,
                damping,
            })
        } else {
            Err(DesignError::Scene)
        }
    }
}

impl Scene for Wall {
    type Velocity = Wanted;
    type Continuous = Wanted;
    type Transient = Wanted;
    type State = ();

    fn start(&self, _: Radians) {}

    fn torque(&self, (): &mut (), handle: &Handle<RadPerS>) -> NewtonMetres {
        let depth = handle.angle.0 - self.position.0;
        if depth <= 0.0 {
            return NewtonMetres(0.0);
        }
        let push = self.stiffness * depth + self.damping * handle.velocity.0;
        NewtonMetres(if push > 0.0 { -push } else { 0.0 })
    }
}
