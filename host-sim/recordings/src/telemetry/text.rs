//! Telemetry from the log that a tool prints.

use super::{Telemetry, frame, side_lines};

impl Telemetry {
    /// Reads a log. A message can follow a time stamp and a level, and can have colours.
    ///
    /// Of two frames in one line the last one is used. A last line without a line end is incomplete.
    #[must_use]
    pub fn text(log: &[u8]) -> Self {
        let mut telemetry = Self::default();
        let whole = log.iter().rposition(|byte| *byte == b'\n');
        let (whole, half) = log.split_at(whole.map_or(0, |at| at + 1));
        for line in whole.split(|byte| *byte == b'\n') {
            let line = plain(line);
            if !line.is_empty() {
                telemetry.line(message(&line));
            }
        }
        if !half.is_empty() {
            let half = plain(half);
            telemetry
                .malformed
                .push(format!("incomplete line: '{half}'"));
        }
        telemetry
    }
}

/// The message of a line, without the text that a tool puts before it.
fn message(line: &str) -> &str {
    let starts = [frame::START, "boot rate="].into_iter();
    let starts = starts.chain(side_lines::STARTS);
    let at = starts.filter_map(|start| line.rfind(start)).max();
    &line[at.unwrap_or(0)..]
}

/// The text of a line without escape sequences and control characters.
fn plain(line: &[u8]) -> String {
    let line = String::from_utf8_lossy(line);
    let mut pieces = line.split('\u{1b}');
    let mut text = pieces.next().unwrap_or_default().to_owned();
    for piece in pieces {
        // A bracket, parameters, and the letter that ends them.
        let end = piece.find(|c: char| c.is_ascii_alphabetic());
        text.push_str(end.map_or("", |end| &piece[end + 1..]));
    }
    text.trim().to_owned()
}

#[cfg(test)]
mod tests {
    use super::super::frame::tests::LINE;
    use super::*;

    #[test]
    fn messages_are_found_behind_time_stamps_and_colours() {
        let log = format!(
            "      Erasing ✔ 100%\r\n\
             0.000000 [INFO ] boot rate=10000 cause=0 (firmware src/main.rs:50)\r\n\
             \u{1b}[32m0.1 [INFO ]\u{1b}[0m {LINE}\u{1b}[2m (firmware src/telemetry.rs:93)\n\
             └─ firmware::telemetry @ src/telemetry.rs:93\n\
             WARN  garbage bytes=3\n"
        );
        let telemetry = Telemetry::text(log.as_bytes());
        assert_eq!(telemetry.frames, [LINE.parse().unwrap()]);
        assert_eq!(telemetry.boots.len(), 1);
        assert_eq!(
            (telemetry.boots[0].after, telemetry.boots[0].rate_hz),
            (0, 1e4)
        );
        assert_eq!(telemetry.malformed, [""; 0]);
    }

    #[test]
    fn incomplete_lines_and_garbage_are_counted_and_other_lines_are_read() {
        let torn = &LINE[..40];
        let log = format!("large=1 small=2\n{torn}{LINE}\n{torn}\n{LINE}\n{LINE}");
        let mut log = log.into_bytes();
        log.splice(0..0, [0xFF, 0x00, b'\n']);
        let telemetry = Telemetry::text(&log);
        assert_eq!(telemetry.frames.len(), 2);
        assert_eq!(telemetry.malformed.len(), 2, "{:?}", telemetry.malformed);
        assert!(telemetry.malformed[1].starts_with("incomplete line"));
    }
}
