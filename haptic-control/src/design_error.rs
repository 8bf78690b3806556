//! The error of a controller that cannot be designed.

use core::fmt;

/// Error of a controller that cannot be designed. A constructor returns it at run time, and
/// [`preset!`](estimator_core::preset) reports it at compile time.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum DesignError {
    /// The control rate is not in 100 Hz to 100 kHz.
    Rate,
    /// A device constant is out of its range.
    Device,
    /// A bandwidth is not above zero and at most a tenth of the control rate.
    Bandwidth,
    /// The pole placement has no solution.
    Singular,
    /// The loop is unstable, or its stability margin is too small.
    Margins,
    /// A parameter of a scene is out of its range.
    Scene,
    /// The control rate is not in the range of the scene `excite`.
    ExciteRate,
}

impl DesignError {
    /// The parameter and its requirement.
    #[must_use]
    pub const fn message(self) -> &'static str {
        match self {
            Self::Rate => "control rate must be 100 Hz to 100 kHz",
            Self::Device => {
                "device constants must be finite and above 0, friction at least 0 (SI units)"
            }
            Self::Bandwidth => "bandwidth must be above 0 and at most a tenth of the control rate",
            Self::Singular => "pole placement has no solution for this device and rate",
            Self::Margins => {
                "velocity loop misses its margins: lower the bandwidth of regulation or the delay of the \
                 estimator"
            }
            Self::Scene => "scene parameter out of its range",
            Self::ExciteRate => "scene excite needs a control rate of 1 to 100 kHz",
        }
    }
}

impl fmt::Display for DesignError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.message())
    }
}

impl core::error::Error for DesignError {}
