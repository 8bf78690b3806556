//! Limits of the currents. Currents saturate only here.

use estimator_core::Amps;

use crate::device::DualStage;

/// Limits of one motor's current, applied last: NaN becomes zero, the magnitude saturates, and a
/// tick changes the current by at most the slew limit.
///
/// ```
/// use estimator_core::Amps;
/// use haptic_control::CurrentLimits;
/// const LIMITS: CurrentLimits = CurrentLimits { largest: Amps::new(6.0), slew: 1.0 };
/// let applied = |wanted, before| LIMITS.applied(wanted, Amps::new(before)).get();
/// assert_eq!(applied(10.0, 5.5), 6.0);
/// assert_eq!(applied(-2.0, 0.25), -0.75);
/// assert_eq!(applied(f32::NAN, 0.25), 0.0);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CurrentLimits {
    /// Largest magnitude.
    pub largest: Amps,
    /// Largest change in a tick, A.
    pub slew: f32,
}

impl CurrentLimits {
    /// The current to apply for the commanded current `wanted`, A, if `before` was applied in the last tick.
    #[must_use]
    #[inline]
    pub fn applied(&self, wanted: f32, before: Amps) -> Amps {
        self.unlimited(wanted, before)
            .unwrap_or_else(|| self.limited(wanted, before))
    }

    /// The commanded current, if no limit changes it: in nearly every tick.
    #[inline]
    pub(crate) fn unlimited(&self, wanted: f32, before: Amps) -> Option<Amps> {
        // NaN and infinity are not within.
        Amps::within(wanted, self.largest).filter(|_| (wanted - before.get()).abs() <= self.slew)
    }

    #[cold]
    #[inline(never)]
    pub(crate) fn limited(&self, wanted: f32, before: Amps) -> Amps {
        if !wanted.is_finite() {
            return Amps::ZERO;
        }
        let (before, largest) = (before.get(), self.largest.get());
        let slewed = within(wanted, before - self.slew, before + self.slew);
        Amps::new(within(slewed, -largest, largest))
    }
}

/// The part of the device's current limits that the stages use, 0 to 1, and a bound of each current beside it.
///
/// ```
/// use estimator_core::Amps;
/// use haptic_control::{CurrentScale, Currents};
/// assert_eq!(CurrentScale::FULL, CurrentScale::new(1.0).unwrap());
/// assert!(CurrentScale::new(1.1).is_none() && CurrentScale::new(f32::NAN).is_none());
/// let bounds = Currents { large: Amps::new(2.0), small: Amps::new(1.0) };
/// assert_eq!(CurrentScale::new(0.5).unwrap().bounded(bounds).large(6.0), 2.0);
/// assert_eq!(CurrentScale::new(0.5).unwrap().bounded(bounds).small(1.5), 0.75);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CurrentScale {
    part: f32,
    /// Bounds of the large and the small motor's current, A.
    bounds: [f32; 2],
}

impl CurrentScale {
    /// No current.
    pub const NONE: Self = Self::of(0.0);
    /// The limits of the device.
    pub const FULL: Self = Self::of(1.0);

    const fn of(part: f32) -> Self {
        Self {
            part,
            bounds: [f32::INFINITY; 2],
        }
    }

    /// This part of the limits; `None` unless it is 0 to 1.
    #[must_use]
    pub const fn new(part: f32) -> Option<Self> {
        if 0.0 <= part && part <= 1.0 {
            Some(Self::of(part))
        } else {
            None
        }
    }

    /// This part of the limits, and no current above these bounds. A bound that is not above 0 leaves no
    /// current.
    #[must_use]
    pub const fn bounded(self, bounds: Currents) -> Self {
        Self {
            bounds: [bounds.large.get(), bounds.small.get()],
            ..self
        }
    }

    /// Largest current of the large motor, whose limit is `limit`, A.
    #[must_use]
    pub const fn large(self, limit: f32) -> f32 {
        smaller(limit * self.part, self.bounds[0])
    }

