//! Commands: framed, checksummed, bounded.

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

/// The frame of a request: 0xA5, kind, eight bytes of payload, CRC over kind and payload.
///
/// ```
/// use drivers::encode;
/// use haptic_control::Request;
/// assert_eq!(encode(Request::Select(2)), [0xA5, 3, 2, 0, 0, 0, 0, 0, 0, 0, 0xAD]);
/// ```
#[must_use]
pub const fn encode(request: Request) -> [u8; FRAME] {
    let (kind, first) = match request {
        Request::Arm => (1, 0),
        Request::Disarm => (2, 0),
        Request::Select(scene) => (3, scene),
        Request::KeepAlive => (5, 0),
    };
    let crc = crc8(&[kind, first, 0, 0, 0, 0, 0, 0, 0]);
    [START, kind, first, 0, 0, 0, 0, 0, 0, 0, crc]
}

/// Finds frames in a stream of bytes, in constant memory and time per byte.
///
/// What is no frame is counted and ignored: a start byte with a wrong CRC costs itself, and the
/// search goes on at the byte after it.
#[derive(Clone, Copy, Debug, Default)]
pub struct Parser {
    window: [u8; FRAME],
    filled: usize,
    garbage: u32,
}

impl Parser {
    /// Bytes that belonged to no frame.
    #[must_use]
    pub const fn garbage(&self) -> u32 {
        self.garbage
    }

    /// Takes a byte; the request, if it completes one.
    pub fn take(&mut self, byte: u8) -> Option<Request> {
        self.window[self.filled] = byte;
        self.filled += 1;
        // What is held begins with a start byte, or is this byte alone.
        if self.filled == FRAME && crc8(&self.window[1..=BODY]) == byte {
            self.filled = 0;
            let request = decode(self.window[1], self.window[2]);
            if request.is_none() {
                self.garbage = self.garbage.wrapping_add(FRAME as u32);
            }
            return request;
        }
        self.skip_to_start();
        None
    }

    /// Throws away what cannot begin a frame.
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

fn decode(kind: u8, first: u8) -> Option<Request> {
    match kind {
        1 => Some(Request::Arm),
        2 => Some(Request::Disarm),
        3 => Some(Request::Select(first)),
        5 => Some(Request::KeepAlive),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    #[test]
    fn the_checksum_is_that_of_the_catalogue() {
        assert_eq!(super::crc8(b"123456789"), 0xF4);
    }
}
