//! Separators of a table of text, and its lines without comments.

use std::cell::{OnceCell, RefCell};
use std::io::{self, BufRead, Read};

use csv_core::{ReadRecordResult, Reader, ReaderBuilder};

use super::lines::LineReader;
use super::row_ends;
use crate::recording::layout::Layout;

/// What separates the fields of a line.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Separator {
    Comma,
    Semicolon,
    Tab,
    /// Any number of spaces and tabs.
    Whitespace,
}

impl Separator {
    /// In the order in which they are tried on a line of numbers: where fields are separated by a tab
    /// or a semicolon, a comma may be a decimal comma.
    pub(crate) const ALL: [Self; 4] = [Self::Tab, Self::Semicolon, Self::Comma, Self::Whitespace];

    /// The byte that separates the fields of [`Lines`].
    pub(crate) const fn byte(self) -> u8 {
        match self {
            Self::Comma => b',',
            Self::Semicolon => b';',
            Self::Tab | Self::Whitespace => b'\t',
        }
    }

    /// Name in messages.
    pub(crate) const fn name(self) -> &'static str {
        match self {
            Self::Comma => "','",
            Self::Semicolon => "';'",
            Self::Tab => "tabs",
            Self::Whitespace => "spaces",
        }
    }

    /// Whether a comma in a number is a decimal comma.
    pub(crate) fn allows_decimal_comma(self) -> bool {
        self != Self::Comma
    }

    /// The fields of one line, without spaces around them, and without quotes: a space may precede these.
    pub(crate) fn split(self, line: &str) -> Vec<String> {
        if self == Self::Whitespace {
            return line.split_whitespace().map(str::to_owned).collect();
        }
        let Some(record) = self.record(line.as_bytes()) else {
            return Vec::new();
        };
        let text = |field: &[u8]| {
            let text = String::from_utf8_lossy(field);
            let quoted = text
                .strip_prefix('"')
                .and_then(|text| text.strip_suffix('"'));
            quoted.unwrap_or(&text).to_owned()
        };
        let fields = record.fields();
        fields.map(|field| text(field.trim_ascii())).collect()
    }

    /// The fields of one line; `None` for an empty one.
    fn record(self, line: &[u8]) -> Option<Record> {
        // The tables of a reader take longer to make than a thousand lines to read. Its clone lacks them (csv-core
        // 0.1.13).
        thread_local! {
            static READERS: [OnceCell<RefCell<Reader>>; Separator::ALL.len()] =
                const { [const { OnceCell::new() }; Separator::ALL.len()] };
        }
        READERS.with(|readers| {
            let new = || ReaderBuilder::new().delimiter(self.byte()).build();
            let reader = readers[self as usize].get_or_init(|| RefCell::new(new()));
            let mut reader = reader.borrow_mut();
            reader.reset();
            Record::read(&mut reader, line)
        })
    }
}

/// Fields of a line, one behind the other, and their ends.
struct Record {
    text: Vec<u8>,
    ends: Vec<usize>,
}

impl Record {
    /// Reads a line; `None` if it is empty.
    fn read(reader: &mut Reader, line: &[u8]) -> Option<Self> {
        // As long as every field of the line with its end.
        let mut text = vec![0; line.len() + 1];
        let mut ends = vec![0; line.len() + 1];
        let (mut written, mut ended, mut rest) = (0, 0, line);
        loop {
            let (result, read, more, fields) =
                reader.read_record(rest, &mut text[written..], &mut ends[ended..]);
            rest = &rest[read..];
            written += more;
            ended += fields;
            match result {
                ReadRecordResult::Record => {
                    text.truncate(written);
                    ends.truncate(ended);
                    return Some(Self { text, ends });
                }
                ReadRecordResult::InputEmpty => {}
                _ => return None,
            }
        }
    }

    fn fields(&self) -> impl Iterator<Item = &[u8]> {
        let starts = [0].into_iter().chain(self.ends.iter().copied());
        starts
            .zip(&self.ends)
            .map(|(start, &end)| &self.text[start..end])
    }
}

