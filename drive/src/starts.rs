//! The starts of a board, as its frames tell them.

use drivers::link::Frame;

/// Whether the board has started again between two frames: both of its numbers, which wrap, go back.
#[must_use]
pub const fn is_start(last: &Frame, frame: &Frame) -> bool {
    goes_back(last.seq, frame.seq) && goes_back(last.tick, frame.tick)
}

const fn goes_back(from: u32, to: u32) -> bool {
    to.wrapping_sub(from).cast_signed() < 0
}

/// Counts the starts of a board.
#[derive(Default)]
pub(crate) struct Starts {
    /// Number of starts since the connection.
    pub(crate) number: u32,
    last: Option<Frame>,
}

impl Starts {
    /// Takes a frame.
    pub(crate) fn frame(&mut self, frame: &Frame) {
        let last = self.last.replace(*frame);
        self.number += u32::from(last.is_some_and(|last| is_start(&last, frame)));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::watch::tests::FRAME;

    #[test]
    fn wrap_and_lost_frames_are_no_start() {
        let mut starts = Starts::default();
        let numbers = [
            (u32::MAX - 1, 70),
            (3, 120),
            (9, u32::MAX),
            (10, 5),
            (0, 0),
            (1, 10),
        ];
        let seen = numbers.map(|(seq, tick)| {
            starts.frame(&Frame { seq, tick, ..FRAME });
            starts.number
        });
        assert_eq!(seen, [0, 0, 0, 0, 1, 1]);
    }
}
