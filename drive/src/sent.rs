//! The commands of a session that wait for the counts of refused ones.

use std::collections::VecDeque;
use std::mem;
use std::time::{Duration, Instant};

use drivers::Command;
use drivers::link::Rejected;
use haptic_control::SceneKind;
use terminal::failure::Failure;

use crate::named::explained;
use crate::patience::AGAIN;
use crate::refusal::{is_damaged, refusal};

/// Largest number of times that a command is sent while bytes that are no command reach the board.
pub(crate) const ATTEMPTS: u32 = 4;

/// A command that was sent.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Order {
    pub(crate) name: String,
    pub(crate) command: Command,
    /// How often it was sent.
    pub(crate) times: u32,
}

/// The commands of a session, and the questions after them for the counts of what the board rejected.
///
/// Answers come in the order of the questions, but one may be lost. An answer is taken as that to the oldest question,
/// whose commands it covers in every case. Counts that grow may be those of every
/// command that waits. A question without an answer is asked again after [`AGAIN`], and once more after the longest wait
/// for an answer: older ones are lost then.
pub(crate) struct Sent {
    /// The counts of the latest answer.
    before: Option<Rejected>,
    scene: Option<SceneKind>,
    /// Longest wait for an answer.
    patience: Duration,
    /// Commands that no question has followed yet.
    unasked: Vec<Order>,
    /// The oldest question first.
    waiting: VecDeque<Question>,
}

/// A question without an answer.
struct Question {
    at: Instant,
    /// The commands that its answer covers: none if it is from before the session, or was asked again.
    orders: Vec<Order>,
    /// Whether bytes that are no command came with the answer to an older question.
    is_suspect: bool,
    /// Longest wait for its answer.
    limit: Duration,
}

impl Sent {
    /// A session with a scene, and so many questions from before it without an answer. An answer that does not come in
    /// `patience` is lost.
    pub(crate) fn new(
        before: Option<Rejected>,
        scene: Option<SceneKind>,
        earlier: u32,
        patience: Duration,
        at: Instant,
    ) -> Self {
        let earlier = (0..earlier).map(|_| Question {
            at,
            orders: Vec::new(),
            is_suspect: false,
            limit: patience,
        });
        Self {
            before,
            scene,
            patience,
            unasked: Vec::new(),
            waiting: earlier.collect(),
        }
    }

    /// A command has been sent.
    pub(crate) fn add(&mut self, order: Order) {
        self.unasked.push(order);
    }

    /// Whether a question has to be sent: after commands, and again if one waits for too long. It counts as sent then.
    pub(crate) fn asks(&mut self, at: Instant) -> bool {
        let age = |question: &Question| at.saturating_duration_since(question.at);
        let is_late = |question: &Question| age(question) >= question.limit;
        let mut orders = Vec::new();
        let (mut is_suspect, mut limit) = (false, AGAIN);
        if (self.waiting.iter()).any(|question| !question.orders.is_empty() && is_late(question)) {
            limit = self.patience;
            // All of them: the commands keep their order.
            for question in &mut self.waiting {
                orders.append(&mut question.orders);
                is_suspect |= mem::take(&mut question.is_suspect);
                question.limit = self.patience;
            }
        }
        let is_lost = |question: &mut Question| question.orders.is_empty() && is_late(question);
        while self.waiting.pop_front_if(is_lost).is_some() {}
        orders.append(&mut self.unasked);
        let asks = !orders.is_empty();
        if asks {
            self.waiting.push_back(Question {
                at,
                orders,
                is_suspect,
                limit,
            });
        }
        asks
    }

    /// Takes counts that come without a question, or whose identity was lost.
    ///
    /// # Errors
    /// [`Failure::Check`] if the board has refused a command.
    pub(crate) fn report(&self, now: &Rejected) -> Result<(), Failure> {
        self.refusal(now, &[])
    }

    /// Takes the counts of an answer. Returns the commands before its question if bytes that are no command came too, or
    /// may have come: they may have been damaged. Those that a later command replaces are not returned.
    ///
    /// # Errors
    /// [`Failure::Check`] with the names of the commands of which the board has refused one.
    pub(crate) fn answer(&mut self, now: &Rejected) -> Result<Vec<Order>, Failure> {
        let question = self.waiting.pop_front();
        let (orders, is_suspect) =
            question.map_or_else(Default::default, |it| (it.orders, it.is_suspect));
        self.refusal(now, &orders)?;
        let before = self.before.replace(*now);
        let is_damaged = before.is_some_and(|before| is_damaged(&before, now));
        for question in &mut self.waiting {
            question.is_suspect |= is_damaged;
        }
        if !is_damaged && !is_suspect {
            return Ok(Vec::new());
        }
        let is_last = |k: &usize| {
            let mut later = orders[k + 1..].iter().chain(self.orders());
            !later.any(|it| replaces(&it.command, &orders[*k].command))
        };
        let last = (0..orders.len()).filter(is_last);
        Ok(last.map(|k| orders[k].clone()).collect())
    }

