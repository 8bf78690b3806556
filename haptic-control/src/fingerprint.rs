//! The hash that identifies the constants of an image in a recording.

use core::fmt;

/// A hash of a sequence of numbers and texts: FNV-1a of 32 bits, equal on every machine.
///
/// ```
/// use haptic_control::Fingerprint;
/// const HASH: Fingerprint = Fingerprint::EMPTY.text("foobar");
/// assert_eq!(HASH.to_string(), "bf9cf968"); // the value that the authors of FNV publish
/// assert_ne!(Fingerprint::EMPTY.number(1.0), Fingerprint::EMPTY.number(2.0));
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Fingerprint(pub u32);

impl Fingerprint {
    /// The hash of an empty sequence.
    pub const EMPTY: Self = Self(0x811C_9DC5);

    /// The hash of the sequence with a number appended. Both signs of zero have the same hash.
    #[must_use]
    pub const fn number(self, x: f64) -> Self {
        self.bytes(&(x + 0.0).to_bits().to_le_bytes())
    }

    /// The hash of the sequence with a text appended.
    #[must_use]
    pub const fn text(self, text: &str) -> Self {
        self.bytes(text.as_bytes())
    }

    const fn bytes(mut self, bytes: &[u8]) -> Self {
        let mut rest = bytes;
        while let [byte, others @ ..] = rest {
            self.0 = (self.0 ^ *byte as u32).wrapping_mul(0x0100_0193);
            rest = others;
        }
        self
    }
}

/// Eight hexadecimal digits.
impl fmt::Display for Fingerprint {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{:08x}", self.0)
    }
}
