//! Conversion of an ADC code to the voltage at a divider.

use haptic_control::Volts;

/// Conversion of a 12-bit code to the voltage u that a divider of the given ratio brings to the input:
/// `u = code ratio reference / 4096`, with the reference voltage of the converter.
///
/// ```
/// use drivers::Divider;
/// use haptic_control::Volts;
/// // 22 kΩ above 2 kΩ.
/// let divider = Divider::new(12.0, 3.0).unwrap();
/// assert_eq!(divider.voltage(0), Volts(0.0));
/// assert_eq!(divider.voltage(1024), Volts(9.0));
/// assert!(Divider::new(0.5, 3.0).is_none());
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Divider {
    volts_per_code: f32,
}

impl Divider {
    /// A divider of the input's voltage by `ratio`, at a converter with this reference, V. `None` if the
    /// ratio is below 1 or the reference is not above 0.
    #[must_use]
    pub const fn new(ratio: f32, reference: f32) -> Option<Self> {
        let volts_per_code = ratio * reference / 4096.0;
        if !(ratio >= 1.0 && reference > 0.0 && volts_per_code.is_finite()) {
            return None;
        }
        Some(Self { volts_per_code })
    }

    /// The voltage of a code.
    #[must_use]
    pub const fn voltage(&self, code: u16) -> Volts {
        Volts(code as f32 * self.volts_per_code)
    }
}
