//! A motor that is coupled to a second shaft.

use crate::design::DesignError;
use crate::models::MotorModel;
use crate::units::Hertz;

/// Constants of a motor with Coulomb friction and an amplifier lag, coupled to a second shaft by
/// viscous damping. SI units. Observers are designed from it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CoupledMotor {
    /// The motor and its encoder; its damping is that of the coupling.
    pub motor: MotorModel,
    /// Coulomb friction of the motor, N·m; 0 for a motor without friction.
    pub coulomb_friction: f64,
    /// Time constant of the motor's current amplifier, s; 0 for an amplifier without lag.
    pub amplifier_lag: f64,
    /// Counts per revolution of the encoder on the coupled shaft: four times its lines.
    pub coupled_counts_per_rev: u32,
}

impl CoupledMotor {
    /// The paper's device: [`MotorModel::DCX35L`], coupled to a DCX22S GB KL 36 V with 5000 lines.
    ///
    /// Friction and lag are assumed: the friction is that of a public model of the same motor, the
    /// amplifier has a bandwidth of 2 kHz.
    pub const DCX35L: Self = Self {
        motor: MotorModel::DCX35L,
        coulomb_friction: 4.0e-3,
        amplifier_lag: 1.0 / (2.0 * core::f64::consts::PI * 2000.0),
        coupled_counts_per_rev: 4 * 5000,
    };

    /// This motor, if every constant is in its range at this rate.
    ///
    /// # Errors
    /// [`DesignError::RATE`]; the errors of [`MotorModel::checked`];
    /// [`DesignError::COULOMB_FRICTION`], [`DesignError::AMPLIFIER_LAG`],
    /// [`DesignError::COUPLED_COUNTS_PER_REV`]; [`DesignError::RATE_FOR_DAMPING`],
    /// [`DesignError::RATE_FOR_CURRENT`], [`DesignError::RATE_FOR_FRICTION`] if damping, an ampere
    /// or the friction moves the motor too far in a tick.
    pub(crate) const fn checked(self, rate: Hertz) -> Result<Self, DesignError> {
        if !rate.is_positive() {
            return Err(DesignError::RATE);
        }
        let motor = match self.motor.checked() {
            Ok(motor) => motor,
            Err(error) => return Err(error),
        };
        if !(self.coulomb_friction >= 0.0 && self.coulomb_friction.is_finite()) {
            return Err(DesignError::COULOMB_FRICTION);
        }
        let lag = self.amplifier_lag * rate.0;
        if !(lag >= 0.0 && lag < 1e6) {
            return Err(DesignError::AMPLIFIER_LAG);
        }
        if self.coupled_counts_per_rev == 0 {
            return Err(DesignError::COUPLED_COUNTS_PER_REV);
        }
        let square = rate.period_s() * rate.period_s();
        let counts = motor.counts_per_rev as f64;
        let moved = counts * motor.torque_constant * square / motor.inertia;
        let braked = counts * self.coulomb_friction * square / motor.inertia;
        let damped = motor.damping * rate.period_s() / motor.inertia;
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
