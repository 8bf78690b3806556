use estimator_core::Skip;

use super::{Handle, Scene};
use crate::design_error::DesignError;
use crate::need::Wanted;
use crate::tuning::parameters;
use crate::units::{NewtonMetres, RadPerS2};

/// Virtual inertia: `torque = -M α`, with the handle's acceleration α.
///
/// A negative M reduces the inertia that the hand feels. The torque acts with a delay, so an |M|
/// above the handle's own inertia would be unstable. |M| is at most half of the handle's own
/// inertia.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Inertia {
    inertia: f32,
}

impl Inertia {
    /// Largest ratio of |M| to the handle's own inertia: with a torque constant 20 % high and an
    /// inertia 30 % low the loop's gain stays below 1 at every frequency, if the estimator's does.
    pub const LARGEST_PART: f32 = 0.5;

    /// An inertia M, kg·m², on a handle whose own is `handle`.
    ///
    /// # Errors
    /// [`DesignError::Scene`] unless both are finite, `handle` positive and |M| at most half of it.
    pub const fn new(inertia: f32, handle: f32) -> Result<Self, DesignError> {
        let magnitude = if inertia < 0.0 { -inertia } else { inertia };
        if handle > 0.0 && handle.is_finite() && magnitude <= Self::LARGEST_PART * handle {
            Ok(Self { inertia })
        } else {
            Err(DesignError::Scene)
        }
    }
}

parameters! { Inertia, |scene, bounds, rate| {
    "inertia" inertia: Inertia = scene.inertia;
} => Self::new(inertia, bounds.inertia) }

impl Scene for Inertia {
    type Velocity = Skip;
    type Acceleration = Wanted;
    type Continuous = Wanted;
    type Transient = Wanted;
    type State = ();

    fn start(&self, _: crate::units::Radians) {}

    fn torque(&self, (): &mut (), handle: &Handle<(), RadPerS2>) -> NewtonMetres {
        NewtonMetres(-self.inertia * handle.acceleration.0)
    }
}
