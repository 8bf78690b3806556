//! Why a board refuses a command, and why a program of the host refuses a board.

use drivers::link::{Hello, PROTOCOL, Parser, Rejected};
use terminal::failure::Failure;

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
