//! Quantities of the public interface, one type each.

use core::ops::{Add, Sub};

use crate::design::DesignError;

/// Position of an encoder as its counter shows it, modulo 2^32.
///
/// Only differences have a meaning: `Count - Count` is a displacement, correct if the true
/// displacement is within ±2^31 counts.
///
/// ```
/// use estimator_core::{Count, Counts};
/// assert_eq!(Count(2) - Count(u32::MAX), Counts(3));
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Count(pub u32);

impl Count {
    /// Extends the reading `raw` of a 16-bit counter to a count; `self` is the previous count.
    ///
    /// Correct if the encoder moved by less than 2^15 counts since the previous count was read.
    ///
    /// ```
    /// use estimator_core::Count;
    /// assert_eq!(Count(0x0001_FFFF).extended(0x0002), Count(0x0002_0002));
    /// assert_eq!(Count(0x0002_0002).extended(0xFFFF), Count(0x0001_FFFF));
    /// ```
    #[must_use]
    pub const fn extended(self, raw: u16) -> Self {
        // The low halves differ by the displacement modulo 2^16; sign-extend it.
        let step = raw.wrapping_sub(self.0 as u16) as i16;
        Self(self.0.wrapping_add(step as u32))
    }
}

impl Sub for Count {
    type Output = Counts;

    // Every update begins with this subtraction.
    #[inline(always)]
    fn sub(self, earlier: Self) -> Counts {
        Counts(self.0.wrapping_sub(earlier.0) as i32)
    }
}

impl Add<Counts> for Count {
    type Output = Self;

    #[inline(always)]
    fn add(self, displacement: Counts) -> Self {
        Self(self.0.wrapping_add_signed(displacement.0))
    }
}

/// Displacement in encoder counts.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Counts(pub i32);

impl Counts {
    /// The displacement as a float, exact up to ±2^24 counts.
    #[must_use]
    pub const fn to_f32(self) -> f32 {
        self.0 as f32
    }

    /// The longest displacement in a tick that is taken for motion: that of a counter of 16 bits.
    pub(crate) const LONGEST_STEP: i32 = i16::MAX as i32;

    /// Whether the displacement of a tick is taken for motion.
    #[inline(always)]
    pub(crate) const fn is_motion(self) -> bool {
        -Self::LONGEST_STEP <= self.0 && self.0 <= Self::LONGEST_STEP
    }
}

/// Velocity in counts per control period.
#[derive(Clone, Copy, Debug, Default, PartialEq, PartialOrd)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct CountsPerTick(pub f32);

impl CountsPerTick {
    /// The velocity in rad/s.
    #[must_use]
    pub const fn rad_per_s(self, scale: &Scale) -> f32 {
        self.0 * scale.rad_per_s_per_count_per_tick
    }
}

/// Acceleration in counts per control period squared.
#[derive(Clone, Copy, Debug, Default, PartialEq, PartialOrd)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct CountsPerTickSquared(pub f32);

/// Electric current, A: always finite, within ±[`Amps::MAX`].
#[derive(Clone, Copy, Debug, Default, PartialEq, PartialOrd)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Amps(f32);

impl Amps {
    /// The largest magnitude, A: far above what any haptic device carries.
    pub const MAX: f32 = 1000.0;

    /// No current.
    pub const ZERO: Self = Self(0.0);

    /// A current of `amps`; NaN and infinities become zero, the rest saturates at ±[`Amps::MAX`].
    ///
    /// Currents are limited here and nowhere else, so estimators need no check.
    ///
    /// ```
    /// use estimator_core::Amps;
    /// assert_eq!(Amps::new(0.25).get(), 0.25);
    /// assert_eq!(Amps::new(f32::NAN), Amps::ZERO);
    /// assert_eq!(Amps::new(f32::NEG_INFINITY), Amps::ZERO);
    /// assert_eq!(Amps::new(-1e30).get(), -1000.0);
    /// ```
    #[must_use]
    #[inline]
    pub const fn new(amps: f32) -> Self {
        if amps.abs() <= Self::MAX {
            Self(amps)
        } else {
            Self::made_safe(amps)
        }
    }

