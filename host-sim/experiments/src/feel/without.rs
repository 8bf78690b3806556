//! What is switched off.

use estimator_core::Hertz;
use simulation::device::Device;

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
}

impl Without {
    /// All, in the order of tables.
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
    pub fn removes_dac(&self) -> bool {
        self.removes(&[Self::Dac])
    }

    /// Whether the loop has the true velocity.
    #[must_use]
    pub fn removes_estimation_error(&self) -> bool {
        self.removes(&[Self::EstimationError, Self::FrictionInertiaAndError])
    }

    /// Whether this is one of `those`, or everything.
    fn removes(self, those: &[Self]) -> bool {
        self == Self::Everything || those.contains(&self)
    }
}
