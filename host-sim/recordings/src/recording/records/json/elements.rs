//! The elements of JSON lists and objects in any layout, one a line.

use std::io::{self, Read};

/// Bytes that are read at a time.
const BLOCK: usize = 1 << 13;

/// Reads a text with JSON as one with an element a line.
///
/// An element that is an object stays an object; one that is a list, or a tuple as Python prints it, becomes its values,
/// separated by commas.
/// Its line is the one in which it begins, or the one after that of the element before if this is later: elements
/// in one line are numbered from it.
pub(super) struct Elements<R> {
    from: R,
    /// Number of lists around an element.
    around: u32,
    /// Lines before the JSON that are still to be passed on.
    before: usize,
    /// Byte that ends a line.
    end: u8,
    /// Number of lists and objects around the next byte.
    depth: u32,
    is_quoted: bool,
    is_escaped: bool,
    /// Whether the line that is written has a byte, and the last one.
    is_begun: bool,
    last: u8,
    /// Lines that were read more than written.
    behind: i64,
    text: Vec<u8>,
    /// Number of bytes of `text` that are read.
    read: usize,
}

impl<R: Read> Elements<R> {
    /// Reads from a text with `before` lines before the JSON, whose elements are inside of `around` lists.
    pub(super) fn new(from: R, end: u8, before: usize, around: u32) -> Self {
        Self {
            from,
            around,
            before,
            end,
            depth: 0,
            is_quoted: false,
            is_escaped: false,
            is_begun: false,
            last: b'\n',
            behind: 0,
            text: Vec::new(),
            read: 0,
        }
    }

    fn step(&mut self, byte: u8) {
        let byte = if byte == self.end { b'\n' } else { byte };
        if self.before > 0 {
            self.text.push(byte);
            self.before -= usize::from(byte == b'\n');
        } else if self.is_quoted {
            self.write(byte);
            self.is_quoted = byte != b'"' || self.is_escaped;
            self.is_escaped = byte == b'\\' && !self.is_escaped;
        } else {
            self.step_unquoted(byte);
        }
    }

    fn step_unquoted(&mut self, byte: u8) {
        let inside = self.depth.checked_sub(self.around);
        match byte {
            b'\n' => self.end_of_line(),
            b' ' | b'\t' | b'\r' => self.space(),
            b',' if inside == Some(0) => {}
            b'{' | b'[' | b'(' => {
                if inside.is_some_and(|inside| inside > 0 || byte == b'{') {
                    self.write(byte);
                }
                self.depth += 1;
            }
            b'}' | b']' | b')' => {
                if inside.is_some_and(|inside| inside > 1 || (inside == 1 && byte == b'}')) {
                    self.write(byte);
                }
                self.depth = self.depth.saturating_sub(1);
                if inside == Some(1) {
                    self.end_element();
                }
            }
            _ => {
                self.is_quoted = byte == b'"';
                self.write(byte);
            }
        }
    }

    fn write(&mut self, byte: u8) {
        self.is_begun = true;
        self.last = byte;
        self.text.push(if byte == b'\n' { b' ' } else { byte });
    }

    /// Keeps numbers apart that no comma separates. A quote is one only at the begin of a field.
    fn space(&mut self) {
        if self.is_begun && self.last != b',' {
            self.write(b' ');
        }
    }

    fn end_element(&mut self) {
        self.is_begun = false;
        self.text.push(b'\n');
        self.behind -= 1;
        self.catch_up();
    }

    fn end_of_line(&mut self) {
        self.behind += 1;
        if !self.is_begun {
            self.catch_up();
        } else if self.depth > self.around {
            self.space();
        } else {
            self.end_element();
        }
    }

    fn catch_up(&mut self) {
        while self.behind > 0 {
            self.text.push(b'\n');
            self.behind -= 1;
        }
    }
}

/// Number of elements that begin in `text`, which has no list around them.
pub(super) fn count(text: &str) -> usize {
    let mut elements = Elements::new(io::empty(), b'\n', 0, 0);
    text.bytes().for_each(|byte| elements.step(byte));
    let lines = elements.text.split(|byte| *byte == b'\n');
    lines.filter(|line| !line.is_empty()).count()
}

impl<R: Read> Read for Elements<R> {
    fn read(&mut self, to: &mut [u8]) -> io::Result<usize> {
        while self.read == self.text.len() {
            self.text.clear();
            self.read = 0;
            let mut block = [0; BLOCK];
            let bytes = self.from.read(&mut block)?;
            if bytes == 0 {
                return Ok(0);
            }
            for byte in &block[..bytes] {
                self.step(*byte);
            }
        }
        let bytes = (&self.text[self.read..]).read(to)?;
        self.read += bytes;
        Ok(bytes)
    }
}