    /// A current of `amps` if its magnitude is at most `largest`; NaN never is.
    ///
    /// ```
    /// use estimator_core::Amps;
    /// let largest = Amps::new(2.0);
    /// assert_eq!(Amps::within(-2.0, largest), Some(Amps::new(-2.0)));
    /// assert!(Amps::within(2.001, largest).is_none() && Amps::within(f32::NAN, largest).is_none());
    /// ```
    #[must_use]
    #[inline]
    pub const fn within(amps: f32, largest: Self) -> Option<Self> {
        if amps.abs() <= largest.0 {
            Some(Self(amps))
        } else {
            None
        }
    }

    /// Slow path for currents that no device carries: NaN, infinities and magnitudes above
    /// [`Amps::MAX`].
    #[cold]
    const fn made_safe(amps: f32) -> Self {
        if amps.is_finite() {
            Self(Self::MAX.copysign(amps))
        } else {
            Self::ZERO
        }
    }

    /// The current in A.
    #[must_use]
    pub const fn get(self) -> f32 {
        self.0
    }
}

/// Duration in ticks of the clock that stamps encoder edges.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct ClockTicks(pub u32);

/// Frequency in Hz: a control rate, a cut-off or the frequency of a clock.
#[derive(Clone, Copy, Debug, PartialEq, PartialOrd)]
pub struct Hertz(pub f64);

impl Hertz {
    /// Whether the frequency is positive and finite.
    pub(crate) const fn is_positive(self) -> bool {
        self.0 > 0.0 && self.0.is_finite()
    }

    /// Whether the frequency is a valid cut-off at a control rate: 1e-6 to 1/2 of it. Below, gains
    /// round to zero in f32.
    pub(crate) const fn is_cutoff_at(self, rate: Self) -> bool {
        self.0 >= 1e-6 * rate.0 && self.0 <= rate.0 / 2.0
    }

    /// One period, s.
    #[must_use]
    pub const fn period_s(self) -> f64 {
        1.0 / self.0
    }
}

/// The factor between counts per tick and rad/s, for one encoder at one control rate.
///
/// `rad_per_s_per_count_per_tick = 2 π rate / counts_per_rev`: the velocity of a finite difference
/// per count (eq. 5 of the paper, with its factor 4 in `counts_per_rev`).
///
/// ```
/// use estimator_core::{CountsPerTick, Hertz, Scale};
/// // 1024 lines at 1 kHz: one count is 1.53 rad/s.
/// let scale = Scale::new(4 * 1024, Hertz(1000.0)).unwrap();
/// assert_eq!(CountsPerTick(1.0).rad_per_s(&scale), 1.533_980_8);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Scale {
    /// rad/s per count per tick.
    pub rad_per_s_per_count_per_tick: f32,
}

impl Scale {
    /// The factor for an encoder of `counts_per_rev` (four times its lines) at a control rate.
    ///
    /// # Errors
    /// [`DesignError::RATE`], also where the factor is beyond the numbers of f32; [`DesignError::COUNTS_PER_REV`].
    pub const fn new(counts_per_rev: u32, rate: Hertz) -> Result<Self, DesignError> {
        if !rate.is_positive() {
            return Err(DesignError::RATE);
        }
        if counts_per_rev == 0 {
            return Err(DesignError::COUNTS_PER_REV);
        }
        let factor = 2.0 * core::f64::consts::PI * rate.0 / counts_per_rev as f64;
        // Numbers that f32 holds.
        if !(factor >= 1e-30 && factor <= 1e30) {
            return Err(DesignError::RATE);
        }
        Ok(Self {
            rad_per_s_per_count_per_tick: factor as f32,
        })
    }
}
