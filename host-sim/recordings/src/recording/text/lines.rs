//! The lines of a file, and the line numbers of its rows.

use std::io::{self, BufRead, Read};

use terminal::failure::Failure;

use super::separator::{bare, is_comment};
use crate::log::cannot_read;

/// Most bytes of a line, which is kept in memory.
const LONGEST: u64 = 1 << 20;

/// What a line must be, for messages.
pub(crate) const LINE_REMEDY: &str = "write one row a line, with the columns that are needed";

/// Reads a file line by line.
pub(crate) struct LineReader<R> {
    inner: R,
    /// The last byte of a line.
    end: u8,
    number: u64,
    /// Whether the last line that was read has no end, as the last one of a log that was cut.
    is_cut: bool,
}

impl<R: BufRead> LineReader<R> {
    pub(crate) fn new(inner: R, end: u8) -> Self {
        Self {
            inner,
            end,
            number: 0,
            is_cut: false,
        }
    }

    /// Whether every byte is read.
    pub(crate) fn is_at_end(&mut self) -> io::Result<bool> {
        Ok(self.inner.fill_buf()?.is_empty())
    }

    /// The number of the last line, if it was read and has no end.
    pub(crate) fn cut(&self) -> Option<u64> {
        self.is_cut.then_some(self.number)
    }

    /// Reads the next line into `line`, without its end, and returns its number, from 1. `None` after the last one.
    pub(crate) fn next(&mut self, line: &mut Vec<u8>) -> io::Result<Option<u64>> {
        line.clear();
        let mut most = self.inner.by_ref().take(LONGEST);
        if most.read_until(self.end, line)? == 0 {
            return Ok(None);
        }
        self.number += 1;
        self.is_cut = line.last() != Some(&self.end);
        if !self.is_cut {
            line.pop();
        } else if most.limit() == 0 {
            return Err(io::Error::other(format!(
                "line {} has no end within {} KiB; {LINE_REMEDY}",
                self.number,
                LONGEST >> 10
            )));
        }
        Ok(Some(self.number))
    }
}

impl<R: BufRead> LineReader<R> {
    /// As [`LineReader::next`], without blank lines and comments, which may follow the stamp of a serial monitor.
    ///
    /// # Errors
    /// [`Failure::Input`] that calls the file `name`.
    pub(crate) fn next_content(
        &mut self,
        line: &mut Vec<u8>,
        name: &str,
    ) -> Result<Option<u64>, Failure> {
        loop {
            let number = self.next(line).map_err(|error| cannot_read(name, &error))?;
            let text = bare(line);
            if number.is_none() || !(text.trim_ascii().is_empty() || is_comment(text)) {
                return Ok(number);
            }
        }
    }
}

/// The line of each row, in few entries: rows follow one another but for comments and blank lines.
#[derive(Clone, Debug, Default)]
pub(crate) struct LineNumbers {
    /// Row and line where a run of adjacent lines begins.
    runs: Vec<(usize, u64)>,
    rows: usize,
}

impl LineNumbers {
    /// Adds the line of the next row.
    pub(crate) fn push(&mut self, line: u64) {
        if self.of(self.rows) != line {
            self.runs.push((self.rows, line));
        }
        self.rows += 1;
    }

    /// The line of `row`; 0 if there is none.
    pub(crate) fn of(&self, row: usize) -> u64 {
        let after = self.runs.partition_point(|(first, _)| *first <= row);
        let run = after.checked_sub(1).and_then(|run| self.runs.get(run));
        run.map_or(0, |(first, line)| line + (row - first) as u64)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A line of the most bytes, its end included, is the longest. A shorter file needs no end of its last line.
    #[test]
    fn a_line_without_an_end_is_refused_by_its_number() {
        let most = LONGEST as usize;
        for (bytes, ends, fits) in [
            (most - 1, true, true),
            (most, true, false),
            (most - 1, false, true),
            (most, false, false),
        ] {
            let mut text = b"ab\n".to_vec();
            text.resize(3 + bytes, b'0');
            text.extend(ends.then_some(b'\n'));
            let mut lines = LineReader::new(text.as_slice(), b'\n');
            let mut line = Vec::new();
            assert_eq!(lines.next(&mut line).unwrap(), Some(1));
            assert_eq!(line, b"ab");
            match lines.next(&mut line) {
                Ok(number) => {
                    assert!(fits, "{bytes} {ends}");
                    assert_eq!((number, line.len()), (Some(2), bytes));
                    assert!(lines.is_at_end().unwrap());
                    assert_eq!(lines.next(&mut line).unwrap(), None);
                }
                Err(error) => {
                    assert!(!fits, "{bytes} {ends}: {error}");
                    let text = "line 2 has no end within 1024 KiB; write one row a line";
                    assert!(error.to_string().starts_with(text), "{error}");
                }
            }
        }
    }

    #[test]
    fn lines_of_rows_are_kept_in_runs() {
        let mut lines = LineNumbers::default();
        let all = [2, 3, 4, 7, 8, 20];
        for line in all {
            lines.push(line);
        }
        assert_eq!(lines.runs.len(), 3);
        for (row, line) in all.into_iter().enumerate() {
            assert_eq!(lines.of(row), line);
        }
    }
}
