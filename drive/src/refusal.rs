//! Why a board refuses a command, and why a program of the host refuses a board.

use drivers::link::{Hello, PROTOCOL, Parser, Rejected};
use terminal::failure::Failure;

/// Reason of the refusal of a value.
pub(crate) const OUT_OF_BOUNDS: &str = "the value is out of bounds";
/// Reason of the refusal of a scene in closed loop.
pub(crate) const UNVERIFIED: &str =
    "the signs of encoders and currents have not been verified; run cargo drive bring-up";
/// What to do about bytes that reach the board and are no command.
pub const NOISE: &str = "check the line of the board, and end what writes to its debug probe";

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

/// The reason why the board has refused a command between two counts. Bytes that are no command are no refusal.
#[must_use]
pub fn refusal(before: &Rejected, now: &Rejected) -> Option<&'static str> {
    [
        (before.not_finite, now.not_finite, "the value is not finite"),
        (before.out_of_bounds, now.out_of_bounds, OUT_OF_BOUNDS),
        (before.unknown, now.unknown, "the image does not have it"),
        (before.unverified, now.unverified, UNVERIFIED),
    ]
    .into_iter()
    .find_map(|(before, now, reason)| has_grown(before, now).then_some(reason))
}

/// Whether bytes that are no command reached the board between two counts: on its line, or over its debug probe.
/// A command between them may be one of these.
#[must_use]
pub const fn is_damaged(before: &Rejected, now: &Rejected) -> bool {
    has_grown(before.garbage, now.garbage)
}

/// Whether the board has started again between two counts, as far as they tell: a count has gone back.
pub(crate) fn has_started_again(before: &Rejected, now: &Rejected) -> bool {
    let counts = |it: &Rejected| {
        [
            it.garbage,
            it.not_finite,
            it.out_of_bounds,
            it.unknown,
            it.unverified,
        ]
    };
    let mut pairs = counts(before).into_iter().zip(counts(now));
    pairs.any(|(before, now)| has_grown(now, before))
}

/// Whether a count, which wraps, has grown. A board that starts again counts from 0.
#[must_use]
pub const fn has_grown(before: u32, now: u32) -> bool {
    now.wrapping_sub(before).cast_signed() > 0
}

#[cfg(test)]
mod tests {
    use super::*;

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
        for (now, reason) in [
            (
                Rejected {
                    not_finite: 3,
                    ..none
                },
                "not finite",
            ),
            (
                Rejected {
                    out_of_bounds: 4,
                    ..none
                },
                "out of bounds",
            ),
            (Rejected { unknown: 5, ..none }, "does not have it"),
            (
                Rejected {
                    unverified: 6,
                    ..none
                },
                "run cargo drive bring-up",
            ),
        ] {
            assert!(refusal(&none, &now).unwrap().contains(reason), "{reason}");
        }
        // The counts wrap.
        let most = Rejected {
            not_finite: u32::MAX,
            ..none
        };
        assert!(refusal(&most, &none).unwrap().contains("not finite"));
    }

    #[test]
    fn counts_of_a_board_that_started_again_are_no_refusal() {
        let before = Rejected {
            garbage: 7,
            unknown: 1,
            ..Rejected::default()
        };
        let now = Rejected::default();
        assert_eq!(refusal(&before, &now), None);
        assert!(has_started_again(&before, &now));
        assert!(!has_started_again(&now, &before));
        assert!(!has_started_again(&now, &now));
    }

    /// The board may have rejected commands of one kind alone before.
    #[test]
    fn each_count_that_goes_back_tells_a_start() {
        let none = Rejected::default();
        for before in [
            Rejected { garbage: 1, ..none },
            Rejected {
                not_finite: 1,
                ..none
            },
            Rejected {
                out_of_bounds: 1,
                ..none
            },
            Rejected { unknown: 1, ..none },
            Rejected {
                unverified: 1,
                ..none
            },
        ] {
            assert!(has_started_again(&before, &none), "{before:?}");
            assert!(!has_started_again(&none, &before), "{before:?}");
        }
    }

    #[test]
    fn bytes_that_are_no_command_are_no_refusal() {
        let before = Rejected::default();
        let now = Rejected {
            garbage: 1,
            ..before
        };
        assert_eq!(refusal(&before, &now), None);
        assert!(is_damaged(&before, &now) && !is_damaged(&now, &before));
    }
}
