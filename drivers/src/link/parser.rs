//! Messages out of a stream of bytes.

use super::{CRC, HEADER, LONGEST, LONGEST_PAYLOAD, Message, START, crc16};

/// Finds messages in a stream of bytes, in constant memory and bounded time per byte.
///
/// Bytes outside of frames are counted and ignored. After a start byte without a valid frame, the
/// search continues at the next byte, so that a damaged frame hides no frame after it. A valid frame
/// whose kind or length is not of this protocol is counted and ignored.
#[derive(Clone, Copy, Debug)]
pub struct Parser {
    /// Bytes that may begin a frame: the first one is a start byte, if there is any.
    window: [u8; LONGEST],
    filled: usize,
    garbage: u32,
    foreign: u32,
}

impl Default for Parser {
    fn default() -> Self {
        Self {
            window: [0; LONGEST],
            filled: 0,
            garbage: 0,
            foreign: 0,
        }
    }
}

impl Parser {
    /// Number of bytes outside of frames, modulo 2^32.
    #[must_use]
    pub const fn garbage(&self) -> u32 {
        self.garbage
    }

    /// Number of valid frames that are not of this protocol, modulo 2^32.
    #[must_use]
    pub const fn foreign(&self) -> u32 {
        self.foreign
    }

    /// Processes a byte and hands over the messages that it completes. After a false start there may
    /// be several.
    pub fn take(&mut self, byte: u8, mut found: impl FnMut(Message)) {
        self.window[self.filled] = byte;
        self.filled += 1;
        while let Some(frame) = self.held().first_chunk::<HEADER>() {
            let [start, kind, length] = *frame;
            let payload = usize::from(length);
            let whole = HEADER + payload + CRC;
            let is_possible = start == START && payload <= LONGEST_PAYLOAD;
            if is_possible && self.filled < whole {
                return;
            }
            if is_possible && self.is_valid(whole) {
                match Message::decode(kind, &self.held()[HEADER..whole - CRC]) {
                    Some(message) => found(message),
                    None => self.foreign = self.foreign.wrapping_add(1),
                }
                self.discard(whole);
            } else {
                self.skip_to_start();
            }
        }
        if self.held().first().is_some_and(|byte| *byte != START) {
            self.skip_to_start();
        }
    }

    /// The bytes that wait.
    fn held(&self) -> &[u8] {
        &self.window[..self.filled]
    }

    /// Whether the checksum of the first `whole` bytes is right.
    fn is_valid(&self, whole: usize) -> bool {
        let (body, crc) = self.held()[1..whole].split_at(whole - 1 - CRC);
        crc16(body).to_le_bytes() == crc
    }

    /// Discards the first byte and all that cannot begin a frame.
    fn skip_to_start(&mut self) {
        let next = self.held().iter().skip(1).position(|byte| *byte == START);
        let lost = next.map_or(self.filled, |next| next + 1);
        self.garbage = self.garbage.wrapping_add(lost as u32);
        self.discard(lost);
    }

    fn discard(&mut self, bytes: usize) {
        self.window.copy_within(bytes..self.filled, 0);
        self.filled -= bytes;
    }
}
