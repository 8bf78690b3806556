//! What a page does with a board before a scene runs: its settings, and the guided procedures.

use drive::guided::Guided;
use drive::settings::outcome_words;
use drivers::link::Message;
use drivers::{Command, Saved, encode};
use haptic_control::{Request, Stop};
use serde_json::{Value, json};

use crate::guide::Guide;
use crate::order::Order;

/// Why a procedure ends whose page has closed or freezes.
const NOT_HEARD: &str = "ended, as the page was not heard";

/// Settings and procedures of a board.
#[derive(Default)]
pub(crate) struct Bench {
    /// Settings of an answer that is not complete.
    coming: Vec<f32>,
    /// The values of the board, each at the number of its setting.
    settings: Option<Vec<f32>>,
    /// Outcome of the latest order to store, and their number.
    stored: Option<(String, u32)>,
    guide: Option<Guide>,
}

impl Bench {
    /// The board has started again.
    pub(crate) fn restarted(&mut self) {
        self.settings = None;
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
        match message {
            Message::Setting(setting) => {
                if setting.number == 0 {
                    self.coming.clear();
                }
                if usize::from(setting.number) == self.coming.len() {
                    self.coming.push(setting.value);
                }
                if self.coming.len() == usize::from(setting.count) {
                    self.settings = Some(std::mem::take(&mut self.coming));
                }
            }
            Message::Hello(hello) => {
                if let (Some(guide), Some(cause)) = (&mut self.guide, Stop::from_code(hello.cause))
                {
                    guide.reset(cause);
                }
            }
            Message::Stored(stored) => {
                let words = Saved::from_code(stored.outcome).map_or_else(
                    || format!("outcome {}", stored.outcome),
                    |saved| outcome_words(saved).to_owned(),
                );
                let number = self.stored.as_ref().map_or(0, |(_, number)| *number) + 1;
                self.stored = Some((words, number));
            }
            _ => {}
        }
    }

    /// Follows an order as far as it is one of the bench; whether it goes on to the board. While a procedure
    /// runs, the board has no other commander; the order to disarm has ended it before. A procedure begins if the board
    /// `is_known`.
    pub(crate) fn order(&mut self, order: &Order, is_known: bool) -> bool {
        let is_guided = self.guide.as_ref().is_some_and(Guide::runs);
        match order {
            Order::Guide { name } => {
                if let Some(what) = guided(name).filter(|_| is_known && !is_guided) {
                    self.guide = Some(Guide::start(what));
                }
                false
            }
            _ => !is_guided || order.command().is_none(),
        }
    }

    /// The bytes of a procedure for the board. Without a page that commands, the procedure ends.
    pub(crate) fn take_bytes(&mut self, is_abandoned: bool) -> Vec<u8> {
        let Some(guide) = self.guide.as_mut().filter(|guide| guide.runs()) else {
            return Vec::new();
        };
        if is_abandoned {
            guide.abandon(NOT_HEARD);
            return encode(Command::Request(Request::Disarm)).to_vec();
        }
        guide.take_bytes()
    }

    /// Ends a procedure, as the board is disarmed for this reason.
    pub(crate) fn abandon(&mut self, why: &str) {
        if let Some(guide) = &mut self.guide {
            guide.abandon(why);
        }
    }

    pub(crate) fn json(&self) -> Value {
        let stored = self.stored.as_ref();
        json!({
            "settings": self.settings,
            "stored": stored.map(|(words, number)| json!({"words": words, "number": number})),
            "guide": self.guide.as_ref().map(Guide::json),
        })
    }
}

/// The procedure of this name.
pub(crate) fn guided(name: &str) -> Option<Guided> {
    Guided::ALL.into_iter().find(|what| what.as_str() == name)
}

#[cfg(test)]
mod tests {
    use drivers::link::{Hello, Setting, Stored};

    use super::*;

    fn setting(number: u8, value: f32) -> Message {
        Message::Setting(Setting {
            number,
            count: 3,
            value,
        })
    }

    #[test]
    fn settings_are_shown_when_all_have_come() {
        let mut bench = Bench::default();
        // The end of an answer from before, and one in which a message was lost.
        for (number, value) in [(2, 9.0), (0, 7.0), (2, 8.0)] {
            bench.message(&setting(number, value));
            assert_eq!(bench.settings, None);
        }
        for (number, value) in [(0, 1.0), (1, 2.0), (2, 3.0)] {
            assert_eq!(bench.settings, None);
            bench.message(&setting(number, value));
        }
        assert_eq!(bench.settings, Some(vec![1.0, 2.0, 3.0]));
        bench.restarted();
        assert_eq!(bench.settings, None);
    }

    #[test]
    fn outcome_of_a_store_is_told_again() {
        let mut bench = Bench::default();
        for number in 1..3 {
            bench.message(&Message::Stored(Stored { outcome: 1 }));
            let told = &bench.json()["stored"];
            assert_eq!(told["number"], number);
            assert!(told["words"].as_str().is_some_and(|w| w.contains("disarm")));
        }
    }

    #[test]
    fn procedure_holds_other_commands_back_until_the_order_to_disarm() {
        let mut bench = Bench {
            guide: Some(Guide::start(Guided::BringUp)),
            ..Bench::default()
        };
        assert!(!bench.order(&Order::Alive, true) && !bench.order(&Order::Arm, true));
        assert!(bench.order(&Order::Record { on: true }, true));
        bench.abandon("ended by Disarm");
        assert!(bench.order(&Order::Disarm, true) && bench.order(&Order::Arm, true));
        let ended = &bench.json()["guide"];
        assert_eq!(
            (&ended["runs"], &ended["failure"]),
            (&json!(false), &json!("bring-up: ended by Disarm"))
        );
    }

    #[test]
    fn procedure_that_a_reset_ends_has_the_cause_of_the_reset() {
        let hello = |cause: Stop| {
            Message::Hello(Hello {
                cause: cause as u8,
                ..Hello::default()
            })
        };
        for (cause, said) in [
            (
                Stop::Watchdog,
                "bring-up: the board has started again, cause watchdog",
            ),
            (Stop::None, "bring-up: the board has started again"),
        ] {
            let mut bench = Bench {
                guide: Some(Guide::start(Guided::BringUp)),
                ..Bench::default()
            };
            bench.message(&hello(Stop::Jump));
            bench.restarted();
            // The page disarms it then, and the next resets are of another time.
            bench.abandon("ended by Disarm");
            bench.message(&hello(cause));
            bench.message(&hello(Stop::Jump));
            assert_eq!(bench.json()["guide"]["failure"], said);
        }
    }

    #[test]
    fn procedure_waits_for_the_identity_of_the_board_and_for_the_one_before() {
        let mut bench = Bench::default();
        let guide = |name: &str| Order::Guide {
            name: name.to_owned(),
        };
        assert!(!bench.order(&guide("bring-up"), false));
        assert!(bench.json()["guide"].is_null());
        assert!(!bench.order(&guide("bring-up"), true));
        bench.order(&guide("calibrate"), true);
        assert_eq!(bench.json()["guide"]["name"], "bring-up");
    }

    #[test]
    fn procedure_without_a_page_ends_with_a_disarm() {
        let mut bench = Bench {
            guide: Some(Guide::start(Guided::BringUp)),
            ..Bench::default()
        };
        let disarm = encode(Command::Request(Request::Disarm)).to_vec();
        assert_eq!(bench.take_bytes(true), disarm);
        assert_eq!(bench.take_bytes(true), Vec::<u8>::new());
    }
}