    /// Largest current of the small motor, whose limit is `limit`, A.
    #[must_use]
    pub const fn small(self, limit: f32) -> f32 {
        smaller(limit * self.part, self.bounds[1])
    }
}

/// The smaller one of a limit and a bound; 0 if the bound is not above 0.
const fn smaller(limit: f32, bound: f32) -> f32 {
    if bound >= limit {
        limit
    } else if bound > 0.0 {
        bound
    } else {
        0.0
    }
}

impl CurrentScale {
    /// Currents within this part of a device's limits. The stages have limits of their own; this is for the
    /// currents of an open loop.
    #[must_use]
    pub fn within(self, device: &DualStage, currents: Currents) -> Currents {
        currents.within([
            self.large(device.large.current_limit as f32),
            self.small(device.small.current_limit as f32),
        ])
    }
}

/// `x`, or `bound` with the sign of `x` if its magnitude is larger: one comparison for nearly every `x`.
pub(crate) fn at_most(x: f32, bound: f32) -> f32 {
    if x.abs() > bound {
        bound.copysign(x)
    } else {
        x
    }
}

/// [`at_most`] for an `x` that is within in nearly every tick: a branch, where a selection would compute both.
#[inline]
pub(crate) fn seldom_more(x: f32, bound: f32) -> f32 {
    // NaN is not within.
    if x.abs() <= bound {
        x
    } else {
        bounded(x, bound)
    }
}

#[cold]
#[inline(never)]
fn bounded(x: f32, bound: f32) -> f32 {
    at_most(x, bound)
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

impl Currents {
    /// Within these magnitudes of the large and the small motor's current, A.
    pub(crate) fn within(self, [large, small]: [f32; 2]) -> Self {
        let limited =
            |current: Amps, largest: f32| Amps::new(within(current.get(), -largest, largest));
        Self {
            large: limited(self.large, large),
            small: limited(self.small, small),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::{Amps, CurrentLimits, at_most, seldom_more, within};

    const LIMITS: CurrentLimits = CurrentLimits {
        largest: Amps::new(6.0),
        slew: 0.7,
    };

    /// Both limits one after the other, in f64.
    fn limited(wanted: f32, before: f32) -> f64 {
        let [wanted, before] = [wanted, before].map(f64::from);
        let [largest, slew] = [LIMITS.largest.get(), LIMITS.slew].map(f64::from);
        let slewed = wanted.clamp(before - slew, before + slew);
        slewed.clamp(-largest, largest)
    }

    #[test]
    fn current_that_is_within_both_limits_is_not_changed() {
        let mut unchanged = 0;
        for k in -700..=700_i16 {
            let before = f32::from(k) * 0.01;
            for j in -1000..=1000_i16 {
                let wanted = f32::from(j) * 0.01;
                let applied = LIMITS.applied(wanted, Amps::new(before)).get();
                let exact = limited(wanted, before);
                // A rounding of the bound.
                assert!(
                    (f64::from(applied) - exact).abs() < 1e-6,
                    "{wanted} {before}"
                );
                unchanged += u32::from(applied.to_bits() == wanted.to_bits());
            }
        }
        assert!(unchanged > 100_000, "{unchanged}");
    }

    #[test]
    fn current_that_is_no_number_is_zero() {
        for wanted in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
            assert_eq!(LIMITS.applied(wanted, Amps::new(0.2)), Amps::ZERO);
        }
    }

    #[test]
    fn bound_holds_on_both_sides_and_leaves_what_is_no_number() {
        for x in [-9.0, -2.0, -1.999, -0.0, 0.5, 2.0, 2.001, f32::MAX] {
            assert_eq!(at_most(x, 2.0).to_bits(), within(x, -2.0, 2.0).to_bits());
            assert_eq!(seldom_more(x, 2.0).to_bits(), at_most(x, 2.0).to_bits());
        }
        assert!(at_most(f32::NAN, 2.0).is_nan() && seldom_more(f32::NAN, 2.0).is_nan());
        assert_eq!(at_most(f32::NEG_INFINITY, 2.0), -2.0);
    }
}
