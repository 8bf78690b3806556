//! What is switched off.

use estimator_core::Hertz;
use haptic_control::SceneKind;
use simulation::device::Device;

use crate::closed_loop::{Exact, Oracle};

/// Share of the handle's inertia that is left without it. The plant cannot integrate a handle without
/// inertia.
const INERTIA_LEFT: f64 = 0.1;

/// Bandwidth of an amplifier without lag: its time constant is below the plant's step.
const NO_LAG: Hertz = Hertz(100e3);

/// Causes that are switched off together.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Without {
    /// Coulomb friction of the small motor.
    SmallFriction,
    /// Coulomb friction of the large motor.
    LargeFriction,
    /// Nine tenths of the handle's inertia.
    Inertia,
    /// Torque ripple of both motors.
    Ripple,
    /// Lag of both amplifiers.
    AmplifierLag,
    /// Rounding of both currents.
    Dac,
    /// Error of the large motor's velocity: the loop has the true one.
    EstimationError,
    /// Friction of the small motor, and nine tenths of the inertia.
    FrictionAndInertia,
    /// Friction of the small motor, nine tenths of the inertia, and the estimation error.
    FrictionInertiaAndError,
    /// All of them.
    Everything,
    /// Errors of the velocities of both motors and of the acceleration of the handle: the controller has the
    /// true ones.
    BothErrors,
    /// All but the inertia of the handle: [`Oracle::InertiaLeft`].
    AllButInertia,
    /// All but what the hand changes until the next tick: [`Oracle::Present`].
    AllButFuture,
    /// All but DAC and limits: [`Oracle::NextTick`].
    AllButLimits,
}

impl Without {
    /// Knowledge that no controller of a board has, for the bounds of the force. The device and the converters
    /// stay as they are.
    pub const BOUNDS: [Self; 4] = [
        Self::BothErrors,
        Self::AllButInertia,
        Self::AllButFuture,
        Self::AllButLimits,
    ];

    /// All causes, in the order of tables.
    pub const ALL: [Self; 10] = [
        Self::SmallFriction,
        Self::LargeFriction,
        Self::Inertia,
        Self::Ripple,
        Self::AmplifierLag,
        Self::Dac,
        Self::EstimationError,
        Self::FrictionAndInertia,
        Self::FrictionInertiaAndError,
        Self::Everything,
    ];

    /// Name in tables and files.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::SmallFriction => "friction of the small motor",
            Self::LargeFriction => "friction of the large motor",
            Self::Inertia => "9/10 of the handle's inertia",
            Self::Ripple => "torque ripple",
            Self::AmplifierLag => "amplifier lag",
            Self::Dac => "DAC steps",
            Self::EstimationError => "estimation error",
            Self::FrictionAndInertia => "small friction, inertia",
            Self::FrictionInertiaAndError => "small friction, inertia, error",
            Self::Everything => "all of them",
            Self::BothErrors => "errors of both velocities",
            Self::AllButInertia => "all but inertia",
            Self::AllButFuture => "all but the future",
            Self::AllButLimits => "all but DAC and limits",
        }
    }

    /// The device without these causes.
    #[must_use]
    pub fn of(self, device: &Device) -> Device {
        let mut device = device.clone();
        if self.removes(&[
            Self::SmallFriction,
            Self::FrictionAndInertia,
            Self::FrictionInertiaAndError,
        ]) {
            device.stages.small.coulomb_friction = 0.0;
        }
        if self.removes(&[Self::LargeFriction]) {
            device.stages.large.coulomb_friction = 0.0;
        }
        if self.removes(&[
            Self::Inertia,
            Self::FrictionAndInertia,
            Self::FrictionInertiaAndError,
        ]) {
            device.stages.small.inertia *= INERTIA_LEFT;
        }
        if self.removes(&[Self::Ripple]) {
            device.large_ripple.torque = 0.0;
            device.small_ripple.torque = 0.0;
        }
        if self.removes(&[Self::AmplifierLag]) {
            device.stages.amplifier_bandwidth = NO_LAG;
        }
        device
    }

    /// Whether the currents are not rounded.
    #[must_use]
    pub(crate) fn removes_dac(&self) -> bool {
        self.removes(&[Self::Dac])
    }

    /// The velocities that the loop has without error.
    #[must_use]
    pub fn exact(self) -> Exact {
        if Self::BOUNDS.contains(&self) {
            Exact::Both
        } else if self.removes(&[Self::EstimationError, Self::FrictionInertiaAndError]) {
            Exact::Large
        } else {
            Exact::Neither
        }
    }

    /// What commands the small motor in the place of the controller.
    #[must_use]
    pub const fn oracle(self) -> Option<Oracle> {
        match self {
            Self::AllButInertia => Some(Oracle::InertiaLeft),
            Self::AllButFuture => Some(Oracle::Present),
            Self::AllButLimits => Some(Oracle::NextTick),
            _ => None,
        }
    }

    /// Whether a scene can be run so. An oracle commands the small motor, which a scene may not have. In a
    /// scene that reads the acceleration the current itself changes the torque that the oracle is to reach,
    /// and currents that reach it at every tick grow without bound.
    #[must_use]
    pub(crate) fn is_possible_in(self, scene: SceneKind) -> bool {
        let needs = scene.facts().needs;
        match self.oracle() {
            None => true,
            Some(Oracle::InertiaLeft) => needs.transient,
            Some(Oracle::Present | Oracle::NextTick) => needs.transient && !needs.acceleration,
        }
    }

    /// Whether this is one of `those`, or everything.
    fn removes(self, those: &[Self]) -> bool {
        self == Self::Everything || those.contains(&self)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Frictions, inertia and ripples of both motors, and the bandwidth of the amplifiers, as parts of those of
    /// the default device.
    fn parts(without: Without) -> [f64; 6] {
        let values = |device: &Device| {
            [
                device.stages.large.coulomb_friction,
                device.stages.small.coulomb_friction,
                device.stages.small.inertia,
                device.large_ripple.torque,
                device.small_ripple.torque,
                device.stages.amplifier_bandwidth.0,
            ]
        };
        let device = Device::default();
        let [all, left] = [values(&device), values(&without.of(&device))];
        assert!(all.iter().all(|value| *value > 0.0));
        std::array::from_fn(|n| left[n] / all[n])
    }

    #[test]
    fn each_cause_is_removed_from_the_device_alone() {
        let fast = 100e3 / Device::default().stages.amplifier_bandwidth.0;
        let whole = [1.0; 6];
        for (without, expected) in [
            (Without::LargeFriction, [0.0, 1.0, 1.0, 1.0, 1.0, 1.0]),
            (Without::SmallFriction, [1.0, 0.0, 1.0, 1.0, 1.0, 1.0]),
            (Without::Inertia, [1.0, 1.0, 0.1, 1.0, 1.0, 1.0]),
            (Without::Ripple, [1.0, 1.0, 1.0, 0.0, 0.0, 1.0]),
            (Without::AmplifierLag, [1.0, 1.0, 1.0, 1.0, 1.0, fast]),
            (Without::FrictionAndInertia, [1.0, 0.0, 0.1, 1.0, 1.0, 1.0]),
            (Without::Everything, [0.0, 0.0, 0.1, 0.0, 0.0, fast]),
            (Without::Dac, whole),
            (Without::EstimationError, whole),
            (Without::AllButLimits, whole),
        ] {
            let found = parts(without);
            let is_near = |(a, b): (&f64, f64)| (a - b).abs() < 1e-12;
            assert!(
                found.iter().zip(expected).all(is_near),
                "{}: {found:?}",
                without.name()
            );
        }
    }
}
