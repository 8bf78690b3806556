//! Frames of commands, with a checksum.

use haptic_control::Request;

/// First byte of a frame.
const START: u8 = 0xA5;
/// Kind and payload.
const BODY: usize = 9;
/// Start, kind, payload, CRC.
const FRAME: usize = BODY + 2;

/// CRC-8 of polynomial 0x07, from 0.
const fn crc8(bytes: &[u8]) -> u8 {
    let mut crc = 0;
    let mut i = 0;
    while i < bytes.len() {
        crc ^= bytes[i];
        let mut bit = 0;
        while bit < 8 {
            crc = if crc & 0x80 == 0 {
                crc << 1
            } else {
                crc << 1 ^ 0x07
            };
            bit += 1;
        }
        i += 1;
    }
    crc
}

/// A command in a frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Command {
    /// A request to the safety state machine.
    Request(Request),
    /// A torque set-point, N·m, for the scene `torque`.
    Torque(f32),
    /// Sets a parameter of a scene.
    Tune {
        /// Number of the scene.
        scene: u8,
        /// Number of the parameter.
        parameter: u8,
        /// Value, in the parameter's unit.
        value: f32,
    },
    /// Selects the estimator of the large motor by its number.
    Estimator(u8),
    /// Asks for the identity of the image: [`Hello`](crate::link::Hello), then
    /// [`Rejected`](crate::link::Rejected). All commands before this one have been processed by then.
    /// It is no keep-alive.
    Identify,
    /// Changes a setting until the next reset, at once; but
    /// [`Setting::Estimator`](crate::Setting::Estimator) acts after a start alone. [`Command::Store`] keeps it.
    Set {
        /// Number of the [`Setting`](crate::Setting).
        setting: u8,
        /// Value, in the setting's unit.
        value: f32,
    },
    /// Asks for all settings, each a [`Setting`](crate::link::Setting). It is no keep-alive.
    Settings,
    /// Stores the settings in flash. The answer is [`Stored`](crate::link::Stored). It is no keep-alive.
    Store,
}

/// The frame of a command: 0xA5, kind, eight bytes of payload, CRC over kind and payload. Numbers
/// are little endian.
///
/// ```
/// use drivers::{Command, encode};
/// use haptic_control::Request;
/// let select = encode(Command::Request(Request::Select(2)));
/// assert_eq!(select, [0xA5, 3, 2, 0, 0, 0, 0, 0, 0, 0, 0xAD]);
/// assert_eq!(encode(Command::Torque(0.5))[..6], [0xA5, 4, 0, 0, 0, 0x3F]);
/// ```
#[must_use]
pub const fn encode(command: Command) -> [u8; FRAME] {
    let body = match command {
        Command::Request(Request::Arm) => [1, 0, 0, 0, 0, 0, 0, 0, 0],
        Command::Request(Request::Disarm) => [2, 0, 0, 0, 0, 0, 0, 0, 0],
        Command::Request(Request::Select(scene)) => [3, scene, 0, 0, 0, 0, 0, 0, 0],
        Command::Torque(value) => {
            let [a, b, c, d] = value.to_le_bytes();
            [4, a, b, c, d, 0, 0, 0, 0]
        }
        Command::Request(Request::KeepAlive) => [5, 0, 0, 0, 0, 0, 0, 0, 0],
        Command::Tune {
            scene,
            parameter,
            value,
        } => {
            let [a, b, c, d] = value.to_le_bytes();
            [6, scene, parameter, a, b, c, d, 0, 0]
        }
        Command::Estimator(number) => [7, number, 0, 0, 0, 0, 0, 0, 0],
        Command::Identify => [8, 0, 0, 0, 0, 0, 0, 0, 0],
        Command::Set { setting, value } => {
            let [a, b, c, d] = value.to_le_bytes();
            [9, setting, a, b, c, d, 0, 0, 0]
        }
        Command::Settings => [10, 0, 0, 0, 0, 0, 0, 0, 0],
        Command::Store => [11, 0, 0, 0, 0, 0, 0, 0, 0],
    };
    let [kind, a, b, c, d, e, f, g, h] = body;
    [START, kind, a, b, c, d, e, f, g, h, crc8(&body)]
}

/// Finds frames in a stream of bytes, in constant memory and time per byte.
///
/// Bytes outside of frames are counted and ignored. After a start byte without a valid frame, the
/// search continues at the next byte.
#[derive(Clone, Copy, Debug, Default)]
pub struct Parser {
    window: [u8; FRAME],
    filled: usize,
    garbage: u32,
}

impl Parser {
    /// Number of bytes outside of frames.
    #[must_use]
    pub const fn garbage(&self) -> u32 {
        self.garbage
    }

    /// Processes a byte and returns the command that it completes.
    pub fn take(&mut self, byte: u8) -> Option<Command> {
        self.window[self.filled] = byte;
        self.filled += 1;
        // What is held begins with a start byte, or is this byte alone.
        if self.filled == FRAME && crc8(&self.window[1..=BODY]) == byte {
            let [_, kind, payload @ .., _] = self.window;
            // Bytes that mean nothing are 0: a torn frame and the start of the next one, whose CRC is
            // right by chance, hardly ever agree.
            let is_whole = |command: &Command| encode(*command) == self.window;
            let command = decode(kind, payload).filter(is_whole);
            if command.is_some() {
                self.filled = 0;
                return command;
            }
        }
        self.skip_to_start();
        None
    }

    /// Discards bytes that cannot begin a frame.
    fn skip_to_start(&mut self) {
        let held = &self.window[..self.filled];
        let full = usize::from(self.filled == FRAME);
        let start = held.iter().skip(full).position(|&byte| byte == START);
        let lost = start.map_or(self.filled, |start| start + full);
        self.window.copy_within(lost.., 0);
        self.filled -= lost;
        self.garbage = self.garbage.wrapping_add(lost as u32);
    }
}

fn decode(kind: u8, payload: [u8; BODY - 1]) -> Option<Command> {
    let [a, b, c, d, e, f, ..] = payload;
    match kind {
        1 => Some(Command::Request(Request::Arm)),
        2 => Some(Command::Request(Request::Disarm)),
        3 => Some(Command::Request(Request::Select(a))),
        4 => Some(Command::Torque(f32::from_le_bytes([a, b, c, d]))),
        5 => Some(Command::Request(Request::KeepAlive)),
        6 => Some(Command::Tune {
            scene: a,
            parameter: b,
            value: f32::from_le_bytes([c, d, e, f]),
        }),
        7 => Some(Command::Estimator(a)),
        8 => Some(Command::Identify),
        9 => Some(Command::Set {
            setting: a,
            value: f32::from_le_bytes([b, c, d, e]),
        }),
        10 => Some(Command::Settings),
        11 => Some(Command::Store),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    #[test]
    fn checksum_agrees_with_the_published_check_value() {
        assert_eq!(super::crc8(b"123456789"), 0xF4);
    }
}
