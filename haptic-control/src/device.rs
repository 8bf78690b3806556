//! The description of the device that controllers and estimators are designed from.

use core::f64::consts::PI;

use estimator_core::{CoupledMotor, Hertz, MotorModel};

use crate::design_error::DesignError;
use crate::fingerprint::Fingerprint;

/// A motor with its encoder and amplifier. SI units.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Motor {
    /// Inertia J of everything on the shaft, kg·m².
    pub inertia: f64,
    /// Torque constant Kt, N·m/A.
    pub torque_constant: f64,
    /// Coulomb friction Tc, N·m. Static friction has the same value.
    pub coulomb_friction: f64,
    /// Counts per revolution: four times the encoder's lines.
    pub counts_per_rev: u32,
    /// Largest current, A.
    pub current_limit: f64,
    /// Nominal current of the data sheet: the largest one that the winding carries for ever, A.
    pub continuous_current: f64,
    /// Thermal time constant of the winding, s.
    pub winding_time_constant: f64,
}

/// Both stages and the coupler between them. SI units.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DualStage {
    /// Large motor, the continuous stage.
    pub large: Motor,
    /// Small motor on the handle, the transient stage.
    pub small: Motor,
    /// Damping b of the coupler, N·m·s/rad.
    pub damping: f64,
    /// Bandwidth of both current amplifiers, first order.
    pub amplifier_bandwidth: Hertz,
}

impl DualStage {
    /// The paper's device: DCX35L with 1024 lines, DCX22S with 5000, b = 0.96 mN·m·s/rad.
    ///
    /// Damping and lines are the paper's; inertias, torque constants, friction and amplifiers
    /// are working values, assumed good to 15 %. The continuous currents are the nominal torques of
    /// these motors, 125 and 14.9 mN·m in published copies of their data sheets for other windings,
    /// divided by the torque constants. The thermal time constants are assumed: that of a DC-max 22 S
    /// (14.3 s), and one between those of an RE 30 (16.9 s) and an RE 40 (41.5 s).
    pub const DEFAULT: Self = Self {
        large: Motor {
            inertia: CoupledMotor::DCX35L.motor.inertia,
            torque_constant: CoupledMotor::DCX35L.motor.torque_constant,
            coulomb_friction: CoupledMotor::DCX35L.coulomb_friction,
            counts_per_rev: CoupledMotor::DCX35L.motor.counts_per_rev,
            current_limit: 6.0,
            continuous_current: 2.67,
            winding_time_constant: 30.0,
        },
        small: Motor {
            inertia: 50e-7,
            torque_constant: 27.5e-3,
            coulomb_friction: 0.8e-3,
            counts_per_rev: CoupledMotor::DCX35L.coupled_counts_per_rev,
            current_limit: 1.5,
            continuous_current: 0.54,
            winding_time_constant: 14.0,
        },
        damping: CoupledMotor::DCX35L.motor.damping,
        amplifier_bandwidth: Hertz(1.0 / (2.0 * PI * CoupledMotor::DCX35L.amplifier_lag)),
    };

    /// Time constant of both current amplifiers, s.
    #[must_use]
    pub const fn amplifier_lag(&self) -> f64 {
        1.0 / (2.0 * PI * self.amplifier_bandwidth.0)
    }

    /// The large motor with coupler and amplifier, the model of an observer.
    #[must_use]
    pub const fn coupled_motor(&self) -> CoupledMotor {
        CoupledMotor {
            motor: MotorModel {
                counts_per_rev: self.large.counts_per_rev,
                inertia: self.large.inertia,
                damping: self.damping,
                torque_constant: self.large.torque_constant,
            },
            coulomb_friction: self.large.coulomb_friction,
            amplifier_lag: self.amplifier_lag(),
            coupled_counts_per_rev: self.small.counts_per_rev,
        }
    }

    /// Hash of all constants, equal for equal devices on every machine. An image logs the hash at
    /// boot, so that a recording identifies the device for which the image was built.
    #[must_use]
    pub const fn fingerprint(&self) -> Fingerprint {
        self.small
            .hashed(self.large.hashed(Fingerprint::EMPTY))
            .number(self.damping)
            .number(self.amplifier_bandwidth.0)
    }

    /// The device itself, if every constant is in its range.
    ///
    /// # Errors
    /// [`DesignError::Device`].
    pub const fn checked(self) -> Result<Self, DesignError> {
        if self.large.is_possible()
            && self.small.is_possible()
            && is_positive(self.damping)
            && is_positive(self.amplifier_bandwidth.0)
        {
            Ok(self)
        } else {
            Err(DesignError::Device)
        }
    }
}

impl Motor {
    const fn hashed(&self, hash: Fingerprint) -> Fingerprint {
        hash.number(self.inertia)
            .number(self.torque_constant)
            .number(self.coulomb_friction)
            .number(self.counts_per_rev as f64)
            .number(self.current_limit)
            .number(self.continuous_current)
            .number(self.winding_time_constant)
    }

    const fn is_possible(&self) -> bool {
        is_positive(self.inertia)
            && is_positive(self.torque_constant)
            && is_positive(self.current_limit)
            && is_positive(self.continuous_current)
            && is_positive(self.winding_time_constant)
            && self.coulomb_friction >= 0.0
            && self.coulomb_friction.is_finite()
            && self.counts_per_rev > 0
    }
}

const fn is_positive(x: f64) -> bool {
    x > 0.0 && x.is_finite()
}
