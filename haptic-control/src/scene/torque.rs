use estimator_core::Skip;

use super::{Handle, Scene};
use crate::design_error::DesignError;
use crate::need::Wanted;
use crate::tuning::parameters;
use crate::units::{NewtonMetres, Radians};

/// A torque set-point, N·m, which does not depend on the handle's motion.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Torque {
    torque: f32,
}

impl Torque {
    /// A torque set-point.
    ///
    /// # Errors
    /// [`DesignError::Scene`] unless it is finite.
    pub const fn new(torque: f32) -> Result<Self, DesignError> {
        if torque.is_finite() {
            Ok(Self { torque })
        } else {
            Err(DesignError::Scene)
        }
    }
}

parameters! { Torque, |set_point, bounds, rate| {
    "torque" torque: Torque = set_point.torque;
} => Self::new(torque) }

impl Scene for Torque {
    type Velocity = Skip;
    type Acceleration = Skip;
    type Continuous = Wanted;
    type Transient = Wanted;
    type State = ();

    fn start(&self, _: Radians) {}

    fn torque(&self, (): &mut (), _: &Handle<()>) -> NewtonMetres {
        NewtonMetres(self.torque)
    }
}
