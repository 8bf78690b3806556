use estimator_core::Skip;

use super::impedance::Impedance;
use super::{Handle, Scene};
use crate::design_error::DesignError;
use crate::need::Wanted;
use crate::tuning::parameters;
use crate::units::{NewtonMetres, RadPerS, Radians};

/// Spring and damper to an angle: `torque = -K (θ - θ_0) - B ω`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SpringDamper {
    centre: Radians,
    impedance: Impedance,
}

impl SpringDamper {
    /// A spring whose torque is zero at `centre`: stiffness K, N·m/rad, and damping B,
    /// N·m·s/rad.
    ///
    /// # Errors
    /// [`DesignError::Scene`] unless all are finite, K and B at least zero.
    pub const fn new(centre: Radians, stiffness: f32, damping: f32) -> Result<Self, DesignError> {
        match Impedance::new(stiffness, damping) {
            Ok(impedance) if centre.0.is_finite() => Ok(Self { centre, impedance }),
            _ => Err(DesignError::Scene),
        }
    }
}

parameters! { SpringDamper, |spring, bounds, rate| {
    "centre" centre: Angle = spring.centre.0;
    "stiffness" stiffness: Stiffness = spring.impedance.stiffness;
    "damping" damping: Damping = spring.impedance.damping;
} => Self::new(Radians(centre), stiffness, damping) }

impl Scene for SpringDamper {
    type Velocity = Wanted;
    type Acceleration = Skip;
    type Continuous = Wanted;
    type Transient = Wanted;
    type State = ();

    fn start(&self, _: Radians) {}

    fn torque(&self, (): &mut (), handle: &Handle<RadPerS>) -> NewtonMetres {
        self.impedance
            .torque(self.centre, handle.angle, handle.velocity)
    }
}
