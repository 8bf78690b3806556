//! Telemetry of the firmware, from a board or an emulated one: frames, boot lines, other lines.

mod frame;
mod link;
mod run;
mod side_lines;
mod text;

use haptic_control::Fingerprint;

pub use frame::Frame;
pub(crate) use frame::{COLUMNS, Column};
pub use run::{Gaps, Run};
pub use side_lines::{EdgeLine, IndexLine, LearnedLine, MeasuredLine, SideLines};

/// A decoded stream.
#[derive(Clone, Debug, Default)]
pub struct Telemetry {
    /// Frames in order, each with its side lines.
    pub frames: Vec<Frame>,
    /// Starts of the firmware.
    pub boots: Vec<Boot>,
    /// All other lines of the firmware, including boot lines.
    pub log: Vec<String>,
    /// Pieces of the stream that could not be decoded, and frames that could not be parsed.
    pub malformed: Vec<String>,
}

/// A start of the firmware, from its boot line.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Boot {
    /// Number of frames before it.
    pub after: usize,
    /// Control rate, Hz.
    pub rate_hz: f64,
    /// Hash of the device that the image was built for; `None` if the line has none.
    pub device: Option<Fingerprint>,
    /// Hash of the tuned parameters of the image; `None` if the line has none.
    pub presets: Option<Fingerprint>,
}

impl Telemetry {
    /// Adds one message of the firmware.
    pub fn line(&mut self, line: &str) {
        if line.starts_with(frame::START) {
            match line.parse() {
                Ok(frame) => self.frames.push(frame),
                Err(error) => self.malformed.push(error),
            }
            return;
        }
        if side_lines::STARTS
            .iter()
            .any(|start| line.starts_with(start))
        {
            let taken = self.frames.last_mut().map(|frame| frame.take(line));
            self.malformed.extend(taken.and_then(Result::err));
            return;
        }
        if let Some(rate_hz) = boot_rate(line) {
            self.boots.push(Boot {
                after: self.frames.len(),
                rate_hz,
                device: fingerprint(line, "device="),
                presets: fingerprint(line, "presets="),
            });
        }
        self.log.push(line.to_owned());
    }
}

/// Control rate of a line `boot rate=10000 ..`, Hz.
fn boot_rate(line: &str) -> Option<f64> {
    let word = line.strip_prefix("boot rate=")?.split_whitespace().next()?;
    let rate: u32 = word.parse().ok()?;
    (rate > 0).then(|| f64::from(rate))
}

/// The hash after `key` in a boot line: eight hexadecimal digits.
fn fingerprint(line: &str, key: &str) -> Option<Fingerprint> {
    let mut words = line.split_whitespace();
    let digits = words.find_map(|word| word.strip_prefix(key))?;
    u32::from_str_radix(digits, 16).ok().map(Fingerprint)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn boot_line_has_rate_and_hashes() {
        let line =
            "boot rate=10000 cause=0 brown-out-reset=true device=0012abcd presets=ffffffff\n";
        let boot = Telemetry::text(line.as_bytes()).boots[0];
        assert_eq!(boot.rate_hz, 10_000.0);
        assert_eq!(boot.device, Some(Fingerprint(0x0012_ABCD)));
        assert_eq!(boot.presets, Some(Fingerprint(u32::MAX)));
        let old = Telemetry::text(b"boot rate=1000 cause=0\n").boots[0];
        assert_eq!((old.device, old.presets), (None, None));
    }
}
