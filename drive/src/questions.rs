//! The questions for the identity of a board that have no answer yet.

use std::collections::VecDeque;
use std::time::{Duration, Instant};

/// The questions without an answer. Answers come in their order; one that does not come in time is lost.
pub(crate) struct Questions {
    /// Longest wait for an answer.
    patience: Duration,
    /// When they were asked, the oldest one first.
    open: VecDeque<Instant>,
}

impl Questions {
    /// No question, and the longest wait for an answer.
    pub(crate) const fn new(patience: Duration) -> Self {
        Self {
            patience,
            open: VecDeque::new(),
        }
    }

    /// A question has been sent.
    pub(crate) fn ask(&mut self, at: Instant) {
        self.open.push_back(at);
    }

    /// An answer has come: that to the oldest question.
    pub(crate) fn answer(&mut self) {
        self.open.pop_front();
    }

    /// Number of the questions whose answers may still come.
    pub(crate) fn number(&mut self, now: Instant) -> u32 {
        let patience = self.patience;
        let is_lost = |at: &mut Instant| now.saturating_duration_since(*at) > patience;
        while self.open.pop_front_if(is_lost).is_some() {}
        self.open.len() as u32
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::patience::AGAIN;

    #[test]
    fn question_whose_answer_is_lost_waits_no_longer_than_the_patience() {
        let patience = Duration::from_secs(2);
        let at = Instant::now();
        let mut questions = Questions::new(patience);
        questions.ask(at);
        questions.ask(at + AGAIN);
        questions.answer();
        assert_eq!(questions.number(at + AGAIN + patience), 1);
        let later = at + AGAIN + patience + Duration::from_millis(1);
        questions.ask(later);
        assert_eq!(questions.number(later), 1);
        questions.answer();
        assert_eq!(questions.number(later), 0);
    }
}