    /// The commands that no answer covers yet, in their order.
    pub(crate) fn orders(&self) -> impl Iterator<Item = &Order> {
        let asked = self.waiting.iter().flat_map(|question| &question.orders);
        asked.chain(&self.unasked)
    }

    /// The failure of a refusal, if there is one since the latest answer: of one of these `orders`, or of one that waits.
    fn refusal(&self, now: &Rejected, orders: &[Order]) -> Result<(), Failure> {
        let Some(reason) = self.before.and_then(|before| refusal(&before, now)) else {
            return Ok(());
        };
        let reason = explained(reason, self.scene);
        let names: Vec<_> = (orders.iter().chain(self.orders()))
            .map(|order| order.name.as_str())
            .collect();
        Err(Failure::Check(match names[..] {
            [] => format!("the board refuses a command: {reason}"),
            [name] => format!("{name}: the board refuses it: {reason}"),
            _ => format!("the board refuses one of {}: {reason}", names.join(", ")),
        }))
    }
}

/// Whether nothing is left of the `earlier` command after the `later` one.
fn replaces(later: &Command, earlier: &Command) -> bool {
    let target = |command: &Command| match command {
        Command::Tune {
            scene, parameter, ..
        } => Some((*scene, *parameter)),
        _ => None,
    };
    std::mem::discriminant(later) == std::mem::discriminant(earlier)
        && target(later) == target(earlier)
}

#[cfg(test)]
mod tests {
    use std::slice::from_ref;

    use super::*;

    const NONE: Rejected = Rejected {
        garbage: 0,
        not_finite: 0,
        out_of_bounds: 0,
        unknown: 0,
        unverified: 0,
    };

    fn tune(parameter: u8, value: f32) -> Order {
        Order {
            name: format!("parameter {parameter}"),
            command: Command::Tune {
                scene: 2,
                parameter,
                value,
            },
            times: 1,
        }
    }

    const PATIENCE: Duration = Duration::from_secs(2);

    /// A session at the instant `at`, with a question after each of the orders.
    fn sent(earlier: u32, orders: &[Order], at: Instant) -> Sent {
        let mut sent = Sent::new(Some(NONE), Some(SceneKind::Wall), earlier, PATIENCE, at);
        for order in orders {
            sent.add(order.clone());
            assert!(sent.asks(at) && !sent.asks(at), "one question");
        }
        sent
    }

    fn noise(garbage: u32) -> Rejected {
        Rejected { garbage, ..NONE }
    }

    fn ms(number: u64) -> Duration {
        Duration::from_millis(number)
    }

    #[test]
    fn refusal_names_the_commands_that_wait() {
        let refused = Rejected {
            out_of_bounds: 1,
            ..NONE
        };
        let of = |sent: &mut Sent| sent.answer(&refused).unwrap_err().to_string();
        let reason = "the value is out of bounds";
        let at = Instant::now();
        assert_eq!(
            of(&mut sent(1, &[], at)),
            format!("the board refuses a command: {reason}")
        );
        let orders = [tune(1, 9.0), tune(2, 9.0)];
        // The answer to the first one may be lost.
        let mut both = sent(0, &orders, at);
        let names = "parameter 1, parameter 2";
        assert_eq!(
            of(&mut both),
            format!("the board refuses one of {names}: {reason}")
        );
        let mut third = sent(1, &orders, at);
        assert_eq!(third.answer(&NONE).unwrap(), []);
        // Counts without a question are no answer to one.
        third.report(&NONE).unwrap();
        let said = third.report(&refused).unwrap_err().to_string();
        assert_eq!(said, format!("the board refuses one of {names}: {reason}"));
        assert_eq!(third.answer(&NONE).unwrap(), []);
        assert_eq!(
            of(&mut third),
            format!("parameter 2: the board refuses it: {reason}")
        );
    }

