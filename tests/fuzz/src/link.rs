//! Any bytes from a board.

use drivers::link::{LONGEST, Message, Parser, Reference};

/// Feeds `data` to the parser, and then a message and the bytes that a torn frame may wait for.
///
/// # Panics
/// If bytes get lost or are counted twice, or the message is not found.
pub fn run(data: &[u8]) {
    let mut parser = Parser::default();
    let (mut framed, mut is_known) = (0, true);
    let mut buffer = [0; LONGEST];
    for (taken, byte) in (1..).zip(data) {
        parser.take(*byte, |message| {
            framed += message.encode(&mut buffer).expect("room").len();
            is_known &= !matches!(message, Message::Hello(_));
        });
        // The length of a frame of another protocol is not known here, nor that of a later identity.
        if parser.foreign() > 0 || !is_known {
            break;
        }
        let accounted = framed + parser.garbage() as usize;
        assert!(accounted <= taken, "{accounted} of {taken} bytes");
        let held = taken - accounted;
        assert!(held < LONGEST, "{held} bytes held");
    }
    let sent = Message::Reference(Reference { seq: 7, count: 9 });
    let (mut found, foreign) = (false, parser.foreign());
    let mut last = [0; LONGEST];
    let bytes = sent.encode(&mut last).expect("room");
    for byte in bytes.iter().chain(&[0; LONGEST]) {
        parser.take(*byte, |message| found |= message == sent);
    }
    // One in 65536 torn frames has the checksum of what follows by chance.
    let found = found || parser.foreign() != foreign;
    assert!(found, "the message after {} bytes", data.len());
}
