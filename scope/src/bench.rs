//! What a page does with a board before a scene runs: its settings, and the guided procedures.

use std::time::Instant;

use drive::guided::Guided;
use drive::settings::outcome_words;
use drivers::link::Message;
use drivers::{Command, Saved, encode};
use haptic_control::{Request, Stop};
use serde_json::{Value, json};

use crate::guide::Guide;
use crate::order::Order;
use crate::storing::Storing;
use crate::undo::Undo;

/// Why a procedure ends whose page has closed or freezes.
const NOT_HEARD: &str = "ended, as the page was not heard";

/// Why a procedure ends with the server.
const SERVER_ENDS: &str = "ended, as the server ends";

/// What is told of an order to store that has no answer.
const NO_OUTCOME: &str = "no answer of the board came to the order to store; store again";

/// What is told of an order to store that waits while the board starts again, with the settings of its flash.
const NOT_STORED: &str = "not stored: the board has started again, and has lost what was changed; find the cause of the \
                          reset, then change and store again";

/// Settings and procedures of a board.
#[derive(Default)]
pub(crate) struct Bench {
    /// Settings of an answer that is not complete.
    coming: Vec<f32>,
    /// The values of the board, each at the number of its setting.
    settings: Option<Vec<f32>>,
    /// The order to store that waits.
    storing: Option<Storing>,
    /// Outcome of the latest order to store, once it has come.
    stored: Option<String>,
    /// Number of the outcomes so far.
    outcomes: u32,
    guide: Option<Guide>,
    /// The settings at the begin of the procedure, which asks for them before it changes one.
    before: Option<Vec<f32>>,
    /// What a procedure that was ended has left.
    undo: Option<Undo>,
}

impl Bench {
    /// The board has started again.
    pub(crate) fn restarted(&mut self) {
        (self.settings, self.undo) = (None, None);
        if self.storing.take().is_some() {
            self.tell_outcome(NOT_STORED.to_owned());
        }
        if let Some(guide) = &mut self.guide {
            guide.restarted();
        }
    }

    /// Takes bytes of the board, before their messages.
    pub(crate) fn heard(&self, bytes: &[u8]) {
        if let Some(guide) = &self.guide {
            guide.heard(bytes);
        }
    }

    pub(crate) fn message(&mut self, message: &Message) {
        if let Some(undo) = &mut self.undo {
            undo.heard();
        }
        match message {
            Message::Setting(setting) => {
                if setting.number == 0 {
                    self.coming.clear();
                }
                if usize::from(setting.number) == self.coming.len() {
                    self.coming.push(setting.value);
                }
                if self.coming.len() == usize::from(setting.count) {
                    let settings = std::mem::take(&mut self.coming);
                    self.complete(settings);
                }
            }
            Message::Hello(hello) => {
                if let (Some(guide), Some(cause)) = (&mut self.guide, Stop::from_code(hello.cause))
                {
                    guide.reset(cause);
                }
            }
            Message::Stored(stored) => {
                let outcome = Saved::from_code(stored.outcome);
                let now = Instant::now();
                (self.storing).take_if(|storing| !storing.waits(outcome, now));
                if self.storing.is_some() {
                    return;
                }
                let words = outcome.map_or_else(
                    || format!("outcome {}", stored.outcome),
                    |saved| outcome_words(saved).to_owned(),
                );
                self.tell_outcome(words);
            }
            _ => {}
        }
    }

    /// Keeps the outcome of an order to store for the page.
    fn tell_outcome(&mut self, words: String) {
        (self.stored, self.outcomes) = (Some(words), self.outcomes + 1);
    }

    /// Takes the settings of an answer.
    fn complete(&mut self, settings: Vec<f32>) {
        if self.guide.as_ref().is_some_and(Guide::runs) {
            self.before.get_or_insert_with(|| settings.clone());
        }
        self.undo.take_if(|undo| undo.is_done(&settings));
        self.settings = Some(settings);
    }

    /// Follows an order as far as it is one of the bench; whether it goes on to the board. While a procedure
    /// runs, the board has no other commander; the order to disarm has ended it before. A procedure begins if the board
    /// `is_known`.
    pub(crate) fn order(&mut self, order: &Order, is_known: bool) -> bool {
        let is_guided = self.guide.as_ref().is_some_and(Guide::runs);
        // A later command replaces the order to store.
        if order.changes_the_board() {
            self.storing = None;
        }
        match order {
            Order::Guide { name } => {
                let is_free = is_known && !is_guided && self.undo.is_none();
                if let Some(what) = guided(name).filter(|_| is_free) {
                    self.guide = Some(Guide::start(what));
                    (self.before, self.storing) = (None, None);
                }
                false
            }
            // The flash would keep what an ended procedure has tried.
            Order::Store if self.undo.is_some() || is_guided => false,
            Order::Store => {
                // The outcome of the order before is none of this one.
                (self.storing, self.stored) = (Some(Storing::new(Instant::now())), None);
                true
            }
            Order::Set { setting, .. } if !is_guided => {
                if let Some(undo) = &mut self.undo {
                    undo.set(*setting);
                }
                true
            }
            _ => !is_guided || order.command().is_none(),
        }
    }

    /// The bytes for the board that are due: those of a procedure, or those that are sent again. Without a page that
    /// commands, the procedure ends.
    pub(crate) fn take_bytes(&mut self, is_abandoned: bool) -> Vec<u8> {
        let Some(guide) = self.guide.as_mut().filter(|guide| guide.runs()) else {
            let now = Instant::now();
            if (self.storing.take_if(|storing| storing.is_lost(now))).is_some() {
                self.tell_outcome(NO_OUTCOME.to_owned());
            }
            let mut bytes = (self.undo.as_mut()).map_or_else(Vec::new, |undo| undo.bytes(now));
            bytes.extend((self.storing.iter_mut()).flat_map(|storing| storing.bytes(now)));
            return bytes;
        };
        if is_abandoned {
            self.abandon(NOT_HEARD);
            return encode(Command::Request(Request::Disarm)).to_vec();
        }
        guide.take_bytes()
    }

    /// Ends a procedure, as the board is disarmed for this reason.
    pub(crate) fn abandon(&mut self, why: &str) {
        if let Some(guide) = self.guide.as_mut().filter(|guide| guide.runs()) {
            let is_ended = guide.abandon(why);
            let before = self.before.take().filter(|_| is_ended);
            self.undo = before.and_then(|before| Undo::new(guide.what(), &before));
        }
    }

    /// The server ends: the bytes that end a procedure and undo what it has left.
    pub(crate) fn last_bytes(&mut self) -> Vec<u8> {
        self.abandon(SERVER_ENDS);
        let Some(mut undo) = self.undo.take() else {
            return Vec::new();
        };
        undo.heard();
        let mut bytes = encode(Command::Request(Request::Disarm)).to_vec();
        bytes.extend(undo.bytes(Instant::now()));
        bytes
    }

    pub(crate) fn json(&self) -> Value {
        let stored = self.stored.as_ref();
        let number = self.outcomes;
        json!({
            "settings": self.settings,
            "undoes": self.undo.is_some(),
            "stored": stored.map(|words| json!({"words": words, "number": number})),
            "guide": self.guide.as_ref().map(Guide::json),
        })
    }
}

/// The procedure of this name.
pub(crate) fn guided(name: &str) -> Option<Guided> {
    Guided::ALL.into_iter().find(|what| what.as_str() == name)
}

#[cfg(test)]
mod tests;
