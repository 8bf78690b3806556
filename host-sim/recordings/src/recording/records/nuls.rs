//! NUL bytes in a text, as a terminal program writes them while a board starts.

use std::io::{self, Read};

/// Line of the first NUL byte of a text that begins with `head`.
pub(super) fn line(head: &[u8]) -> Option<u64> {
    let first = head.iter().position(|byte| *byte == 0)?;
    let above = head[..first].iter().filter(|byte| **byte == b'\n');
    Some(1 + above.count() as u64)
}

/// Reads bytes without NUL.
pub(super) struct Without<R>(pub(super) R);

impl<R: Read> Read for Without<R> {
    fn read(&mut self, to: &mut [u8]) -> io::Result<usize> {
        loop {
            let bytes = self.0.read(to)?;
            let mut kept = 0;
            for k in 0..bytes {
                to[kept] = to[k];
                kept += usize::from(to[k] != 0);
            }
            // No bytes are the end.
            if kept > 0 || bytes == 0 {
                return Ok(kept);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use crate::recording::read_log as read;

    #[test]
    fn nul_bytes_of_a_text_are_not_read() {
        let rows = |from: u32| -> String {
            (from..from + 9000)
                .map(|k| format!("{k},{}\n", 8 * k))
                .collect()
        };
        let zeros = |number| "\0".repeat(number);
        let text = format!(
            "a log\n{}time_ms,counts\n{}{}{}",
            zeros(80),
            rows(0),
            zeros(7),
            rows(9000)
        );
        let recording = read(&text, "").unwrap();
        assert_eq!(recording.t.len(), 18_000);
        assert_eq!(
            recording.trace.counts_large[8999..9001],
            [8 * 8999, 8 * 9000]
        );
        let said = "NUL bytes in the text are not read, the first in line 2";
        assert!(
            recording.notes.iter().any(|note| note == said),
            "{:?}",
            recording.notes
        );
        // However many stand before the text.
        let recording = read(&format!("{}time_ms,counts\n{}", zeros(5000), rows(0)), "").unwrap();
        assert_eq!(recording.trace.counts_large[8999], 8 * 8999);
        for text in [format!("a log\n{}", zeros(80)), zeros(80)] {
            let error = read(&text, "").unwrap_err();
            assert_eq!(
                error,
                "r.csv: line 1: the file is not text; write it as CSV"
            );
        }
    }
}
