//! Errors of the device constants that an estimator uses.

use crate::estimators::Setup;

/// A constant of the device that estimators use.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Constant {
    /// Damping b of the coupler.
    Damping,
    /// Inertia J of the large motor.
    Inertia,
    /// Torque constant Kt of the large motor.
    TorqueConstant,
    /// Coulomb friction of the large motor.
    Friction,
}

impl Constant {
    /// All constants, in the order of tables.
    pub const ALL: [Self; 4] = [
        Self::Damping,
        Self::Inertia,
        Self::TorqueConstant,
        Self::Friction,
    ];

    /// Name in tables and files.
    #[must_use]
    pub const fn as_str(self) -> &'static str {
        match self {
            Self::Damping => "damping",
            Self::Inertia => "inertia",
            Self::TorqueConstant => "torque-constant",
            Self::Friction => "friction",
        }
    }

    /// Symbol in equations and headings.
    #[must_use]
    pub const fn symbol(self) -> &'static str {
        match self {
            Self::Damping => "b",
            Self::Inertia => "J",
            Self::TorqueConstant => "Kt",
            Self::Friction => "Tc",
        }
    }

    /// Largest relative error in sensitivity experiments. Friction is the least known constant.
    #[must_use]
    pub const fn largest_error(self) -> f64 {
        match self {
            Self::Friction => 0.5,
            _ => 0.3,
        }
    }
}

/// One wrong constant: an error of 0.3 means that its value is 30 % too large.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ConstantError {
    /// The constant.
    pub constant: Constant,
    /// Relative error.
    pub error: f64,
}

impl ConstantError {
    /// Every constant with its largest positive and negative error.
    #[must_use]
    pub fn extremes() -> Vec<Self> {
        Self::at(&[-1.0, 1.0])
    }

    /// Every constant with these fractions of its largest error.
    #[must_use]
    pub fn at(parts: &[f64]) -> Vec<Self> {
        let of = |constant: Constant| {
            parts.iter().map(move |part| Self {
                constant,
                error: part * constant.largest_error(),
            })
        };
        Constant::ALL.into_iter().flat_map(of).collect()
    }

    /// `setup` with the wrong constant.
    #[must_use]
    pub fn of(&self, setup: &Setup) -> Setup {
        let mut assumed = *setup;
        let value = match self.constant {
            Constant::Damping => &mut assumed.stages.damping,
            Constant::Inertia => &mut assumed.stages.large.inertia,
            Constant::TorqueConstant => &mut assumed.stages.large.torque_constant,
            Constant::Friction => &mut assumed.stages.large.coulomb_friction,
        };
        *value *= 1.0 + self.error;
        assumed
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn friction_has_the_largest_error() {
        let named = |errors: Vec<ConstantError>| -> Vec<_> {
            errors
                .iter()
                .map(|it| (it.constant.as_str(), it.error))
                .collect()
        };
        let extremes = named(ConstantError::extremes());
        assert_eq!(extremes[..2], [("damping", -0.3), ("damping", 0.3)]);
        assert_eq!(extremes[2..4], [("inertia", -0.3), ("inertia", 0.3)]);
        assert_eq!(
            extremes[4..6],
            [("torque-constant", -0.3), ("torque-constant", 0.3)]
        );
        assert_eq!(extremes[6..], [("friction", -0.5), ("friction", 0.5)]);
        let halves = named(ConstantError::at(&[0.5]));
        assert_eq!(halves[0], ("damping", 0.15));
        assert_eq!(halves[3], ("friction", 0.25));
    }

    #[test]
    fn error_changes_only_its_constant() {
        let device = simulation::device::Device::default();
        let setup = Setup::of(&device, 1000.0);
        let all = ConstantError::extremes();
        assert_eq!(all.len(), 8);
        for constant_error in all {
            let assumed = constant_error.of(&setup);
            let ratios = [
                assumed.stages.damping / setup.stages.damping,
                assumed.stages.large.inertia / setup.stages.large.inertia,
                assumed.stages.large.torque_constant / setup.stages.large.torque_constant,
                assumed.stages.large.coulomb_friction / setup.stages.large.coulomb_friction,
            ];
            for (constant, ratio) in Constant::ALL.into_iter().zip(ratios) {
                let meant = if constant == constant_error.constant {
                    1.0 + constant_error.error
                } else {
                    1.0
                };
                assert!((ratio - meant).abs() < 1e-12, "{constant_error:?}");
            }
        }
    }
}
