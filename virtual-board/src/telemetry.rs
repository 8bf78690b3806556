//! Telemetry of the image: defmt frames out of RTT.

use std::str::FromStr;

use defmt_decoder::{DecodeError, Table};

/// What the firmware says of one control tick.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Frame {
    /// Sequence number.
    pub seq: u32,
    /// Control tick.
    pub tick: u32,
    /// Large encoder.
    pub large: u32,
    /// Small encoder.
    pub small: u32,
    /// Velocity of the large motor, rad/s.
    pub wl: f32,
    /// Velocity of the handle, rad/s.
    pub ws: f32,
    /// Torque that the handle should feel, N.m.
    pub torque: f32,
    /// Current of the large motor, A.
    pub il: f32,
    /// Current of the small motor, A.
    pub is: f32,
    /// State of the safety machine.
    pub state: String,
    /// Why it stopped.
    pub cause: String,
    /// Ticks missed or late.
    pub overruns: u32,
    /// Frames lost.
    pub drops: u32,
    /// Cycles of the control task.
    pub cycles: u32,
}

impl FromStr for Frame {
    type Err = String;

    fn from_str(line: &str) -> Result<Self, String> {
        let mut frame = Self::default();
        let mut seen = 0;
        for word in line.split_whitespace().skip(1) {
            let (name, value) = word
                .split_once('=')
                .ok_or_else(|| format!("'{word}' has no value in '{line}'"))?;
            let known = match name {
                "seq" => number(&mut frame.seq, value),
                "tick" => number(&mut frame.tick, value),
                "large" => number(&mut frame.large, value),
                "small" => number(&mut frame.small, value),
                "wl" => number(&mut frame.wl, value),
                "ws" => number(&mut frame.ws, value),
                "torque" => number(&mut frame.torque, value),
                "il" => number(&mut frame.il, value),
                "is" => number(&mut frame.is, value),
                "overruns" => number(&mut frame.overruns, value),
                "drops" => number(&mut frame.drops, value),
                "cycles" => number(&mut frame.cycles, value),
                "state" => text(&mut frame.state, value),
                "cause" => text(&mut frame.cause, value),
                _ => continue,
            };
            if !known {
                return Err(format!("'{word}' is no number in '{line}'"));
            }
            seen += 1;
        }
        if seen == 14 {
            Ok(frame)
        } else {
            Err(format!("{seen} of 14 fields in '{line}'"))
        }
    }
}

fn number<T: FromStr>(into: &mut T, value: &str) -> bool {
    value.parse().map(|value| *into = value).is_ok()
}

fn text(into: &mut String, value: &str) -> bool {
    value.clone_into(into);
    true
}

/// A decoded stream.
#[derive(Clone, Debug, Default)]
pub struct Telemetry {
    /// Frames in order.
    pub frames: Vec<Frame>,
    /// Everything else that the firmware said.
    pub log: Vec<String>,
    /// Pieces that could not be decoded, and frames that could not be read.
    pub malformed: Vec<String>,
}

impl Telemetry {
    /// Decodes what came out of up channel 0 of the image `elf`.
    ///
    /// # Errors
    /// One line on an image without defmt, or with another version's.
    pub fn decode(elf: &[u8], bytes: &[u8]) -> Result<Self, String> {
        let table = Table::parse(elf)
            .map_err(|error| format!("defmt: {error}"))?
            .ok_or("the image has no defmt table")?;
        let mut decoder = table.new_stream_decoder();
        let mut telemetry = Self::default();
        // In pieces: the decoder shifts its buffer for each frame.
        for piece in bytes.chunks(256) {
            decoder.received(piece);
            loop {
                match decoder.decode() {
                    Ok(frame) => telemetry.line(&frame.display_message().to_string()),
                    Err(DecodeError::UnexpectedEof) => break,
                    Err(DecodeError::Malformed) => {
                        telemetry
                            .malformed
                            .push("a frame that defmt cannot decode".to_owned());
                        if !table.encoding().can_recover() {
                            return Ok(telemetry);
                        }
                    }
                }
            }
        }
        Ok(telemetry)
    }

    fn line(&mut self, line: &str) {
        if !line.starts_with("frame ") {
            self.log.push(line.to_owned());
            return;
        }
        match line.parse() {
            Ok(frame) => self.frames.push(frame),
            Err(error) => self.malformed.push(error),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const LINE: &str = "frame seq=3 tick=30 large=65535 small=7 wl=-1.5 ws=0.25 torque=0.0 \
        il=0.1 is=-0.2 state=Running cause=None overruns=0 drops=1 cycles=900";

    #[test]
    fn a_frame_is_read_by_names() {
        let frame: Frame = LINE.parse().unwrap();
        assert_eq!((frame.tick, frame.large, frame.drops), (30, 65535, 1));
        assert_eq!((frame.wl, frame.state.as_str()), (-1.5, "Running"));
    }

    #[test]
    fn a_frame_that_lacks_something_is_refused_with_a_reason() {
        let without = LINE.replace("drops=1 ", "");
        assert!(without.parse::<Frame>().unwrap_err().contains("13 of 14"));
        let wrong = LINE.replace("wl=-1.5", "wl=x");
        assert!(wrong.parse::<Frame>().unwrap_err().contains("'wl=x'"));
    }
}
