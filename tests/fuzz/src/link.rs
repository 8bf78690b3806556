//! Any bytes from a board.

use drivers::link::{LONGEST, Message, Parser, Reference};

/// Start byte, kind and length.
const HEADER: usize = 3;
/// Checksum.
const CRC: usize = 2;

/// Feeds `data` to the parser, then a message and the bytes that a torn frame may wait for, and compares
/// with a search of the whole.
///
/// # Panics
/// If the parser finds other frames, or counts other bytes as lost, or the message is not found although no
/// frame covers it.
pub fn run(data: &[u8]) {
    let sent = Message::Reference(Reference { seq: 7, count: 9 });
    let mut buffer = [0; LONGEST];
    let last = sent.encode(&mut buffer).expect("room");
    let bytes = [data, last, &[0; LONGEST]].concat();

    let mut parser = Parser::default();
    let mut found = Vec::new();
    for (taken, byte) in (1..).zip(&bytes) {
        parser.take(*byte, |message| found.push(message));
        let garbage = parser.garbage() as usize;
        assert!(garbage <= taken, "{garbage} of {taken} bytes");
    }
    let frames = frames(&bytes);
    assert_eq!(found.len() + parser.foreign() as usize, frames.len());
    let framed: usize = frames.iter().map(|(_, length)| length).sum();
    assert_eq!(parser.garbage() as usize + framed, bytes.len());
    if frames.contains(&(data.len(), last.len())) {
        assert!(
            found.contains(&sent),
            "the message after {} bytes",
            data.len()
        );
    }
}

/// Begin and length of every frame in `bytes`, found by trying each byte that no frame covers.
fn frames(bytes: &[u8]) -> Vec<(usize, usize)> {
    let mut frames = Vec::new();
    let mut at = 0;
    while at < bytes.len() {
        match frame(&bytes[at..]) {
            Some(length) => {
                frames.push((at, length));
                at += length;
            }
            None => at += 1,
        }
    }
    frames
}

/// Length of the frame with which `bytes` begin, if they do.
fn frame(bytes: &[u8]) -> Option<usize> {
    let length = HEADER + usize::from(*bytes.get(2)?) + CRC;
    let frame = bytes.get(..length).filter(|_| length <= LONGEST)?;
    let (body, crc) = frame[1..].split_at(length - 1 - CRC);
    (frame[0] == 0x5A && crc16(body).to_le_bytes() == crc).then_some(length)
}

/// CRC-16/IBM-3740, a bit at a time.
fn crc16(bytes: &[u8]) -> u16 {
    bytes.iter().fold(0xFFFF, |crc, byte| {
        (0..8).fold(crc ^ u16::from(*byte) << 8, |crc, _| {
            let carry = crc & 0x8000 != 0;
            crc << 1 ^ if carry { 0x1021 } else { 0 }
        })
    })
}
