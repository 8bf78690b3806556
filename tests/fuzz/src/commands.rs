//! Any bytes on the command channel.

use drivers::Parser;

/// Bytes of a frame.
const FRAME: usize = 11;

/// Feeds `data` to the parser.
///
/// # Panics
/// If bytes get lost or are counted twice.
pub fn run(data: &[u8]) {
    let mut parser = Parser::default();
    let mut framed = 0;
    for (taken, byte) in (1..).zip(data) {
        framed += usize::from(parser.take(*byte).is_some()) * FRAME;
        let accounted = framed + parser.garbage() as usize;
        // What is neither is held, as the beginning of a frame.
        assert!(accounted <= taken, "{accounted} of {taken} bytes");
        assert!(
            taken - accounted < FRAME,
            "{} bytes held",
            taken - accounted
        );
    }
}
