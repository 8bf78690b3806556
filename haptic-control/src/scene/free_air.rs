use estimator_core::Skip;

use super::{Handle, Scene};
use crate::need::Wanted;
use crate::units::{NewtonMetres, Radians};

/// Free air: the handle should feel nothing, so the large motor follows it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct FreeAir;

impl Scene for FreeAir {
    type Velocity = Skip;
    type Acceleration = Skip;
    type Continuous = Wanted;
    type Transient = Wanted;
    type State = ();

    fn start(&self, _: Radians) {}

    fn torque(&self, (): &mut (), _: &Handle<()>) -> NewtonMetres {
        NewtonMetres(0.0)
    }
}
