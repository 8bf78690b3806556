//! Conversion of a current to a DAC code.

use estimator_core::Amps;

/// A 12-bit DAC code. Mid-scale is zero current, 2047 steps are full scale.
///
/// ```
/// use drivers::DacCode;
/// use estimator_core::Amps;
/// let full_scale = Amps::new(6.0);
/// assert_eq!(DacCode::new(Amps::new(-6.0), full_scale).get(), 1);
/// assert_eq!(DacCode::new(Amps::new(1.0), full_scale).get(), 2048 + 341);
/// assert_eq!(DacCode::new(Amps::new(f32::NAN), full_scale), DacCode::ZERO);
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct DacCode(u16);

impl DacCode {
    /// Zero current.
    pub const ZERO: Self = Self(2048);

    /// `2048 + round(current / full_scale * 2047)`, saturated to 1 to 4095. NaN and a full scale of 0
    /// give mid-scale, because the conversion to an integer comes before the offset.
    #[must_use]
    pub const fn new(current: Amps, full_scale: Amps) -> Self {
        let scaled = current.get() / full_scale.get() * 2047.0;
        let rounded = scaled + 0.5_f32.copysign(scaled);
        if !rounded.is_finite() {
            return Self::ZERO;
        }
        // A cast truncates towards zero, and saturates.
        let steps = match rounded as i32 {
            ..-2047 => -2047,
            2048.. => 2047,
            steps => steps,
        };
        Self((2048 + steps) as u16)
    }

    /// The value for the register of the DAC.
    #[must_use]
    pub const fn get(self) -> u16 {
        self.0
    }
}

#[cfg(test)]
mod tests {
    use super::DacCode;
    use estimator_core::Amps;

    #[test]
    fn codes_are_odd_about_mid_scale_monotonic_and_within_half_a_step() {
        let full = 1.5;
        let mut last = 0;
        for k in -3000..=3000_i16 {
            let amps = f32::from(k) / 3000.0 * full;
            let code = DacCode::new(Amps::new(amps), Amps::new(full)).get();
            let mirrored = DacCode::new(Amps::new(-amps), Amps::new(full)).get();
            assert_eq!(code + mirrored, 4096);
            assert!(code >= last);
            last = code;
            let back = (f32::from(code) - 2048.0) / 2047.0 * full;
            assert!((back - amps).abs() <= full / 2047.0 * 0.5001);
        }
    }

    #[test]
    fn invalid_current_is_mid_scale_and_large_current_saturates() {
        let full = Amps::new(6.0);
        assert_eq!(DacCode::new(Amps::new(f32::INFINITY), full), DacCode::ZERO);
        assert_eq!(DacCode::new(Amps::new(1.0), Amps::ZERO), DacCode::ZERO);
        assert_eq!(DacCode::new(Amps::ZERO, Amps::ZERO), DacCode::ZERO);
        assert_eq!(DacCode::new(Amps::new(1e30), full).get(), 4095);
        assert_eq!(DacCode::new(Amps::new(-1e30), full).get(), 1);
    }
}
