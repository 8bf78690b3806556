//! Conversion of a current to a DAC code.

use estimator_core::Amps;

/// Steps of full scale on either side of mid-scale.
const STEPS: f32 = 2047.0;

/// Currents of the large and of the small amplifier at the ends of the DAC.
pub const FULL_SCALES: [Amps; 2] = [Amps::new(6.0), Amps::new(1.5)];

/// Steps from mid-scale that the output buffer of the DAC reaches: it ends 0.2 V from both rails of a supply
/// of 3.3 V (data sheet of the STM32F427 and F429, DAC characteristics), and 1.45 V / 1.65 V of 2047 steps
/// are 1798.9.
const REACHED_STEPS: f32 = 1798.0;

/// Largest currents of the large and of the small motor that the buffered outputs can command on a board that
/// is not calibrated.
pub const REACHES: [Amps; 2] = {
    let [large, small] = FULL_SCALES;
    match (DacScale::new(large), DacScale::new(small)) {
        (Some(large), Some(small)) => [large.reach(), small.reach()],
        _ => panic!("a full scale is above 0"),
    }
};

/// A 12-bit DAC code.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct DacCode(u16);

impl DacCode {
    /// Mid-scale: zero current on a board that is not calibrated.
    pub const MIDDLE: Self = Self(2048);

    /// The value for the register of the DAC.
    #[must_use]
    pub const fn get(self) -> u16 {
        self.0
    }
}

/// Conversion of a current to a code: `code = zero + current / full_scale / gain * 2047`, rounded and
/// saturated to 0 to 4095.
///
/// ```
/// use drivers::{DacCode, DacScale};
/// use estimator_core::Amps;
/// let scale = DacScale::new(Amps::new(6.0)).unwrap();
/// assert_eq!(scale.code(Amps::new(-6.0)).get(), 1);
/// assert_eq!(scale.code(Amps::new(1.0)).get(), 2048 + 341);
/// assert_eq!(scale.code(Amps::ZERO), DacCode::MIDDLE);
/// // The zero of this channel is 12.3 codes lower, and a code changes the current by 2 % more.
/// let scale = scale.calibrated(2035.7, 1.02).unwrap();
/// assert_eq!(scale.code(Amps::ZERO).get(), 2036);
/// assert_eq!(scale.exact_code(Amps::ZERO), 2035.7);
/// assert_eq!(scale.code(Amps::new(1.0)).get(), 2370);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DacScale {
    /// Code of zero current.
    zero: f32,
    /// The same plus a half, for rounding.
    rounded: f32,
    per_amp: f32,
}

impl DacScale {
    /// The nominal conversion for currents to `full_scale`, which is above 0; otherwise `None`.
    #[must_use]
    pub const fn new(full_scale: Amps) -> Option<Self> {
        let per_amp = STEPS / full_scale.get();
        if !(full_scale.get() > 0.0 && per_amp.is_finite()) {
            return None;
        }
        Some(Self::with(DacCode::MIDDLE.0 as f32, per_amp))
    }

    /// The conversion with the code `zero` of zero current, and the change of the current per code over the
    /// nominal one, `gain`. `None` if `zero` is no code or `gain` is not above 0.
    #[must_use]
    pub const fn calibrated(self, zero: f32, gain: f32) -> Option<Self> {
        let per_amp = self.per_amp / gain;
        if !(1.0 <= zero && zero <= 4095.0 && gain > 0.0 && per_amp.is_finite()) {
            return None;
        }
        Some(Self::with(zero, per_amp))
    }

    const fn with(zero: f32, per_amp: f32) -> Self {
        Self {
            zero,
            rounded: zero + 0.5,
            per_amp,
        }
    }

    /// Largest current that the buffered output can command with either sign; 0 if it cannot command its zero. A
    /// loop that commands more does not know that it is saturated.
    #[must_use]
    pub const fn reach(&self) -> Amps {
        let steps = REACHED_STEPS - (self.zero - DacCode::MIDDLE.0 as f32).abs();
        if steps > 0.0 {
            Amps::new(steps / self.per_amp)
        } else {
            Amps::ZERO
        }
    }

