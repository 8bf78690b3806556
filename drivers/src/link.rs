//! The link from the board to a host: messages in frames with a checksum.
//!
//! A frame is a start byte, the kind of its message, the length of the payload, the payload, and a
//! CRC-16 over kind, length and payload. Numbers are little endian. Commands from the host to the board
//! have frames of their own, see [`Command`](crate::Command).
//!
//! ```
//! use drivers::link::{LONGEST, Message, Parser, Reference};
//! let mut buffer = [0; LONGEST];
//! let message = Message::Reference(Reference { seq: 7, count: 300 });
//! let bytes = message.encode(&mut buffer).unwrap();
//! assert_eq!(bytes[..7], [0x5A, 5, 8, 7, 0, 0, 0]);
//! let mut parser = Parser::default();
//! let mut found = None;
//! for byte in bytes {
//!     parser.take(*byte, |message| found = Some(message));
//! }
//! assert_eq!(found, Some(message));
//! ```

mod features;
mod messages;
mod parser;
mod wire;

pub use features::{FEATURES, Features};
pub use messages::{
    Edge, FieldFacts, Frame, Hello, Index, Learned, Measured, Message, MessageFacts, Reference,
    Rejected, SCHEMA, Setting, Stored, Supply,
};
pub use parser::Parser;
pub use wire::Label;

/// Number of the protocol: of the messages and their fields, and of the commands. It is increased with
/// every change of [`SCHEMA`] or of a command.
///
/// These hold in every protocol, so that a host can identify any board: the frames, the fields that
/// [`Hello`] has today, and the commands `disarm` and `identify`.
pub const PROTOCOL: u16 = 1;

/// Baud rate of a serial port, 8 data bits, no parity, 1 stop bit. The dividers of the 42 MHz of APB1
/// and of the 36 MHz of ST-LINK's own controller are whole, 28 and 24, so neither end has an error of
/// rate. Frames with all that an image can add take 81 % of it, 122 bytes per millisecond; an index pulse
/// adds 41 bytes to one of them.
pub const BAUD: u32 = 1_500_000;

/// First byte of a frame.
const START: u8 = 0x5A;
/// Start byte, kind and length.
const HEADER: usize = 3;
/// Bytes of the checksum.
const CRC: usize = 2;
/// Largest length of a payload, in every protocol.
const LONGEST_PAYLOAD: usize = 128;
/// Largest number of bytes of a frame.
pub const LONGEST: usize = HEADER + LONGEST_PAYLOAD + CRC;

/// CRC-16/IBM-3740: polynomial 0x1021, from 0xFFFF, not reflected. A byte at a time: the polynomial has
/// three terms below the highest one, so that its table of 256 words is a few shifts.
fn crc16(bytes: &[u8]) -> u16 {
    bytes.iter().fold(0xFFFF, |crc: u16, byte| {
        let mut crc = crc.rotate_left(8) ^ u16::from(*byte);
        crc ^= (crc & 0xFF) >> 4;
        crc ^= crc << 12;
        crc ^ ((crc & 0xFF) << 5)
    })
}

/// Writes the frame of a message, whose payload `put` writes, to the begin of `buffer`; `None` if the
/// buffer is too short. The result is the frame.
fn encode(
    buffer: &mut [u8],
    kind: u8,
    length: u8,
    put: impl FnOnce(&mut [u8]) -> Option<()>,
) -> Option<&[u8]> {
    let payload = usize::from(length);
    let frame = buffer.get_mut(..HEADER + payload + CRC)?;
    let (head, rest) = frame.split_first_chunk_mut::<HEADER>()?;
    *head = [START, kind, length];
    put(rest.get_mut(..payload)?)?;
    let crc = crc16(frame.get(1..HEADER + payload)?);
    *frame.last_chunk_mut::<CRC>()? = crc.to_le_bytes();
    Some(frame)
}

#[cfg(test)]
mod tests {
    #[test]
    fn checksum_agrees_with_the_published_check_value() {
        assert_eq!(super::crc16(b"123456789"), 0x29B1);
    }
}
