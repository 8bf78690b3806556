use estimator_core::Skip;

use super::{Handle, Scene};
use crate::need::Wanted;
use crate::tuning::parameters;
use crate::units::{NewtonMetres, Radians};

/// Free air: the torque on the handle is zero. The large motor follows the handle, so that the
/// coupler does not slip.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct FreeAir;

parameters! { FreeAir }

impl Scene for FreeAir {
    type Velocity = Skip;
    type Acceleration = Skip;
    type Continuous = Wanted;
    type Transient = Wanted;
    type State = ();
    const FREE: bool = true;

    fn start(&self, _: Radians) {}

    fn torque(&self, (): &mut (), _: &Handle<()>) -> NewtonMetres {
        NewtonMetres(0.0)
    }
}
