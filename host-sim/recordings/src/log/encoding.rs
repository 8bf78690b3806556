//! Text in UTF-16, which some programs of Windows write, as UTF-8.

use std::io::{self, Read};

/// First bytes that tell the encoding.
pub(super) const SEARCHED: usize = 256;

/// Bytes that are converted at a time.
const BLOCK: usize = 1 << 13;

/// Order of the bytes of a unit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Utf16 {
    Little,
    Big,
}

impl Utf16 {
    /// The encoding of a text that begins with `head`, with or without a byte order mark: most of its
    /// characters have a byte of zero. `None` for another encoding.
    pub(super) fn of(head: &[u8]) -> Option<Self> {
        match head {
            [0xFF, 0xFE, ..] => return Some(Self::Little),
            [0xFE, 0xFF, ..] => return Some(Self::Big),
            _ => {}
        }
        let head = &head[..head.len().min(SEARCHED)];
        let zeros = |parity: usize| {
            let bytes = head.iter().skip(parity).step_by(2);
            2 * bytes.filter(|byte| **byte == 0).count() > head.len() / 2
        };
        match (zeros(0), zeros(1)) {
            (false, true) => Some(Self::Little),
            (true, false) => Some(Self::Big),
            _ => None,
        }
    }

    const fn unit(self, bytes: [u8; 2]) -> u16 {
        match self {
            Self::Little => u16::from_le_bytes(bytes),
            Self::Big => u16::from_be_bytes(bytes),
        }
    }
}

/// Reads UTF-16 as UTF-8, with U+FFFD for what is no character.
pub(super) struct Converted<R> {
    from: R,
    encoding: Utf16,
    /// Units that are not yet converted: the first half of a pair.
    units: Vec<u16>,
    text: String,
    /// Number of bytes of `text` that are read.
    read: usize,
}

impl<R: Read> Converted<R> {
    pub(super) fn new(from: R, encoding: Utf16) -> Self {
        Self {
            from,
            encoding,
            units: Vec::new(),
            text: String::new(),
            read: 0,
        }
    }

    /// Converts the next bytes. Afterwards the text is empty only at the end.
    fn advance(&mut self) -> io::Result<()> {
        self.text.clear();
        self.read = 0;
        let mut bytes = Vec::new();
        let most = self.from.by_ref().take(BLOCK as u64);
        let is_end = { most }.read_to_end(&mut bytes)? < BLOCK;
        let pairs = bytes.chunks(2).map(|pair| match *pair {
            [one, other] => self.encoding.unit([one, other]),
            _ => char::REPLACEMENT_CHARACTER as u16,
        });
        self.units.extend(pairs);
        let first_half = |unit: &u16| (0xD800..0xDC00).contains(unit);
        let waiting = match self.units.last().filter(|_| !is_end) {
            Some(last) if first_half(last) => self.units.pop(),
            _ => None,
        };
        let found = char::decode_utf16(self.units.drain(..));
        let text = found.map(|found| found.unwrap_or(char::REPLACEMENT_CHARACTER));
        self.text.extend(text);
        self.units.extend(waiting);
        Ok(())
    }
}

impl<R: Read> Read for Converted<R> {
    fn read(&mut self, to: &mut [u8]) -> io::Result<usize> {
        if self.read == self.text.len() {
            self.advance()?;
        }
        let part = &self.text.as_bytes()[self.read..];
        let bytes = part.len().min(to.len());
        to[..bytes].copy_from_slice(&part[..bytes]);
        self.read += bytes;
        Ok(bytes)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn bytes(text: &str, encoding: Utf16) -> Vec<u8> {
        let units = text.encode_utf16();
        match encoding {
            Utf16::Little => units.flat_map(u16::to_le_bytes).collect(),
            Utf16::Big => units.flat_map(u16::to_be_bytes).collect(),
        }
    }

    fn converted(bytes: &[u8], encoding: Utf16) -> String {
        let mut text = String::new();
        let mut from = Converted::new(bytes, encoding);
        from.read_to_string(&mut text).unwrap();
        text
    }

    #[test]
    fn encoding_is_found_with_and_without_a_mark() {
        let text = "t,counts_large\n0,1\n0.001,2\n";
        for encoding in [Utf16::Little, Utf16::Big] {
            assert_eq!(Utf16::of(&bytes(text, encoding)), Some(encoding));
            let marked = bytes("\u{feff}µ", encoding);
            assert_eq!(Utf16::of(&marked), Some(encoding));
        }
        for other in [text.as_bytes(), &[0; 100], b"", b"\xEF\xBB\xBFt"] {
            assert_eq!(Utf16::of(other), None);
        }
        // More than half of the second bytes must be zero.
        for (zeros, found) in [(5, None), (6, Some(Utf16::Little))] {
            let pairs = (0..10).flat_map(|k| [b'a', if k < zeros { 0 } else { b'b' }]);
            assert_eq!(Utf16::of(&pairs.collect::<Vec<_>>()), found);
        }
    }

    /// The first of a pair is the last unit of a block, at the length where that is so.
    #[test]
    fn text_is_the_same_in_any_block() {
        for length in [0, 1, BLOCK / 2 - 2, BLOCK / 2 - 1, BLOCK / 2, BLOCK] {
            let text = format!("{}\u{1D70F}µ\n", "x".repeat(length));
            for encoding in [Utf16::Little, Utf16::Big] {
                assert_eq!(converted(&bytes(&text, encoding), encoding), text);
            }
        }
    }

    #[test]
    fn what_is_no_character_is_replaced() {
        for (bytes, text) in [
            (&[0x61, 0, 0x62][..], "a\u{fffd}"),
            (&[0x61, 0, 0, 0xD8][..], "a\u{fffd}"),
            (&[0, 0xD8, 0x61, 0][..], "\u{fffd}a"),
        ] {
            assert_eq!(converted(bytes, Utf16::Little), text);
        }
    }
}