/// The text of a comment, without its mark; `None` for a line that is no comment.
pub(crate) fn comment(line: &str) -> Option<&str> {
    let line = line.trim_start();
    let marks = ["#", "%", "//"];
    let text = marks.iter().find_map(|mark| line.strip_prefix(mark))?;
    Some(text.trim_start_matches(['#', '%', '/']).trim_start())
}

/// Whether a line is a comment.
pub(crate) fn is_comment(line: &[u8]) -> bool {
    let line = line.trim_ascii_start();
    matches!(line, [b'#' | b'%', ..] | [b'/', b'/', ..])
}

/// Length of the time stamp that a serial monitor writes before a line, as in `12:00:00.000 -> 1,2` (Arduino
/// IDE), `12:00:00.000 > 1,2` (PlatformIO) and `[2025-03-01 12:00:00.000] 1,2` (terminal programs); 0 for a line
/// without one.
pub(crate) fn stamp(line: &[u8]) -> usize {
    const FORMS: [&[u8]; 2] = [b"00:00:00.000 -> ", b"00:00:00.000 > "];
    let fits = |(&byte, form): (&u8, &u8)| match form {
        b'0' => byte.is_ascii_digit(),
        mark => byte == *mark,
    };
    let is_of = |form: &&[u8]| line.len() >= form.len() && line.iter().zip(*form).all(fits);
    let of_form = FORMS.into_iter().find(is_of).map(<[u8]>::len);
    of_form.or_else(|| bracketed(line)).unwrap_or(0)
}

/// Length of a date or a time in brackets, and the space after it.
fn bracketed(line: &[u8]) -> Option<usize> {
    /// Most bytes in the brackets.
    const LONGEST: usize = 32;
    let inside = line.strip_prefix(b"[")?;
    let length = inside.iter().take(LONGEST).position(|byte| *byte == b']')?;
    let time = &inside[..length];
    let is_of_time = |byte: &u8| byte.is_ascii_digit() || b"-/:., T".contains(byte);
    let is_time = time.iter().all(is_of_time) && time.contains(&b':');
    (is_time && inside.get(length + 1) == Some(&b' ')).then_some(length + 3)
}

/// A line without the stamp of a serial monitor and the carriage return at its end.
pub(crate) fn bare(line: &[u8]) -> &[u8] {
    let line = line.strip_suffix(b"\r").unwrap_or(line);
    &line[stamp(line)..]
}

/// Text with its stamps of a serial monitor, its comments, its blank lines and its first lines emptied, so that the lines keep their
/// numbers. Every line ends with a line feed. Runs of spaces become tabs where they separate fields.
pub(crate) struct Lines<R> {
    inner: LineReader<R>,
    separator: Separator,
    /// Number of first lines that are emptied.
    skip: u64,
    /// Whether a separator of its own ends each row.
    has_row_ends: bool,
    line: Vec<u8>,
    /// Number of bytes of `line` that are read.
    read: usize,
}

impl<R: BufRead> Lines<R> {
    pub(crate) fn new(inner: R, separator: Separator, skip: u64, end: u8) -> Self {
        Self {
            inner: LineReader::new(inner, end),
            separator,
            skip,
            has_row_ends: false,
            line: Vec::new(),
            read: 0,
        }
    }

    /// The lines of a text of this layout.
    pub(crate) fn of(inner: R, layout: &Layout, end: u8) -> Self {
        Self {
            has_row_ends: layout.has_row_ends,
            ..Self::new(inner, layout.separator, layout.skip, end)
        }
    }

    /// The number of the last line, if it was read and has no end.
    pub(crate) fn cut(&self) -> Option<u64> {
        self.inner.cut()
    }

    /// Reads the next line.
    fn advance(&mut self) -> io::Result<()> {
        self.read = 0;
        self.inner.next(&mut self.line)?;
        let skipped = self.skip > 0;
        self.skip = self.skip.saturating_sub(1);
        if self.line.last() == Some(&b'\r') {
            self.line.pop();
        }
        self.line.drain(..stamp(&self.line));
        if self.has_row_ends {
            let text = String::from_utf8_lossy(&self.line);
            self.line = row_ends::cut(&text).as_bytes().to_vec();
        }
        if skipped || is_comment(&self.line) || self.line.trim_ascii().is_empty() {
            self.line.clear();
        } else if self.separator == Separator::Whitespace {
            let fields = self.line.split(u8::is_ascii_whitespace);
            let fields: Vec<_> = fields.filter(|field| !field.is_empty()).collect();
            self.line = fields.join(&b'\t');
        }
        self.line.push(b'\n');
        Ok(())
    }
}

