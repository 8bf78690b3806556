//! Why a set of parameters was refused.

use core::fmt;

/// Why a set of parameters was refused, at run time by `Err` or at compile time by [`preset!`].
///
/// An error names one parameter as the constructor or the field calls it, the requirement that the
/// value breaks, and the unit. All errors are constants of this type, so they can be compared and
/// matched.
///
/// ```
/// use estimator_core::{DesignError, Hertz, Pll};
/// let error = Pll::new(Hertz(600.0), Hertz(1000.0)).unwrap_err();
/// assert_eq!(error, DesignError::BANDWIDTH);
/// assert_eq!(error.parameter(), "bandwidth");
/// assert_eq!(error.unit(), "Hz");
/// assert_eq!(error.message(), "bandwidth must be between 1e-6 and 1/2 of the rate (Hz)");
/// ```
///
/// [`preset!`]: crate::preset
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct DesignError {
    parameter: &'static str,
    requirement: &'static str,
    unit: &'static str,
    message: &'static str,
}

/// Defines one constant an error: `NAME: "parameter", "requirement", "unit";`, without a unit for a
/// pure number.
macro_rules! errors {
    ($($name:ident: $parameter:literal, $requirement:literal $(, $unit:literal)?;)*) => {
        $(
            #[doc = concat!("`", $parameter, "` ", $requirement, $(" (", $unit, ")",)? ".")]
            pub const $name: Self = Self {
                parameter: $parameter,
                requirement: $requirement,
                unit: concat!($($unit)?),
                message: concat!($parameter, " ", $requirement $(, " (", $unit, ")")?),
            };
        )*

        /// Every error there is.
        pub const ALL: &'static [Self] = &[$(Self::$name),*];

        /// Names of the constants, in the order of [`DesignError::ALL`].
        pub const NAMES: &'static [&'static str] = &[$(stringify!($name)),*];
    };
}

/// The errors by parameter.
impl DesignError {
    errors! {
        RATE: "rate", "must be positive and finite", "Hz";
        RATE_FOR_DAMPING: "rate", "must be above damping / (8 inertia), for a Kalman filter \
            damping / (700 inertia)", "Hz";
        RATE_FOR_CURRENT: "rate", "must give counts_per_rev torque_constant / (inertia rate^2) \
            above 0 and below 10^6, for a Kalman filter 2 pi 10^9 (counts/A)", "Hz";
        RATE_FOR_FRICTION: "rate", "must give counts_per_rev coulomb_friction / (inertia rate^2) \
            below 10^6 counts", "Hz";
        RATE_OF_BANK: "rate", "must be between 100 and 1e5", "Hz";
        CLOCK: "clock", "must be finite and at least the rate", "Hz";
        CUTOFF: "cutoff", "must be between 1e-6 and 1/2 of the rate", "Hz";
        BANDWIDTH: "bandwidth", "must be between 1e-6 and 1/2 of the rate", "Hz";
        ACCELERATION: "acceleration", "must give counts_per_rev acceleration / (2 pi rate^2) from \
            1e-12 to 1e6 counts/tick^2", "rad/s^2";
        FILTER_TIME: "filter_time", "must be above 0 and at most 10^4 ticks", "s";
        WINDOW: "window", "must be between 1 and N", "intervals";
        BOUND: "bound", "must be at most 2^14", "counts";
        SETTLE: "settle", "must be below 2^15", "ticks";
        FADE: "fade", "must be between 1 and 2^15", "ticks";
        COUNTS_PER_REV: "counts_per_rev", "must be above 0", "counts";
        INERTIA: "inertia", "must be above 0 and finite", "kg m^2";
        DAMPING: "damping", "must be at least 0 and finite", "N m s/rad";
        TORQUE_CONSTANT: "torque_constant", "must be above 0 and finite", "N m/A";
        COULOMB_FRICTION: "coulomb_friction", "must be at least 0 and finite", "N m";
        AMPLIFIER_LAG: "amplifier_lag", "must be at least 0 and below 10^6 ticks", "s";
        COUPLED_COUNTS_PER_REV: "coupled_counts_per_rev", "must be above 0", "counts";
        JERK_DENSITY: "jerk_density", "must be above 0, and the process noise made of it above 0 \
            and finite", "rad/s^3/sqrt(Hz)";
        CURRENT_NOISE: "current_noise", "must be above 0, and the process noise made of it above 0 \
            and finite", "A";
        TORQUE_NOISE: "torque_noise", "must be above 0 and below 10^6, and its variance in a tick \
            above 0", "N m/sqrt(Hz)";
        TORQUE_NOISE_FOR_QUANTISED: "torque_noise", "must spread the velocity in a tick by 1e-9 to \
            512 counts/tick", "N m/sqrt(Hz)";
        DISTURBANCE: "disturbance", "must be above 0 and below 10^6, and its variance in a tick above 0", "N m";
        DISTURBANCE_TIME: "disturbance_time", "must be above 0 and below 10^9", "s";
        FRICTION_SHARE: "friction_share", "must be between 0 and 1";
        BOUNDARY_NOISE: "boundary_noise", "must be between 1e-4 and 1e3", "counts";
        PROCESS_NOISE: "process_noise", "must be at most 2^18 on the diagonal for a covariance in \
            single precision", "counts^2 in a tick";
        NOT_CONVERGED: "process_noise", "is too small or too large for the rate and the encoder: \
            the steady gain does not converge in 2^20 ticks";
        NOT_STABLE: "process_noise", "makes the closed loop of model and steady gain unstable";
        TABLE: "N", "must be larger or the process noise too: the gain is not within 1e-6 of its \
            limit at the end of the table", "ticks";
    }

    /// The parameter, as the constructor or the field calls it.
    #[must_use]
    pub const fn parameter(self) -> &'static str {
        self.parameter
    }

    /// The requirement that the parameter breaks.
    #[must_use]
    pub const fn requirement(self) -> &'static str {
        self.requirement
    }

    /// The parameter's unit, empty for a pure number.
    #[must_use]
    pub const fn unit(self) -> &'static str {
        self.unit
    }

    /// Parameter, requirement and unit in one line.
    #[must_use]
    pub const fn message(self) -> &'static str {
        self.message
    }
}

impl fmt::Display for DesignError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.message)
    }
}

impl core::error::Error for DesignError {}

/// Evaluates a design at compile time; an error stops the build with its `message()`.
///
/// ```
/// use estimator_core::{Hertz, Model, NoInput, SteadyKalman, SteadyKalmanTriple, preset};
/// const MODEL: Model<3, NoInput> = preset!(Model::triple_integrator(4096, Hertz(1000.0), 1000.0));
/// const PRESET: SteadyKalmanTriple = preset!(SteadyKalman::new(&MODEL));
/// assert!(MODEL.steady_gain().unwrap()[0] < 1.0);
/// ```
///
/// A model with hardly any process noise has no steady gain in reach, so this does not build:
///
/// ```compile_fail
/// use estimator_core::{Hertz, Model, NoInput, SteadyKalman, SteadyKalmanTriple, preset};
/// const MODEL: Model<3, NoInput> = preset!(Model::triple_integrator(4096, Hertz(1000.0), 1e-60));
/// const PRESET: SteadyKalmanTriple = preset!(SteadyKalman::new(&MODEL));
/// assert!(MODEL.steady_gain().unwrap()[0] < 1.0);
/// ```
#[macro_export]
macro_rules! preset {
    ($design:expr) => {
        const {
            match $design {
                Ok(designed) => designed,
                Err(error) => panic!("{}", error.message()),
            }
        }
    };
}
