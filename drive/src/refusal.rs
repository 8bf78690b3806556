//! Why a board refuses a command, and why a program of the host refuses a board.

use std::collections::VecDeque;

use drivers::link::{Hello, PROTOCOL, Parser, Rejected};
use haptic_control::SceneKind;
use terminal::failure::Failure;

use crate::named::explained;

/// Reason of the refusal of a value.
pub(crate) const OUT_OF_BOUNDS: &str = "the value is out of bounds";

/// Checks that the board at the port of this name speaks the protocol of this build.
///
/// # Errors
/// [`Failure::Input`] with both protocols if it does not.
pub fn compatible(port: &str, hello: &Hello) -> Result<(), Failure> {
    match hello.protocol {
        PROTOCOL => Ok(()),
        other => Err(Failure::Input(format!(
            "{port}: the board speaks protocol {other}, this tool protocol {PROTOCOL}; build both \
             from one commit (the board has {}, commit {})",
            hello.version, hello.commit
        ))),
    }
}

/// The message about a board at the port of this name that sends nothing that the parser understands.
#[must_use]
pub fn silent(port: &str, parser: &Parser) -> String {
    let bytes = parser.garbage();
    let heard = match (bytes, parser.foreign()) {
        (0, 0) => "sends nothing".to_owned(),
        (_, 0) => format!("does not answer; {bytes} bytes were no message"),
        (_, frames) => format!("does not answer; {frames} messages are of another protocol"),
    };
    format!("{port}: the board {heard}; check the port, the power and that the image has the link")
}

/// The reason of a refusal between two counts.
#[must_use]
pub fn refusal(before: &Rejected, now: &Rejected) -> Option<&'static str> {
    [
        (before.not_finite, now.not_finite, "the value is not finite"),
        (before.out_of_bounds, now.out_of_bounds, OUT_OF_BOUNDS),
        (before.unknown, now.unknown, "the image does not have it"),
        (
            before.unverified,
            now.unverified,
            "the signs of encoders and currents have not been verified; run cargo drive bring-up",
        ),
        (before.garbage, now.garbage, "the command arrived damaged"),
    ]
    .into_iter()
    .find_map(|(before, now, reason)| (before != now).then_some(reason))
}

/// The commands of a session that wait for the counts of refused ones. The answers come in the order of the
/// questions.
pub(crate) struct Sent {
    /// The counts before the session.
    before: Option<Rejected>,
    scene: Option<SceneKind>,
    /// Names of the commands; questions from before the session have none.
    names: VecDeque<Option<String>>,
}

impl Sent {
    /// A session with a scene, and so many questions from before it without an answer.
    pub(crate) fn new(before: Option<Rejected>, scene: Option<SceneKind>, earlier: u32) -> Self {
        Self {
            before,
            scene,
            names: (0..earlier).map(|_| None).collect(),
        }
    }

    /// A command of this name has been sent, and a question after it.
    pub(crate) fn add(&mut self, name: String) {
        self.names.push_back(Some(name));
    }

    /// Takes an answer.
    ///
    /// # Errors
    /// [`Failure::Check`] with the name of the command if the board has refused it.
    pub(crate) fn check(&mut self, now: &Rejected) -> Result<(), Failure> {
        let name = self.names.pop_front().flatten();
        let Some(reason) = self.before.and_then(|before| refusal(&before, now)) else {
            return Ok(());
        };
        let reason = explained(reason, self.scene);
        Err(Failure::Check(match name {
            Some(name) => format!("{name}: the board refuses it: {reason}"),
            None => format!("the board refuses a command: {reason}"),
        }))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn refused_command_is_named_by_its_place_among_the_answers() {
        let none = Rejected::default();
        let refused = Rejected {
            out_of_bounds: 1,
            ..none
        };
        let sent = || {
            let mut sent = Sent::new(Some(none), Some(SceneKind::Wall), 1);
            sent.add("scene wall".to_owned());
            sent.add("wall stiffness 9 N·m/rad".to_owned());
            sent
        };
        let mut first = sent();
        let said = first.check(&refused).unwrap_err().to_string();
        assert_eq!(
            said,
            "the board refuses a command: the value is out of bounds"
        );
        let mut third = sent();
        assert!(third.check(&none).is_ok() && third.check(&none).is_ok());
        let said = third.check(&refused).unwrap_err().to_string();
        assert_eq!(
            said,
            "wall stiffness 9 N·m/rad: the board refuses it: the value is out of bounds"
        );
    }

    #[test]
    fn refusal_is_named_by_the_count_that_changed() {
        let none = Rejected {
            garbage: 1,
            not_finite: 2,
            out_of_bounds: 3,
            unknown: 4,
            unverified: 5,
        };
        assert_eq!(refusal(&none, &none), None);
        let unknown = Rejected { unknown: 5, ..none };
        assert!(
            refusal(&none, &unknown)
                .unwrap()
                .contains("does not have it")
        );
        // The counts wrap.
        let most = Rejected {
            not_finite: u32::MAX,
            ..none
        };
        assert!(refusal(&most, &none).unwrap().contains("not finite"));
    }
}
