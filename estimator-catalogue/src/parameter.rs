//! Parameters of estimators: name, unit, range, the grid on which `host-sim tune` searches, and the rule
//! that scales a tuned value.

use crate::scaling::{Powers, Scaling};

/// One parameter of an estimator.
#[derive(Clone, Copy, Debug)]
pub struct Parameter {
    /// Name after the dot of `NAME.PARAM`.
    pub name: &'static str,
    /// Unit; empty for a number without unit.
    pub unit: &'static str,
    /// Meaning, in a few words.
    pub meaning: &'static str,
    /// Smallest value.
    pub lowest: f64,
    /// Largest value.
    pub highest: f64,
    /// Whether the value must be a whole number.
    pub whole: bool,
    /// Values that `tune` tries.
    pub search: Search,
    /// Rule that scales a tuned value to another encoder and another control rate.
    pub scaling: Scaling,
}

/// Values of a parameter that `host-sim tune` tries.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Search {
    /// Values between these bounds, equidistant on a logarithmic scale.
    Log(f64, f64),
    /// Every whole number between these bounds.
    Each(u32, u32),
    /// This value alone: the parameter is not tuned.
    Fixed(f64),
}

/// Largest window of any estimator on the host, intervals. Firmware has a ring of the length that it needs.
pub const WINDOW_LIMIT: usize = 128;

/// Ranges of the parameters of rows. The row gives the name of the parameter.
impl Parameter {
    /// Cut-off frequency of a first-order low-pass.
    pub const CUTOFF: Self = Self {
        name: "",
        unit: "Hz",
        meaning: "cut-off of the filter, at most half the rate",
        lowest: 1e-3,
        highest: 1e6,
        whole: false,
        search: Search::Log(5.0, 500.0),
        scaling: Scaling::Bandwidth(Powers::ONE_POLE),
    };

    /// Frequency of the equal poles of a tracking loop; the scaling is that of three poles.
    pub const BANDWIDTH: Self = Self {
        meaning: "frequency of the loop's poles, at most half the rate",
        scaling: Scaling::Bandwidth(Powers::THREE_POLES),
        ..Self::CUTOFF
    };

    /// Largest number of intervals in a window.
    pub const WINDOW: Self = Self {
        name: "",
        unit: "intervals",
        meaning: "largest number of intervals in the window",
        lowest: 1.0,
        highest: WINDOW_LIMIT as f64,
        whole: true,
        search: Search::Each(1, WINDOW_LIMIT as u32),
        scaling: Scaling::Intervals(Powers::STRAIGHT),
    };

    /// Noise bound of FOAW.
    pub const NOISE_BOUND: Self = Self {
        name: "",
        unit: "counts",
        meaning: "noise bound: half-width of the band around the line",
        lowest: 0.0,
        highest: 16_384.0,
        whole: true,
        search: Search::Each(0, 4),
        scaling: Scaling::Unscaled,
    };

    /// Bound on the acceleration of a differentiator.
    pub const ACCELERATION: Self = Self {
        name: "",
        unit: "rad/s^2",
        meaning: "largest acceleration that the differentiator expects",
        lowest: 1e-3,
        highest: 1e9,
        whole: false,
        search: Search::Log(1.0, 1e5),
        scaling: Scaling::Unscaled,
    };

    /// Process noise of the triple integrator.
    pub const JERK: Self = Self {
        name: "",
        unit: "rad/s^3/sqrt(Hz)",
        meaning: "spectral density of the jerk that the filter expects",
        lowest: 1e-9,
        highest: 1e12,
        whole: false,
        search: Search::Log(1.0, 1e6),
        scaling: Scaling::Unscaled,
    };

    /// Process noise of the motor model.
    pub const CURRENT_NOISE: Self = Self {
        name: "",
        unit: "A",
        meaning: "standard deviation of the current's error, drawn anew each tick",
        lowest: 1e-9,
        highest: 1e6,
        whole: false,
        search: Search::Log(1e-4, 100.0),
        scaling: Scaling::DrawnEachTick,
    };

