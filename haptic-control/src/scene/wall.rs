use estimator_core::Skip;

use super::impedance::Impedance;
use super::{Handle, Scene};
use crate::design_error::DesignError;
use crate::need::Wanted;
use crate::tuning::parameters;
use crate::units::{NewtonMetres, RadPerS, Radians};

/// Virtual wall: `torque = -K (θ - θ_w) - B ω` beyond the angle θ_w and 0 elsewhere. A torque that
/// would pull the handle into the wall is set to 0.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Wall {
    position: Radians,
    impedance: Impedance,
}

impl Wall {
    /// A wall at `position`: stiffness K, N·m/rad, and damping B, N·m·s/rad.
    ///
    /// # Errors
    /// [`DesignError::Scene`] unless all are finite, K and B at least zero.
    pub const fn new(position: Radians, stiffness: f32, damping: f32) -> Result<Self, DesignError> {
        match Impedance::new(stiffness, damping) {
            Ok(impedance) if position.0.is_finite() => Ok(Self {
                position,
                impedance,
            }),
            _ => Err(DesignError::Scene),
        }
    }
}

parameters! { Wall, |wall, bounds, rate| {
    "position" position: Angle = wall.position.0;
    "stiffness" stiffness: Stiffness = wall.impedance.stiffness;
    "damping" damping: Damping = wall.impedance.damping;
} => Self::new(Radians(position), stiffness, damping) }

impl Scene for Wall {
    type Velocity = Wanted;
    type Acceleration = Skip;
    type Continuous = Wanted;
    type Transient = Wanted;
    type State = ();

    fn start(&self, _: Radians) {}

    fn torque(&self, (): &mut (), handle: &Handle<RadPerS>) -> NewtonMetres {
        if handle.angle <= self.position {
            return NewtonMetres(0.0);
        }
        let push = self
            .impedance
            .torque(self.position, handle.angle, handle.velocity);
        if push.0 < 0.0 {
            push
        } else {
            NewtonMetres(0.0)
        }
    }
}
