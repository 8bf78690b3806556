//! The order to store the settings, until it is followed.

use std::time::{Duration, Instant};

use drive::patience::AGAIN;
use drivers::{Command, Saved, encode};

/// Longest wait until the board is certain that its amplifiers are disabled.
const PATIENCE: Duration = Duration::from_secs(2);

/// Longest wait for an answer: the flash may have to be erased, and an emulated board may be slow.
const ANSWER: Duration = Duration::from_secs(10);

/// An order to store. For some frames after its amplifiers are disabled the board is not certain of it, and refuses the
/// order, which is sent again then.
pub(crate) struct Storing {
    begin: Instant,
    /// When the order was sent.
    sent: Instant,
    is_refused: bool,
}

impl Storing {
    /// The order is sent at this instant.
    pub(crate) const fn new(now: Instant) -> Self {
        Self {
            begin: now,
            sent: now,
            is_refused: false,
        }
    }

    /// Takes an outcome. Returns whether the order waits on.
    pub(crate) fn waits(&mut self, outcome: Option<Saved>, now: Instant) -> bool {
        let is_early = now.saturating_duration_since(self.begin) < PATIENCE;
        self.is_refused = is_early && outcome == Some(Saved::Enabled);
        self.is_refused
    }

    /// Whether the answer is lost.
    pub(crate) fn is_lost(&self, now: Instant) -> bool {
        !self.is_refused && now.saturating_duration_since(self.sent) >= ANSWER
    }

    /// The bytes for the board that are due.
    pub(crate) fn bytes(&mut self, now: Instant) -> Vec<u8> {
        if !self.is_refused || now.saturating_duration_since(self.sent) < AGAIN {
            return Vec::new();
        }
        (self.sent, self.is_refused) = (now, false);
        encode(Command::Store).to_vec()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn refused_order_is_sent_again_until_the_patience_ends() {
        let begin = Instant::now();
        let store = encode(Command::Store).to_vec();
        let mut storing = Storing::new(begin);
        assert!(storing.bytes(begin + AGAIN).is_empty(), "no answer yet");
        assert!(storing.waits(Some(Saved::Enabled), begin + AGAIN / 2));
        let early = begin + AGAIN - Duration::from_millis(1);
        assert!(storing.bytes(early).is_empty());
        assert_eq!(storing.bytes(begin + AGAIN), store);
        assert!(storing.bytes(begin + 5 * AGAIN).is_empty(), "sent once");
        assert!(!storing.is_lost(begin + AGAIN + ANSWER - Duration::from_millis(1)));
        assert!(!storing.waits(Some(Saved::Enabled), begin + PATIENCE));
        assert!(storing.bytes(begin + 2 * PATIENCE).is_empty());
        assert!(storing.is_lost(begin + AGAIN + ANSWER));
        for outcome in [Some(Saved::Stored), Some(Saved::Full), None] {
            assert!(!Storing::new(begin).waits(outcome, begin), "{outcome:?}");
        }
    }
}
