use estimator_core::Skip;

use super::impedance::Impedance;
use super::{Handle, Scene};
use crate::design_error::DesignError;
use crate::need::Wanted;
use crate::tuning::parameters;
use crate::units::{NewtonMetres, RadPerS, Radians};

/// Holds the handle at the angle at which the scene began: `torque = -K (θ - θ_start) - B ω`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hold {
    impedance: Impedance,
}

impl Hold {
    /// A hold of stiffness K, N·m/rad, and damping B, N·m·s/rad.
    ///
    /// # Errors
    /// [`DesignError::Scene`] unless both are finite and at least zero.
    pub const fn new(stiffness: f32, damping: f32) -> Result<Self, DesignError> {
        match Impedance::new(stiffness, damping) {
            Ok(impedance) => Ok(Self { impedance }),
            Err(error) => Err(error),
        }
    }
}

parameters! { Hold, |hold, bounds, rate| {
    "stiffness" stiffness: Stiffness = hold.impedance.stiffness;
    "damping" damping: Damping = hold.impedance.damping;
} => Self::new(stiffness, damping) }

impl Scene for Hold {
    type Velocity = Wanted;
    type Acceleration = Skip;
    type Continuous = Wanted;
    type Transient = Wanted;
    /// The angle at which the scene began.
    type State = Radians;

    fn start(&self, angle: Radians) -> Radians {
        angle
    }

    fn torque(&self, start: &mut Radians, handle: &Handle<RadPerS>) -> NewtonMetres {
        self.impedance.torque(*start, handle.angle, handle.velocity)
    }
}
