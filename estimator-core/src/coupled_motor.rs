//! The large motor and what acts on it, from which observers are built.

use crate::design_error::DesignError;
use crate::device::Device;
use crate::units::Hertz;

/// The large motor with what acts on it besides its current: friction, the amplifier's lag and,
/// through the coupler, the handle. SI units.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CoupledMotor {
    /// The large motor and its encoder.
    pub large: Device,
    /// Coulomb friction of the large motor, N·m; 0 for a motor without.
    pub coulomb_friction: f64,
    /// Time constant of the large motor's amplifier, s; 0 for one that follows at once.
    pub amplifier_lag: f64,
    /// Counts per revolution of the small motor's encoder: four times its lines.
    pub small_counts_per_rev: u32,
}

impl CoupledMotor {
    /// The paper's device: [`Device::DCX35L`], and a DCX22S GB KL 36 V with 5000 lines.
    ///
    /// Friction and lag are assumed: a public model of the same motor, an amplifier of 2 kHz.
    pub const DCX35L: Self = Self {
        large: Device::DCX35L,
        coulomb_friction: 4.0e-3,
        amplifier_lag: 1.0 / (2.0 * core::f64::consts::PI * 2000.0),
        small_counts_per_rev: 4 * 5000,
    };

    /// The device itself, if every constant is in its range at this rate.
    ///
    /// # Errors
    /// [`DesignError::RATE`]; the errors of [`Device::checked`]; [`DesignError::COULOMB_FRICTION`],
    /// [`DesignError::AMPLIFIER_LAG`], [`DesignError::SMALL_COUNTS_PER_REV`];
    /// [`DesignError::RATE_FOR_DAMPING`], [`DesignError::RATE_FOR_CURRENT`],
    /// [`DesignError::RATE_FOR_FRICTION`] if damping, an ampere or the friction moves the motor too far
    /// in a tick.
    pub(crate) const fn checked(self, rate: Hertz) -> Result<Self, DesignError> {
        if !rate.is_positive() {
            return Err(DesignError::RATE);
        }
        let large = match self.large.checked() {
            Ok(large) => large,
            Err(error) => return Err(error),
        };
        if !(self.coulomb_friction >= 0.0 && self.coulomb_friction.is_finite()) {
            return Err(DesignError::COULOMB_FRICTION);
        }
        let lag = self.amplifier_lag * rate.0;
        if !(lag >= 0.0 && lag < 1e6) {
            return Err(DesignError::AMPLIFIER_LAG);
        }
        if self.small_counts_per_rev == 0 {
            return Err(DesignError::SMALL_COUNTS_PER_REV);
        }
        let square = rate.period_s() * rate.period_s();
        let counts = large.counts_per_rev as f64;
        let moved = counts * large.torque_constant * square / large.inertia;
        let braked = counts * self.coulomb_friction * square / large.inertia;
        let damped = large.damping * rate.period_s() / large.inertia;
        if !(moved > 0.0 && moved < 1e6) {
            return Err(DesignError::RATE_FOR_CURRENT);
        }
        if !(braked < 1e6) {
            return Err(DesignError::RATE_FOR_FRICTION);
        }
        if !(damped < 8.0) {
            return Err(DesignError::RATE_FOR_DAMPING);
        }
        Ok(self)
    }
}
