//! What to check after a stop of the board in the bring-up, by its cause.

use haptic_control::Stop;

use crate::strokes::Seen;
use crate::watch::state;

/// The failure of a check in which the board has stopped: state, cause, and what to check. `stopped` is the failure
/// of the session, which stays where the cause has no likely reason in the bring-up.
pub(super) fn told(stopped: String, seen: &Seen) -> String {
    let Some(last) = seen.frames.last() else {
        return stopped;
    };
    match Stop::from_code(last.cause).and_then(check) {
        Some(check) => format!("the board stopped: {}: {check}", state(last)),
        None => stopped,
    }
}

/// The likely reasons of a cause while a board is checked, and what to check.
const fn check(stop: Stop) -> Option<&'static str> {
    Some(match stop {
        Stop::TorqueBalance => {
            "a line of the large encoder is stuck or not connected, the handle's encoder counts backwards or not at \
             all, or a lead of the large motor is open; check lines A and B of both encoders, which have to count \
             up in one direction of their shafts, and the large motor's leads"
        }
        Stop::RunawayDirection => {
            "the large motor turns against its current; exchange lines A and B of its encoder, or its leads: a \
             positive current has to turn its counts up"
        }
        Stop::Stall => {
            "the large motor does not turn, or its encoder does not count; check that the shaft is free, lines A \
             and B of the large encoder, and the large motor's leads and amplifier"
        }
        Stop::Jump => {
            "a count was read wrong, by noise on a line of an encoder or a loose contact; check cable, screen and \
             receiver of both encoders"
        }
        Stop::LostCounts => {
            "an encoder counts too few or too many, its index line is disturbed, or counts_per_rev of the device \
             file is wrong; check cable and receiver of the encoders, and run cargo drive bring-up --turns"
        }
        _ => return None,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::watch::tests::FRAME;

    #[test]
    fn cause_of_the_last_frame_decides_what_to_check() {
        let of = |cause: Stop| {
            let last = drivers::link::Frame {
                cause: cause as u8,
                ..FRAME
            };
            let seen = Seen {
                frames: vec![FRAME, last],
                ..Seen::default()
            };
            told("as before".to_owned(), &seen)
        };
        for (cause, wanted) in [
            (Stop::TorqueBalance, "A and B of both encoders"),
            (Stop::RunawayDirection, "exchange lines A and B"),
            (Stop::Stall, "shaft is free"),
            (Stop::Jump, "screen"),
            (Stop::LostCounts, "counts_per_rev"),
        ] {
            let text = of(cause);
            assert!(text.contains(wanted), "{text}");
            assert!(
                text.contains(&format!("cause {}: ", cause.as_str())),
                "{text}"
            );
        }
        assert_eq!(of(Stop::AmplifierFault), "as before");
        assert_eq!(told("as before".to_owned(), &Seen::default()), "as before");
    }
}
