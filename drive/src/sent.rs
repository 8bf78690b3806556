//! The commands of a session that wait for the counts of refused ones.

use std::collections::VecDeque;

use drivers::Command;
use drivers::link::Rejected;
use haptic_control::SceneKind;
use terminal::failure::Failure;

use crate::named::explained;
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

/// The commands of a session, each followed by a question for the counts of what the board rejected. The answers come
/// in the order of the questions.
pub(crate) struct Sent {
    /// The counts of the latest answer.
    before: Option<Rejected>,
    scene: Option<SceneKind>,
    /// Questions from before the session have no command.
    waiting: VecDeque<Option<Order>>,
}

impl Sent {
    /// A session with a scene, and so many questions from before it without an answer.
    pub(crate) fn new(before: Option<Rejected>, scene: Option<SceneKind>, earlier: u32) -> Self {
        Self {
            before,
            scene,
            waiting: (0..earlier).map(|_| None).collect(),
        }
    }

    /// A command has been sent, and a question after it.
    pub(crate) fn add(&mut self, order: Order) {
        self.waiting.push_back(Some(order));
    }

    /// Takes counts that come without a question.
    ///
    /// # Errors
    /// [`Failure::Check`] if the board has refused a command.
    pub(crate) fn report(&self, now: &Rejected) -> Result<(), Failure> {
        self.refusal(now, self.waiting.front().and_then(Option::as_ref))
    }

    /// Takes the counts of an answer. Returns the command before its question if bytes that are no command came too:
    /// it may have been damaged. One that a later command replaces is not returned.
    ///
    /// # Errors
    /// [`Failure::Check`] with the name of the command if the board has refused it.
    pub(crate) fn answer(&mut self, now: &Rejected) -> Result<Option<Order>, Failure> {
        let order = self.waiting.pop_front().flatten();
        self.refusal(now, order.as_ref())?;
        let before = self.before.replace(*now);
        let is_uncertain = before.is_some_and(|before| is_damaged(&before, now));
        let is_last = |order: &Order| {
            let mut later = self.waiting.iter().flatten();
            !later.any(|it| replaces(&it.command, &order.command))
        };
        Ok(order.filter(|order| is_uncertain && is_last(order)))
    }

    fn refusal(&self, now: &Rejected, order: Option<&Order>) -> Result<(), Failure> {
        let Some(reason) = self.before.and_then(|before| refusal(&before, now)) else {
            return Ok(());
        };
        let reason = explained(reason, self.scene);
        Err(Failure::Check(match order {
            Some(Order { name, .. }) => format!("{name}: the board refuses it: {reason}"),
            None => format!("the board refuses a command: {reason}"),
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

    fn sent(earlier: u32, orders: &[Order]) -> Sent {
        let mut sent = Sent::new(Some(NONE), Some(SceneKind::Wall), earlier);
        orders.iter().for_each(|order| sent.add(order.clone()));
        sent
    }

    #[test]
    fn refused_command_is_named_by_its_place_among_the_answers() {
        let refused = Rejected {
            out_of_bounds: 1,
            ..NONE
        };
        let orders = [tune(1, 9.0), tune(2, 9.0)];
        let said = sent(1, &orders).answer(&refused).unwrap_err().to_string();
        assert_eq!(
            said,
            "the board refuses a command: the value is out of bounds"
        );
        let mut third = sent(1, &orders);
        assert_eq!(third.answer(&NONE).unwrap(), None);
        // Counts without a question are no answer to one.
        third.report(&NONE).unwrap();
        assert_eq!(third.answer(&NONE).unwrap(), None);
        let said = third.answer(&refused).unwrap_err().to_string();
        assert_eq!(
            said,
            "parameter 2: the board refuses it: the value is out of bounds"
        );
    }

    #[test]
    fn command_beside_bytes_that_are_no_command_is_returned_unless_a_later_one_replaces_it() {
        let noise = |garbage| Rejected { garbage, ..NONE };
        let [first, other, second] = [tune(1, 0.1), tune(2, 0.5), tune(1, 0.2)];
        let mut sent = sent(0, &[first, other.clone(), second]);
        assert_eq!(sent.answer(&noise(3)).unwrap(), None, "it is replaced");
        assert_eq!(sent.answer(&noise(4)).unwrap(), Some(other));
        assert_eq!(sent.answer(&noise(4)).unwrap(), None, "nothing came since");
    }
}
