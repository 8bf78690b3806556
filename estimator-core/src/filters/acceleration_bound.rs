//! The bound on the acceleration, which designs a differentiator, and that on its error.

use crate::design::DesignError;
use crate::models::linear::counts_per_rad;
use crate::units::Hertz;

/// Largest distance of the position of a differentiator from the count, counts. A larger one restarts the
/// differentiator.
pub(super) const LARGEST_ERROR: f32 = 32_768.0;

/// The bound L in counts/tick² of `acceleration`, rad/s².
///
/// # Errors
/// [`DesignError::RATE`], [`DesignError::COUNTS_PER_REV`], [`DesignError::ACCELERATION`].
pub(super) const fn counts_per_tick_squared(
    counts_per_rev: u32,
    rate: Hertz,
    acceleration: f64,
) -> Result<f64, DesignError> {
    if !rate.is_positive() {
        return Err(DesignError::RATE);
    }
    if counts_per_rev == 0 {
        return Err(DesignError::COUNTS_PER_REV);
    }
    let t = rate.period_s();
    let bound = acceleration * counts_per_rad(counts_per_rev) * t * t;
    if !(bound >= 1e-12 && bound <= 1e6) {
        return Err(DesignError::ACCELERATION);
    }
    Ok(bound)
}
