//! Certainty that the amplifiers are disabled, at the lowest priority.

use crate::commands::WAITING;
use crate::config::{AUTO_ARM, RATE_HZ};
use crate::telemetry::{DEPTH, Record};

/// Frames without an enabled amplifier after which a request to arm has been refused. Fewer frames than
/// [`DEPTH`] wait to be logged when the request is passed on. It is the last of the messages that wait for the
/// control task, which takes at least one in the period of a frame.
const FRAMES: usize = DEPTH + WAITING;
/// Control ticks in which an image that arms by itself does so, 0.2 s.
const ARMS: u32 = RATE_HZ / 5;

/// Whether the amplifiers are disabled, and stay so until the next command is passed on.
#[derive(Debug, Default)]
pub struct Rest {
    /// Latest frames without an enabled amplifier.
    frames: usize,
}

impl Rest {
    /// Notes a request to arm.
    pub fn arms(&mut self) {
        self.frames = 0;
    }

    /// Notes the record of a frame.
    pub fn frame(&mut self, record: &Record) {
        let arms = AUTO_ARM && record.tick < ARMS;
        self.frames = if record.state.is_enabled() || arms {
            0
        } else {
            self.frames.saturating_add(1)
        };
    }

    /// Whether it is certain.
    #[must_use]
    pub const fn is_certain(&self) -> bool {
        self.frames >= FRAMES
    }
}
