use super::{Handle, Scene};
use crate::design_error::DesignError;
use crate::need::Wanted;
use crate::units::{NewtonMetres, RadPerS, Radians};

/// Spring and damper to an angle: `torque = -K (θ - θ_0) - B ω`.
///
/// K in N·m/rad, B in N·m·s/rad, both at least zero.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SpringDamper {
    centre: Radians,
    stiffness: f32,
    damping: f32,
}

impl SpringDamper {
    /// A spring whose torque is zero at `centre`.
    ///
    /// # Errors
    /// [`DesignError::Scene`] unless all are finite, K and B at least zero.
    pub const fn new(centre: Radians, stiffness: f32, damping: f32) -> Result<Self, DesignError> {
        if centre.0.is_finite() && super::is_gain(stiffness) && super::is_gain(damping) {
            Ok(Self {
                centre,
                stiffness,
                damping,
            })
        } else {
            Err(DesignError::Scene)
        }
    }
}

impl Scene for SpringDamper {
    type Velocity = Wanted;
    type Continuous = Wanted;
    type Transient = Wanted;
    type State = ();

    fn start(&self, _: Radians) {}

    fn torque(&self, (): &mut (), handle: &Handle<RadPerS>) -> NewtonMetres {
        let spring = self.stiffness * (handle.angle.0 - self.centre.0);
        NewtonMetres(-spring - self.damping * handle.velocity.0)
    }
}
