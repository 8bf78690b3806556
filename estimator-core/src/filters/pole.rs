//! The real pole of filters that are designed by a frequency.

use crate::design::DesignError;
use crate::design::const_math::exp;
use crate::units::Hertz;

/// The pole `exp(-2 π f / rate)` of the frequency f, the same as that of the continuous filter.
///
/// # Errors
/// [`DesignError::RATE`]; `refused` for a frequency outside 1e-6 to 1/2 of the rate.
pub(super) const fn pole(
    frequency: Hertz,
    rate: Hertz,
    refused: DesignError,
) -> Result<f64, DesignError> {
    if !rate.is_positive() {
        return Err(DesignError::RATE);
    }
    if !frequency.is_cutoff_at(rate) {
        return Err(refused);
    }
    Ok(exp(-2.0 * core::f64::consts::PI * frequency.0 / rate.0))
}
