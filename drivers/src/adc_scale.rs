//! Conversion of an ADC code to a current.

use estimator_core::Amps;

/// Code of the middle of the range.
const MIDDLE: f32 = 2048.0;

/// Conversion of a 12-bit code to a current: `current = (code - 2048) full_scale / 2048`.
///
/// ```
/// use drivers::AdcScale;
/// use estimator_core::Amps;
/// let scale = AdcScale::new(Amps::new(8.0)).unwrap();
/// assert_eq!(scale.current(2048), Amps::ZERO);
/// assert_eq!(scale.current(0), Amps::new(-8.0));
/// assert_eq!(scale.current(3072), Amps::new(4.0));
/// assert!(AdcScale::new(Amps::ZERO).is_none());
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AdcScale {
    amps_per_code: f32,
}

impl AdcScale {
    /// The conversion for an amplifier whose monitor output reaches the lower end of the ADC's range at
    /// `-full_scale`, and its middle without current. `None` if `full_scale` is not above 0.
    #[must_use]
    pub const fn new(full_scale: Amps) -> Option<Self> {
        let amps_per_code = full_scale.get() / MIDDLE;
        if !(amps_per_code > 0.0 && amps_per_code.is_finite()) {
            return None;
        }
        Some(Self { amps_per_code })
    }

    /// The current of a code.
    #[must_use]
    pub const fn current(&self, code: u16) -> Amps {
        Amps::new((code as f32 - MIDDLE) * self.amps_per_code)
    }
}
