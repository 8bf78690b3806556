use estimator_core::Skip;

use super::{Handle, Scene};
use crate::units::{NewtonMetres, Radians};

/// Nothing: both motors without current, nothing estimated.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Off;

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
