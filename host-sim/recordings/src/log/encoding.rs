//! Text in UTF-16 or Latin-1, which some programs of Windows write, as UTF-8.

use std::io::{self, Read};

/// First bytes that tell the encoding: lines about the log, and the header.
pub(super) const SEARCHED: usize = 1 << 12;

/// First bytes that tell that a text is in UTF-16.
const OF_UTF16: usize = 256;

/// Bytes that are converted at a time.
const BLOCK: usize = 1 << 13;

/// An encoding that is not UTF-8.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Encoding {
    /// UTF-16, the low byte of a unit first.
    Little,
    /// UTF-16, the high byte of a unit first.
    Big,
    /// One byte a character: its number.
    Latin1,
}

impl Encoding {
    /// The encoding of a text that begins with `head`; `None` for UTF-8, and for what is no text.
    pub(super) fn of(head: &[u8]) -> Option<Self> {
        Self::utf16(head).or_else(|| is_latin1(head).then_some(Self::Latin1))
    }

    /// The order of the bytes of UTF-16, with or without a byte order mark: most characters have a byte of zero.
    pub(super) fn utf16(head: &[u8]) -> Option<Self> {
        match head {
            [0xFF, 0xFE, ..] => return Some(Self::Little),
            [0xFE, 0xFF, ..] => return Some(Self::Big),
            _ => {}
        }
        let head = &head[..head.len().min(OF_UTF16)];
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

    /// Number of bytes of a unit.
    const fn width(self) -> usize {
        match self {
            Self::Little | Self::Big => 2,
            Self::Latin1 => 1,
        }
    }

    /// The unit of UTF-16 of these bytes; U+FFFD if there are too few.
    fn unit(self, bytes: &[u8]) -> u16 {
        match (self, bytes) {
            (Self::Little, &[one, other]) => u16::from_le_bytes([one, other]),
            (Self::Big, &[one, other]) => u16::from_be_bytes([one, other]),
            (Self::Latin1, &[byte]) => byte.into(),
            _ => char::REPLACEMENT_CHARACTER as u16,
        }
    }
}

/// Whether a text that begins with `head` is no UTF-8, and all of it are characters of Latin-1.
fn is_latin1(head: &[u8]) -> bool {
    // A character that is cut at the end is UTF-8, and so is a text with another one and a wrong byte.
    let is_broken = std::str::from_utf8(head).is_err_and(|error| error.error_len().is_some());
    let has_utf8 = head.utf8_chunks().any(|chunk| !chunk.valid().is_ascii());
    let is_character =
        |byte: &u8| matches!(byte, b' '..=b'~' | 0xA0..) || byte.is_ascii_whitespace();
    // Numbers have no such characters: there it is a wrong byte.
    let mut others = head
        .split(|byte| *byte == b'\n')
        .filter(|line| !line.is_ascii());
    let in_words = others.all(|line| line.iter().any(u8::is_ascii_alphabetic));
    is_broken && !has_utf8 && in_words && head.iter().all(is_character)
}

/// Reads another encoding as UTF-8, with U+FFFD for what is no character.
pub(super) struct Converted<R> {
    from: R,
    encoding: Encoding,
    /// Units that are not yet converted: the first half of a pair.
    units: Vec<u16>,
    text: String,
    /// Number of bytes of `text` that are read.
    read: usize,
}

impl<R: Read> Converted<R> {
    pub(super) fn new(from: R, encoding: Encoding) -> Self {
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
        let encoding = self.encoding;
        let units = bytes.chunks(encoding.width());
        self.units.extend(units.map(|bytes| encoding.unit(bytes)));
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

    fn bytes(text: &str, encoding: Encoding) -> Vec<u8> {
        let units = text.encode_utf16();
        match encoding {
            Encoding::Little => units.flat_map(u16::to_le_bytes).collect(),
            Encoding::Big => units.flat_map(u16::to_be_bytes).collect(),
            Encoding::Latin1 => units.map(|unit| unit.try_into().unwrap()).collect(),
        }
    }

    fn converted(bytes: &[u8], encoding: Encoding) -> String {
        let mut text = String::new();
        let mut from = Converted::new(bytes, encoding);
        from.read_to_string(&mut text).unwrap();
        text
    }

    #[test]
    fn encoding_is_found_with_and_without_a_mark() {
        let text = "t,counts_large\n0,1\n0.001,2\n";
        for encoding in [Encoding::Little, Encoding::Big] {
            assert_eq!(Encoding::of(&bytes(text, encoding)), Some(encoding));
            let marked = bytes("\u{feff}µ", encoding);
            assert_eq!(Encoding::of(&marked), Some(encoding));
        }
        for other in [text.as_bytes(), &[0; 100], b"", b"\xEF\xBB\xBFt"] {
            assert_eq!(Encoding::of(other), None);
        }
        // More than half of the second bytes must be zero.
        for (zeros, found) in [(5, None), (6, Some(Encoding::Little))] {
            let pairs = (0..10).flat_map(|k| [b'a', if k < zeros { 0 } else { b'b' }]);
            assert_eq!(Encoding::of(&pairs.collect::<Vec<_>>()), found);
        }
    }

    #[test]
    fn bytes_that_are_no_utf8_are_latin1() {
        let text = "Time (µs),Position (°)\r\n0,1\n";
        let latin1 = bytes(text, Encoding::Latin1);
        assert_eq!(Encoding::of(&latin1), Some(Encoding::Latin1));
        assert_eq!(converted(&latin1, Encoding::Latin1), text);
        for end in [0xA0, 0xFF, b'~', b' ', b'\t'] {
            let head = [&latin1[..], &[b'x', end]].concat();
            assert_eq!(Encoding::of(&head), Some(Encoding::Latin1), "{end}");
        }
        // UTF-8 with a wrong byte, or cut in a character, and what is no text.
        let wrong = [text.as_bytes(), b"\xB5 ".as_slice()].concat();
        for other in [
            text.as_bytes(),
            &wrong,
            b"t,\xC2",
            b"t\xB5\x80 ",
            b"t\xB5\x9F ",
            b"t\xB5\x1F ",
            b"t\xB5\x7F ",
            b"t,\xB5\n0,1\n\xB5,2\n",
        ] {
            assert_eq!(Encoding::of(other), None, "{other:?}");
        }
    }

    /// The first of a pair is the last unit of a block, at the length where that is so.
    #[test]
    fn text_is_the_same_in_any_block() {
        for length in [0, 1, BLOCK / 2 - 2, BLOCK / 2 - 1, BLOCK / 2, BLOCK] {
            let text = format!("{}\u{1D70F}µ\n", "x".repeat(length));
            for encoding in [Encoding::Little, Encoding::Big] {
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
            assert_eq!(converted(bytes, Encoding::Little), text);
        }
    }
}
