//! The starts of a board, as its frames tell them.

use drivers::link::Frame;

/// Counts the starts of a board.
#[derive(Default)]
pub(crate) struct Starts {
    /// Number of starts since the connection.
    pub(crate) number: u32,
    /// Numbers of frame and tick of the latest frame.
    last: Option<[u32; 2]>,
}

impl Starts {
    /// Takes a frame. The board has started again if both of its numbers go back.
    pub(crate) fn frame(&mut self, frame: &Frame) {
        let now = [frame.seq, frame.tick];
        let goes_back = |(from, to): (u32, u32)| to.wrapping_sub(from).cast_signed() < 0;
        if let Some(last) = self.last.replace(now)
            && last.into_iter().zip(now).all(goes_back)
        {
            self.number += 1;
        }
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
