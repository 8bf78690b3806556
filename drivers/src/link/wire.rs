//! Numbers and texts as bytes, little endian.

use core::fmt;

use haptic_control::{Mode, Stop};

use super::features::Features;

/// A value of a payload.
pub trait Wire: Copy {
    /// Name of the type in the schema.
    const NAME: &'static str;
    /// Number of bytes.
    const SIZE: usize;

    /// Writes the value and returns the bytes after it; `None` if there is no room.
    fn put(self, to: &mut [u8]) -> Option<&mut [u8]>;

    /// The value at the begin of the bytes, and the bytes after it; `None` if there are too few.
    fn get(from: &[u8]) -> Option<(Self, &[u8])>;
}

macro_rules! numbers {
    ($($type:ident)+) => {$(
        impl Wire for $type {
            const NAME: &'static str = stringify!($type);
            const SIZE: usize = size_of::<Self>();

            fn put(self, to: &mut [u8]) -> Option<&mut [u8]> {
                let (head, rest) = to.split_first_chunk_mut()?;
                *head = self.to_le_bytes();
                Some(rest)
            }

            fn get(from: &[u8]) -> Option<(Self, &[u8])> {
                let (head, rest) = from.split_first_chunk()?;
                Some((Self::from_le_bytes(*head), rest))
            }
        }
    )+};
}
numbers!(u8 u16 u32 i32 f32);

/// 0 or 1; any other byte is read as true.
impl Wire for bool {
    const NAME: &'static str = "bool";
    const SIZE: usize = 1;

    fn put(self, to: &mut [u8]) -> Option<&mut [u8]> {
        u8::from(self).put(to)
    }

    fn get(from: &[u8]) -> Option<(Self, &[u8])> {
        u8::get(from).map(|(byte, rest)| (byte != 0, rest))
    }
}

impl Wire for Features {
    const NAME: &'static str = u32::NAME;
    const SIZE: usize = u32::SIZE;

    fn put(self, to: &mut [u8]) -> Option<&mut [u8]> {
        self.0.put(to)
    }

    fn get(from: &[u8]) -> Option<(Self, &[u8])> {
        u32::get(from).map(|(bits, rest)| (Self(bits), rest))
    }
}

/// Number of bytes of a [`Label`].
const LABEL: usize = 16;

/// A short text in ASCII, padded with zeros.
///
/// ```
/// use drivers::link::Label;
/// assert_eq!(Label::new("0.1.0").as_str(), "0.1.0");
/// assert_eq!(Label::new("more than sixteen bytes").as_str(), "more than sixtee");
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Label([u8; LABEL]);

impl Label {
    /// The first 16 bytes of a text. A byte that is not printable ASCII becomes a question mark.
    #[must_use]
    pub const fn new(text: &str) -> Self {
        let mut label = [0; LABEL];
        let (mut at, mut rest) = (0, text.as_bytes());
        while let [byte, others @ ..] = rest {
            if at == LABEL {
                break;
            }
            label[at] = printable(*byte);
            (at, rest) = (at + 1, others);
        }
        Self(label)
    }

    /// The text.
    #[must_use]
    pub fn as_str(&self) -> &str {
        let end = self.0.iter().position(|byte| *byte == 0);
        let text = self.0.get(..end.unwrap_or(LABEL)).unwrap_or_default();
        core::str::from_utf8(text).unwrap_or_default()
    }
}

impl fmt::Display for Label {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(self.as_str())
    }
}

impl Wire for Label {
    const NAME: &'static str = "text";
    const SIZE: usize = LABEL;

    fn put(self, to: &mut [u8]) -> Option<&mut [u8]> {
        let (head, rest) = to.split_first_chunk_mut()?;
        *head = self.0;
        Some(rest)
    }

    fn get(from: &[u8]) -> Option<(Self, &[u8])> {
        let (head, rest) = from.split_first_chunk::<LABEL>()?;
        let text = |byte: u8| if byte == 0 { 0 } else { printable(byte) };
        Some((Self(head.map(text)), rest))
    }
}

/// A byte of printable ASCII, or a question mark.
const fn printable(byte: u8) -> u8 {
    match byte {
        b' '..=b'~' => byte,
        _ => b'?',
    }
}

/// A type of the list of fields of a telemetry frame, with its type on the link.
pub trait Logged {
    /// The type on the link: the number of a state or a cause; the value of a field that older logs
    /// do not have.
    type Wire: Wire;
}

macro_rules! logged {
    ($($type:ty => $wire:ty;)+) => {$(
        impl Logged for $type {
            type Wire = $wire;
        }
    )+};
}
logged! {
    u8 => u8;
    u16 => u16;
    u32 => u32;
    f32 => f32;
    Mode => u8;
    Stop => u8;
}

impl<T: Logged> Logged for Option<T> {
    type Wire = T::Wire;
}
