//! The constants of a motor and its encoder.

use crate::design::DesignError;

/// Constants of the motor whose velocity is estimated, and of its encoder. SI units.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MotorModel {
    /// Counts per revolution: four times the encoder's lines.
    pub counts_per_rev: u32,
    /// Inertia J that the motor turns, kg·m².
    pub inertia: f64,
    /// Viscous damping b, N·m·s/rad: of the bearing and of the coupling to another shaft.
    pub damping: f64,
    /// Torque constant Kt, N·m/A.
    pub torque_constant: f64,
}

impl MotorModel {
    /// Maxon DCX35L GB KL 36 V with 1024 lines on the paper's coupler.
    ///
    /// `damping` is the paper's Table I; inertia and torque constant are working values from
    /// the catalogue, assumed good to 15 %.
    pub const DCX35L: Self = Self {
        counts_per_rev: 4 * 1024,
        inertia: 115e-7,
        damping: 0.96e-3,
        torque_constant: 46.8e-3,
    };

    /// This model, if every constant is in its range: all finite, the damping at least zero, the
    /// others above zero.
    ///
    /// # Errors
    /// [`DesignError::COUNTS_PER_REV`], [`DesignError::INERTIA`], [`DesignError::DAMPING`],
    /// [`DesignError::TORQUE_CONSTANT`].
    pub const fn checked(self) -> Result<Self, DesignError> {
        if self.counts_per_rev == 0 {
            return Err(DesignError::COUNTS_PER_REV);
        }
        if !(self.inertia > 0.0 && self.inertia.is_finite()) {
            return Err(DesignError::INERTIA);
        }
        if !(self.damping >= 0.0 && self.damping.is_finite()) {
            return Err(DesignError::DAMPING);
        }
        if !(self.torque_constant > 0.0 && self.torque_constant.is_finite()) {
            return Err(DesignError::TORQUE_CONSTANT);
        }
        Ok(self)
    }
}
