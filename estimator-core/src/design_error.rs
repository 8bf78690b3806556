//! Why a set of parameters was refused.

use core::fmt;

/// Why a set of parameters was refused, at run time by `Err` or at compile time by [`preset!`].
///
/// [`preset!`]: crate::preset
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub enum DesignError {
    /// The control rate is not positive and finite.
    Rate,
    /// The cut-off or bandwidth is not a millionth to half of the control rate.
    Cutoff,
    /// The edge clock is not finite, or slower than the control rate.
    EdgeClock,
    /// The hand-over has no fade, or one that is too long, or takes too long to settle.
    Fade,
    /// The window is empty or longer than the ring that holds it.
    Window,
    /// The noise bound is above 2^14 counts.
    NoiseBound,
    /// A device constant is out of its range.
    Device,
    /// Friction, amplifier lag or counts of the small encoder are out of their range.
    CoupledMotor,
    /// At this rate the device is too fast or too stiff for a tick.
    Tick,
    /// What an observer is unsure of is out of its range.
    Uncertainty,
    /// The process noise is not positive and finite, or too large for a covariance in f32.
    ProcessNoise,
    /// The Riccati recursion has no limit in reach: the process noise is too small or too large
    /// for the rate and the encoder.
    NotConverged,
    /// The closed loop of model and gain is not stable.
    NotStable,
    /// The gain has not settled where the table of gains ends.
    Table,
}

impl DesignError {
    /// What is wrong, and with what.
    #[must_use]
    pub const fn message(self) -> &'static str {
        match self {
            Self::Rate => "control rate must be positive and finite (Hz)",
            Self::Cutoff => "cut-off must be 1e-6 to 1/2 of the control rate (Hz)",
            Self::EdgeClock => "edge clock must be finite and at least the control rate (Hz)",
            Self::Fade => {
                "hand-over must fade over 1 to 2^15 ticks, after fewer than 2^15 ticks to settle"
            }
            Self::Window => "window must be 1 to N intervals, N at most 128",
            Self::NoiseBound => "noise bound must be at most 16384 counts",
            Self::Device => {
                "device constants must be finite: counts per turn, inertia and torque constant \
                 above 0, damping at least 0"
            }
            Self::CoupledMotor => {
                "friction and amplifier lag must be finite and at least 0, the lag below 10^6 ticks, \
                 counts of the small encoder above 0"
            }
            Self::Tick => {
                "control rate is out of range for the device: a tick must be below 8 time constants \
                 of the motor, and an ampere or its friction move it by less than 10^6 counts a \
                 tick^2 (700 and 10^9 for a Kalman filter)"
            }
            Self::Uncertainty => {
                "torque noise and load must be above 0 and below 10^6 (N.m), load time above 0 and \
                 below 10^9 s, friction share 0 to 1, boundary noise 10^-4 to 10^3 counts"
            }
            Self::ProcessNoise => {
                "process noise must be positive and finite, and with a covariance at run time at \
                 most 2^18 and, with soft ends, at least 1e-18 counts^2 a tick"
            }
            Self::NotConverged => {
                "steady gain does not converge: process noise out of reach for this rate and encoder"
            }
            Self::NotStable => "closed loop of model and steady gain is not stable",
            Self::Table => "gain does not settle within the table: more ticks or process noise",
        }
    }
}

impl fmt::Display for DesignError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.message())
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
/// The same with hardly any process noise, whose recursion has no limit in reach, does not build:
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