impl<R: BufRead> Read for Lines<R> {
    fn read(&mut self, to: &mut [u8]) -> io::Result<usize> {
        let mut filled = 0;
        while filled < to.len() {
            if self.read == self.line.len() {
                if self.inner.is_at_end()? {
                    break;
                }
                self.advance()?;
            }
            let part = &self.line[self.read..];
            let bytes = part.len().min(to.len() - filled);
            to[filled..filled + bytes].copy_from_slice(&part[..bytes]);
            filled += bytes;
            self.read += bytes;
        }
        Ok(filled)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn lines(text: &str, separator: Separator, skip: u64) -> String {
        let mut read = String::new();
        Lines::new(text.as_bytes(), separator, skip, b'\n')
            .read_to_string(&mut read)
            .unwrap();
        read
    }

    #[test]
    fn a_space_may_precede_a_quote() {
        let fields = |line| Separator::Comma.split(line);
        assert_eq!(fields(r#""a, b","c""#), ["a, b", "c"]);
        assert_eq!(fields(r#" "t", "counts" ,"""#), ["t", "counts", ""]);
        assert_eq!(fields("3\", \"4, \""), ["3\"", "\"4", "\""]);
    }

    #[test]
    fn comments_are_emptied_and_lines_keep_their_numbers() {
        let text = "head\n# a\n  % b\n1,2\r\n// c\n   \n3,4 # no comment\n#";
        let read = "\n\n\n1,2\n\n\n3,4 # no comment\n\n";
        assert_eq!(lines(text, Separator::Comma, 1), read);
    }

    #[test]
    fn stamps_of_a_serial_monitor_are_cut_off() {
        let text = "12:00:00.001 -> # a\n12:00:00.002 > 1,2\n12:00:00.003 -> \n[2025-03-01 12:00:00.004] 3,4\n";
        assert_eq!(lines(text, Separator::Comma, 0), "\n1,2\n\n3,4\n");
        for text in [
            "12:00:00.001 ->",
            "12:00:00,001 -> 1",
            "12:00:00.0011 -> 1",
            "x2:00:00.001 -> 1",
            "[1,2] 3",
            "[12:00:00]3",
            "[12:00:00 3",
            "[at 12:00:00] 3",
        ] {
            assert_eq!(stamp(text.as_bytes()), 0, "{text}");
        }
    }

    #[test]
    fn lines_that_end_with_a_carriage_return_are_read() {
        let mut read = String::new();
        let mut lines = Lines::new(&b"h\r1,2\r# c\r3,4"[..], Separator::Comma, 1, b'\r');
        lines.read_to_string(&mut read).unwrap();
        assert_eq!(read, "\n1,2\n\n3,4\n");
    }

    #[test]
    fn runs_of_spaces_separate_fields() {
        let text = "  1   2\t\t3 \r\n4 5 6";
        assert_eq!(lines(text, Separator::Whitespace, 0), "1\t2\t3\n4\t5\t6\n");
    }

    #[test]
    fn text_is_read_whole_into_a_small_buffer() {
        let text = "1,2\n# long comment\n\n3,4\n5,6";
        let mut reader = Lines::new(text.as_bytes(), Separator::Comma, 0, b'\n');
        let mut read = Vec::new();
        let mut buffer = [0; 3];
        loop {
            let bytes = reader.read(&mut buffer).unwrap();
            if bytes == 0 {
                break;
            }
            read.extend_from_slice(&buffer[..bytes]);
        }
        assert_eq!(read, b"1,2\n\n\n3,4\n5,6\n");
    }

    #[test]
    fn comments_are_found_by_their_marks() {
        assert_eq!(comment("# t,x"), Some("t,x"));
        assert_eq!(comment(" %% t"), Some("t"));
        assert_eq!(comment("//t"), Some("t"));
        assert_eq!(comment("/ t"), None);
        assert_eq!(comment("t"), None);
    }
}