    #[test]
    fn commands_that_may_be_damaged_are_returned_unless_a_later_one_replaces_them() {
        let [first, other, second] = [tune(1, 0.1), tune(2, 0.5), tune(1, 0.2)];
        let at = Instant::now();
        let mut one_by_one = sent(0, &[first.clone(), other.clone(), second.clone()], at);
        assert_eq!(one_by_one.answer(&noise(3)).unwrap(), [], "it is replaced");
        // The answer to the first one may be lost: the noise may be that of the second one.
        assert_eq!(one_by_one.answer(&noise(3)).unwrap(), from_ref(&other));
        assert_eq!(one_by_one.answer(&noise(3)).unwrap(), from_ref(&second));
        assert_eq!(one_by_one.answer(&noise(4)).unwrap(), [], "no command");
        // A question after all of them.
        let mut at_once = sent(0, &[], at);
        for order in [first, other.clone(), second.clone()] {
            at_once.add(order);
        }
        assert!(at_once.asks(at));
        assert_eq!(at_once.answer(&noise(3)).unwrap(), [other, second]);
        at_once.add(tune(1, 0.3));
        assert!(at_once.asks(at));
        assert_eq!(at_once.answer(&noise(3)).unwrap(), [], "nothing came since");
    }

    #[test]
    fn question_without_an_answer_is_asked_again_with_all_commands_since() {
        let at = Instant::now();
        let (first, second) = (tune(1, 0.1), tune(1, 0.2));
        let mut sent = sent(0, from_ref(&first), at);
        assert!(!sent.asks(at + AGAIN - ms(1)));
        sent.add(second.clone());
        assert!(sent.asks(at + AGAIN - ms(1)));
        assert!(sent.asks(at + AGAIN), "the first one is late");
        assert!(!sent.asks(at + AGAIN));
        // The answers to the first two questions are late, and cover no command for certain.
        assert_eq!(sent.answer(&NONE).unwrap(), []);
        assert_eq!(sent.answer(&NONE).unwrap(), []);
        // The second command stays the last one.
        assert_eq!(sent.answer(&noise(1)).unwrap(), [second]);
    }

    #[test]
    fn answers_belong_to_their_questions_again_some_time_after_a_lost_one() {
        let at = Instant::now();
        let mut sent = sent(0, &[tune(1, 0.1)], at);
        // The first answer is lost, and the second one comes: it may be the first.
        assert!(sent.asks(at + AGAIN));
        assert_eq!(sent.answer(&NONE).unwrap(), []);
        assert!(!sent.asks(at + AGAIN + PATIENCE - ms(1)));
        assert!(sent.asks(at + AGAIN + PATIENCE));
        assert_eq!(sent.answer(&NONE).unwrap(), []);
        assert_eq!(sent.orders().count(), 0);
        // An answer belongs to the command before it again.
        let later = at + AGAIN + PATIENCE + ms(1);
        sent.add(tune(2, 0.5));
        assert!(sent.asks(later));
        assert!(sent.orders().eq([&tune(2, 0.5)]));
        assert_eq!(sent.answer(&noise(1)).unwrap(), [tune(2, 0.5)]);
        assert_eq!(sent.orders().count(), 0);
        assert!(!sent.asks(later + 10 * PATIENCE), "nothing waits");
    }

    #[test]
    fn question_from_before_the_session_waits_as_long_as_any_other() {
        let at = Instant::now();
        let mut sent = sent(1, &[], at);
        assert!(!sent.asks(at + AGAIN), "it is not asked again");
        sent.add(tune(1, 0.1));
        assert!(sent.asks(at + AGAIN));
        assert_eq!(sent.answer(&NONE).unwrap(), [], "from before");
        assert_eq!(sent.answer(&noise(1)).unwrap(), [tune(1, 0.1)]);
    }

    #[test]
    fn command_that_may_be_damaged_is_returned_after_its_question_is_asked_again() {
        let at = Instant::now();
        let (first, second) = (tune(1, 0.1), tune(2, 0.5));
        let mut sent = sent(0, &[first.clone(), second.clone()], at);
        // The noise may be that of the second one: the answer to the first question may be lost.
        assert_eq!(sent.answer(&noise(1)).unwrap(), [first]);
        assert!(sent.asks(at + AGAIN));
        assert_eq!(sent.answer(&noise(1)).unwrap(), []);
        assert_eq!(sent.answer(&noise(1)).unwrap(), [second]);
    }

    /// It would be sent once more after the later one.
    #[test]
    fn command_is_replaced_by_a_later_one_without_a_question_too() {
        let mut sent = sent(0, &[tune(1, 0.1)], Instant::now());
        sent.add(tune(1, 0.2));
        assert_eq!(sent.answer(&noise(1)).unwrap(), []);
    }
}