    /// The code of a current before it is rounded.
    #[must_use]
    pub const fn exact_code(&self, current: Amps) -> f32 {
        self.zero + current.get() * self.per_amp
    }

    /// The code of a current.
    #[must_use]
    pub const fn code(&self, current: Amps) -> DacCode {
        // A cast truncates towards zero, and saturates.
        DacCode(match (self.rounded + current.get() * self.per_amp) as i32 {
            ..0 => 0,
            4096.. => 4095,
            code => code as u16,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::{DacCode, DacScale, FULL_SCALES, REACHES};
    use estimator_core::Amps;

    fn scale(full: f32) -> DacScale {
        DacScale::new(Amps::new(full)).unwrap()
    }

    #[test]
    fn codes_are_monotonic_and_within_half_a_step_of_the_calibration() {
        let full = 1.5;
        for (zero, gain) in [(2048.0, 1.0), (2033.4, 1.02), (2061.6, 0.97)] {
            let scale = scale(full).calibrated(zero, gain).unwrap();
            let mut last = 0;
            for k in -2800..=2800_i16 {
                let amps = f32::from(k) / 3000.0 * full;
                let code = scale.code(Amps::new(amps)).get();
                assert!(code >= last);
                last = code;
                let back = (f32::from(code) - zero) / 2047.0 * full * gain;
                assert!((back - amps).abs() <= full * gain / 2047.0 * 0.501, "{k}");
            }
        }
    }

    #[test]
    fn largest_commands_are_within_the_range_of_the_buffer() {
        for (full, reach) in FULL_SCALES.into_iter().zip(REACHES) {
            let scale = DacScale::new(full).unwrap();
            let volts = |amps: f32| f32::from(scale.code(Amps::new(amps)).get()) * 3.3 / 4096.0;
            let reach = reach.get();
            assert!(volts(reach) <= 3.1 && volts(-reach) >= 0.2);
            // Two more steps are beyond it.
            let beyond = reach + 2.0 * full.get() / 2047.0;
            assert!(volts(beyond) > 3.1 || volts(-beyond) < 0.2);
        }
    }

    /// At the ends of the ranges of the settings.
    #[test]
    fn reach_of_a_calibrated_channel_is_that_of_its_worse_sign() {
        for (zero, gain) in [1848.0, 2048.0, 2248.0]
            .into_iter()
            .flat_map(|zero| [0.8, 1.0, 1.25].map(|gain| (zero, gain)))
        {
            let full = 6.0;
            let scale = scale(full).calibrated(zero, gain).unwrap();
            // From 0.2 V to 3.1 V.
            let is_reached = |amps: f32| {
                let volts = scale.exact_code(Amps::new(amps)) * 3.3 / 4096.0;
                (0.2..=3.1).contains(&volts)
            };
            let reach = scale.reach().get();
            assert!(is_reached(reach) && is_reached(-reach), "{zero} {gain}");
            let beyond = reach + 2.0 * full * gain / 2047.0;
            assert!(!is_reached(beyond) || !is_reached(-beyond), "{zero} {gain}");
        }
        let far = scale(6.0).calibrated(200.0, 1.0).unwrap();
        assert_eq!(far.reach(), Amps::ZERO);
    }

    #[test]
    fn large_currents_saturate_and_invalid_ones_are_zero() {
        let scale = scale(6.0).calibrated(2040.0, 1.0).unwrap();
        for (amps, code) in [
            (7.0, 4095),
            (-7.0, 0),
            (900.0, 4095),
            (-900.0, 0),
            (f32::INFINITY, 2040),
            (f32::NAN, 2040),
            (0.0, 2040),
        ] {
            assert_eq!(scale.code(Amps::new(amps)).get(), code, "{amps}");
        }
        for full in [0.0, -1.0, f32::NAN, 1e-42] {
            assert_eq!(DacScale::new(Amps::new(full)), None, "{full}");
        }
        assert_eq!(DacCode::MIDDLE.get(), 2048);
        for (zero, gain) in [(0.0, 1.0), (5e3, 1.0), (f32::NAN, 1.0), (2048.0, 0.0)] {
            assert_eq!(scale.calibrated(zero, gain), None, "{zero} {gain}");
        }
        assert_eq!(scale.calibrated(2048.0, f32::NAN), None);
    }
}
