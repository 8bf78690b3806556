//! Counts of an absolute encoder, which wrap at a modulus of their own.

use core::fmt;

use crate::units::Count;

/// Why [`Count::wrapped`] refuses a reading.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum WrapError {
    /// The modulus is below 2 or above 2^31.
    Modulus,
    /// The reading is not below the modulus.
    Raw,
    /// The modulus is no power of two, and the position leaves -2^31 to 2^31 - 1 counts.
    Position,
}

impl WrapError {
    /// The requirement that the reading breaks.
    #[must_use]
    pub const fn message(self) -> &'static str {
        match self {
            Self::Modulus => "modulus must be from 2 to 2^31",
            Self::Raw => "raw must be below modulus",
            Self::Position => {
                "the position must be from -2^31 to 2^31 - 1 counts where modulus is no power of two"
            }
        }
    }
}

impl fmt::Display for WrapError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.message())
    }
}

impl core::error::Error for WrapError {}

impl Count {
    /// Extends the reading `raw` of an encoder that counts from 0 to `modulus` - 1 to a count; `self`
    /// is the previous count.
    ///
    /// The first count is `Count(raw)`. The result is the count nearest to `self` that is `raw` modulo
    /// `modulus`. It is correct if the encoder moved by less than half of `modulus` since the previous
    /// reading; a displacement of exactly half of an even `modulus` counts as negative.
    ///
    /// A power of two divides 2^32, so such an encoder may turn without end. Another `modulus` does not
    /// divide 2^32, so the position, `self` as a signed number, must stay from -2^31 to 2^31 - 1.
    ///
    /// ```
    /// use estimator_core::Count;
    /// // A 12-bit magnetic encoder passes zero forward and backward.
    /// assert_eq!(Count(4093).wrapped(2, 4096), Ok(Count(4098)));
    /// assert_eq!(Count(4098).wrapped(4093, 4096), Ok(Count(4093)));
    /// ```
    ///
    /// # Errors
    /// [`WrapError::Modulus`], [`WrapError::Raw`], [`WrapError::Position`].
    pub const fn wrapped(self, raw: u32, modulus: u32) -> Result<Self, WrapError> {
        if modulus < 2 || modulus > 1 << 31 {
            return Err(WrapError::Modulus);
        }
        if raw >= modulus {
            return Err(WrapError::Raw);
        }
        let divides = modulus.is_power_of_two();
        let before = match divides {
            true => self.0 & (modulus - 1),
            // Below 2^31, so the modulus is positive as a signed number too.
            false => (self.0 as i32).rem_euclid(modulus as i32) as u32,
        };
        let forward = match raw >= before {
            true => raw - before,
            false => raw + (modulus - before),
        };
        let backward = modulus - forward;
        let moved = match forward < backward {
            true => forward as i32,
            // At most 2^30 in magnitude.
            false => -(backward as i32),
        };
        if !divides && (self.0 as i32).checked_add(moved).is_none() {
            return Err(WrapError::Position);
        }
        Ok(Self(self.0.wrapping_add_signed(moved)))
    }
}