    /// Choice between two readings of the paper's eq. 15.
    pub const LITERAL: Self = Self {
        name: "",
        unit: "",
        meaning: "1 applies the current one tick late, as the paper's eq. 15 is printed",
        lowest: 0.0,
        highest: 1.0,
        whole: true,
        search: Search::Fixed(0.0),
        scaling: Scaling::Unscaled,
    };

    /// White disturbance torque of an observer.
    pub const TORQUE_NOISE: Self = Self {
        name: "",
        unit: "N.m/sqrt(Hz)",
        meaning: "spectral density of the white torque that the observer expects",
        lowest: 1e-12,
        highest: 1.0,
        whole: false,
        search: Search::Log(5e-7, 5e-4),
        scaling: Scaling::Unscaled,
    };

    /// Slow disturbance torque of an observer.
    pub const DISTURBANCE: Self = Self {
        name: "",
        unit: "N.m",
        meaning: "standard deviation of the slow disturbance torque",
        lowest: 1e-12,
        highest: 1e3,
        whole: false,
        search: Search::Log(1e-5, 1e-2),
        scaling: Scaling::Unscaled,
    };

    /// Slow disturbance torque of an observer without current, which includes the motor torque.
    pub const DISTURBANCE_AND_MOTOR: Self = Self {
        search: Search::Log(1e-4, 1.0),
        ..Self::DISTURBANCE
    };

    /// Correlation time of the slow disturbance torque.
    pub const DISTURBANCE_TIME: Self = Self {
        name: "",
        unit: "s",
        meaning: "correlation time of the slow disturbance torque",
        lowest: 1e-6,
        highest: 1e6,
        whole: false,
        search: Search::Fixed(0.1),
        scaling: Scaling::Unscaled,
    };

    /// Share of the slow disturbance torque that is attributed to friction.
    pub const FRICTION_SHARE: Self = Self {
        name: "",
        unit: "",
        meaning: "share of the slow disturbance torque that is attributed to friction",
        lowest: 0.0,
        highest: 1.0,
        whole: false,
        search: Search::Fixed(0.7),
        scaling: Scaling::Unscaled,
    };

    /// Standard deviation of the position of a boundary between counts.
    pub const BOUNDARY_NOISE: Self = Self {
        name: "",
        unit: "counts",
        meaning: "standard deviation of a boundary's position: disc errors and rounding of the model",
        lowest: 1e-4,
        highest: 1e3,
        whole: false,
        search: Search::Fixed(0.0625),
        scaling: Scaling::Unscaled,
    };

    /// Standard deviation of the position of a boundary whose phase error is learned, which leaves
    /// 0.02 to 0.03 counts.
    pub const DISC_NOISE: Self = Self {
        search: Search::Fixed(0.03),
        ..Self::BOUNDARY_NOISE
    };

    /// Whether `value` is in the range, and whole if it must be. NaN is not.
    #[must_use]
    pub fn accepts(&self, value: f64) -> bool {
        let whole = !self.whole || value as i64 as f64 == value;
        self.lowest <= value && value <= self.highest && whole
    }

    /// Whether the parameter is a torque or a spectral density of a torque.
    #[must_use]
    pub fn is_torque(&self) -> bool {
        self.unit.starts_with("N.m")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ends_of_a_range_are_accepted_and_parts_of_whole_numbers_are_not() {
        for (value, is_accepted) in [
            (1.0, true),
            (128.0, true),
            (0.0, false),
            (129.0, false),
            (2.5, false),
            (f64::NAN, false),
        ] {
            assert_eq!(Parameter::WINDOW.accepts(value), is_accepted, "{value}");
        }
        assert!(Parameter::CUTOFF.accepts(2.5));
    }

    #[test]
    fn torques_and_their_densities_are_torques() {
        let [density, torque] = [Parameter::TORQUE_NOISE, Parameter::DISTURBANCE];
        assert!(density.is_torque() && torque.is_torque());
        let [time, window] = [Parameter::DISTURBANCE_TIME, Parameter::WINDOW];
        assert!(!time.is_torque() && !window.is_torque());
    }
}
