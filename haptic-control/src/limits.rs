//! Limits of the currents. Currents saturate only here.

use estimator_core::Amps;

/// Limits of one motor's current, applied last: NaN becomes zero, the magnitude saturates, and a
/// tick changes the current by at most the slew limit.
///
/// ```
/// use haptic_control::CurrentLimits;
/// const LIMITS: CurrentLimits = CurrentLimits { largest: 6.0, slew: 1.0 };
/// assert_eq!(LIMITS.applied(10.0, 5.5), 6.0);
/// assert_eq!(LIMITS.applied(-2.0, 0.25), -0.75);
/// assert_eq!(LIMITS.applied(f32::NAN, 0.25), 0.0);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CurrentLimits {
    /// Largest magnitude, A.
    pub largest: f32,
    /// Largest change in a tick, A.
    pub slew: f32,
}

impl CurrentLimits {
    /// The current to apply for the commanded current `wanted`, if `before` was applied in the last
    /// tick, A.
    #[must_use]
    pub fn applied(&self, wanted: f32, before: f32) -> f32 {
        if !wanted.is_finite() {
            return 0.0;
        }
        let slewed = within(wanted, before - self.slew, before + self.slew);
        within(slewed, -self.largest, self.largest)
    }
}

/// `clamp` without its panic on bounds in the wrong order.
pub(crate) fn within(x: f32, low: f32, high: f32) -> f32 {
    if x > high {
        high
    } else if x < low {
        low
    } else {
        x
    }
}

/// Currents to apply until the next tick.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Currents {
    /// Large motor.
    pub large: Amps,
    /// Small motor.
    pub small: Amps,
}
