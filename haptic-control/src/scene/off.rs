use estimator_core::Skip;

use super::{Handle, Scene};
use crate::tuning::parameters;
use crate::units::{NewtonMetres, Radians};

/// No torque: both motors are without current, and no velocity is estimated.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Off;

parameters! { Off }

impl Scene for Off {
    type Velocity = Skip;
    type Acceleration = Skip;
    type Continuous = Skip;
    type Transient = Skip;
    type State = ();

    fn start(&self, _: Radians) {}

    fn torque(&self, (): &mut (), _: &Handle<()>) -> NewtonMetres {
        NewtonMetres(0.0)
    }
}
