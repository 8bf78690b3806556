//! The one place where a current becomes a DAC code.

use estimator_core::Amps;

/// A 12-bit DAC code; mid-scale is no current.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(crate) struct DacCode(u16);

impl DacCode {
    /// No current.
    pub(crate) const ZERO: Self = Self(2048);

    /// `2048 + round(current / full_scale * 2047)`, within 1 to 4095; signed first, so that
    /// nothing but a number can move it off mid-scale.
    pub(crate) fn new(current: Amps, full_scale: Amps) -> Self {
        let scaled = current.get() / full_scale.get() * 2047.0;
        let rounded = if scaled < 0.0 {
            scaled - 0.5
        } else {
            scaled + 0.5
        };
        // A cast truncates towards zero, saturates, and takes NaN to zero.
        let signed = (rounded as i16).clamp(-2047, 2047);
        Self(2048_u16.wrapping_add_signed(signed))
    }

    /// The code as the DAC takes it.
    pub(crate) const fn get(self) -> u16 {
        self.0
    }
}
