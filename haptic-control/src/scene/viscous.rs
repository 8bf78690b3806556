use estimator_core::Skip;

use super::environment::is_gain;
use super::{Handle, Scene};
use crate::design_error::DesignError;
use crate::need::Wanted;
use crate::tuning::parameters;
use crate::units::{NewtonMetres, RadPerS, Radians};

/// Viscous field: `torque = -B ω`, B in N·m·s/rad, at least zero.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Viscous {
    damping: f32,
}

impl Viscous {
    /// A field with this damping, N·m·s/rad.
    ///
    /// # Errors
    /// [`DesignError::Scene`] unless it is finite and at least zero.
    pub const fn new(damping: f32) -> Result<Self, DesignError> {
        if is_gain(damping) {
            Ok(Self { damping })
        } else {
            Err(DesignError::Scene)
        }
    }
}

parameters! { Viscous, |viscous, bounds, rate| {
    "damping" damping: Damping = viscous.damping;
} => Self::new(damping) }

impl Scene for Viscous {
    type Velocity = Wanted;
    type Acceleration = Skip;
    type Continuous = Wanted;
    type Transient = Wanted;
    type State = ();
    const FREE: bool = true;

    fn start(&self, _: Radians) {}

    fn torque(&self, (): &mut (), handle: &Handle<RadPerS>) -> NewtonMetres {
        NewtonMetres(-self.damping * handle.velocity.0)
    }
}
