//! The guided bring-up: what has to be right before a scene runs in closed loop.

mod likely;
mod motors;

use drivers::link::Frame;
use drivers::{Command, Setting};
use terminal::failure::Failure;
use tuned::{DEVICE_FINGERPRINT, PRESETS_FINGERPRINT};

use crate::board::{Answer, Board};
use crate::channels::are_measured;
use crate::check::{Line, failed, show};
use crate::currents;
use crate::interrupt;
use crate::session::Plan;
use crate::settings;
use crate::strokes::{Seen, announce, plan, strokes, watch};
use crate::supply;
use crate::turns;
use crate::watch::cause;
use motors::motors;

/// Length of the observation of a device that should be at rest, s.
const REST_S: f64 = 1.0;
/// Counts by which an encoder at rest may change: it stands on a boundary, or its disc vibrates.
const NOISE: u32 = 2;

/// The lines of a step, from what the board sent.
type Check = fn(&'static str, &Seen) -> Vec<Line>;

/// Checks a board step by step, prints a line for each, and notes in the settings whether the signs are
/// verified. With `turns`, the shafts are turned by hand at first. From the begin until the last check has passed
/// the signs are not verified, even if they were before: whoever checks a board again may have changed its wires.
///
/// # Errors
/// [`Failure::Check`] if a check failed or the checks were interrupted; otherwise those of the session.
pub(crate) fn run(board: &mut Board, turns: bool, store: bool) -> Result<(), Failure> {
    let answer = board.compatible()?;
    // A scene that another program has begun would move the motors in the first check.
    board.disarm()?;
    // At the begin: a tool that is killed sets nothing at its end.
    verify(board, false)?;
    let mut lines = vec![identity(&answer)];
    show(board, &lines[0])?;
    if let Err(none) = currents::allowed(&settings::present(board)?) {
        shown(board, vec![("settings", Err(none))], &mut lines)?;
    }
    let mut pulses = Vec::new();
    if turns && failed(&lines) == 0 {
        match turns::by_hand(board, &answer) {
            Err(Failure::Check(_)) if interrupt::came() => return Err(interrupted()),
            found => pulses = found?,
        }
        turns::shown(board, &pulses, &mut lines)?;
    }
    if failed(&lines) == 0 {
        announce(board);
    }
    let moved: Check = match are_measured(&answer.hello) {
        true => |name, seen| [currents::lines(seen), motors(name, seen)].concat(),
        false => motors,
    };
    let disabled: Check = match supply::is_read(&answer.hello) {
        true => |name, seen| [vec![supply::line(seen)], at_rest(name, seen)].concat(),
        false => at_rest,
    };
    let steps: [(&'static str, Plan, Check); 3] = [
        ("at rest", plan(None, false, REST_S), disabled),
        ("armed, no scene", plan(None, true, REST_S), at_rest),
        ("strokes", strokes(), moved),
    ];
    for (name, plan, check) in steps {
        if failed(&lines) > 0 {
            break;
        }
        let mut seen = Seen::default();
        let found = match watch(board, &answer, plan, &mut seen) {
            Ok(()) => {
                let found = check(name, &seen);
                pulses.extend(seen.indices);
                found
            }
            Err(Failure::Check(_)) if interrupt::came() => return Err(interrupted()),
            Err(Failure::Check(stopped)) => vec![(name, Err(likely::told(stopped, &seen)))],
            Err(failure) => return Err(failure),
        };
        shown(board, found, &mut lines)?;
    }
    if !turns && turns::are_captured(&answer.hello) {
        turns::shown(board, &pulses, &mut lines)?;
    }
    let wrong = failed(&lines);
    if wrong > 0 {
        return Err(Failure::Check(format!(
            "bring-up: {wrong} of {} checks failed; scenes in closed loop are refused",
            lines.len()
        )));
    }
    verify(board, true)?;
    if store {
        return settings::store(board);
    }
    board.note("signs verified until the next reset; cargo drive settings --store keeps it");
    Ok(())
}

/// Sets whether the signs are verified, until the next reset.
fn verify(board: &mut Board, are_right: bool) -> Result<(), Failure> {
    let verified = Setting::SignsVerified;
    let command = Command::Set {
        setting: verified.number(),
        value: f32::from(u8::from(are_right)),
    };
    board.change(command, verified.facts().name)
}

/// The end after an interrupt, which is no failed check.
fn interrupted() -> Failure {
    Failure::Check(
        "bring-up: interrupted before its last check; scenes in closed loop are refused until it passes or the \
         board is reset"
            .to_owned(),
    )
}

/// Prints lines and adds them to those before.
fn shown(board: &mut Board, found: Vec<Line>, lines: &mut Vec<Line>) -> Result<(), Failure> {
    for line in found {
        show(board, &line)?;
        lines.push(line);
    }
    Ok(())
}

/// Whether the image is built for the device of this tool, and the board has no cause of a stop.
fn identity(answer: &Answer) -> Line {
    let hello = &answer.hello;
    let built = [
        (hello.device, DEVICE_FINGERPRINT, "device file"),
        (hello.presets, PRESETS_FINGERPRINT, "presets"),
    ];
    let other = built.iter().find(|(image, tool, _)| *image != tool.0);
    let result = match other {
        Some((_, _, what)) => Err(format!(
            "the image is built for another {what} than this tool; build both with the same DEVICE and PRESETS"
        )),
        None => Ok(format!(
            "firmware {}, commit {}; device and presets as in this tool; last reset: {}",
            hello.version,
            hello.commit,
            cause(hello.cause)
        )),
    };
    ("identity", result)
}

/// Largest change of a count in frames.
fn range(frames: &[Frame], count: impl Fn(&Frame) -> u32) -> u32 {
    let Some(first) = frames.first().map(&count) else {
        return 0;
    };
    let changes = frames
        .iter()
        .map(|frame| count(frame).wrapping_sub(first).cast_signed());
    let (low, high) = changes.fold((0, 0), |(low, high), x| (x.min(low), x.max(high)));
    high.abs_diff(low)
}

/// Whether both encoders rest.
fn at_rest(name: &'static str, Seen { frames, .. }: &Seen) -> Vec<Line> {
    let large = range(frames, |frame| frame.counts_large);
    let handle = range(frames, |frame| frame.counts_small);
    let found = format!(
        "{:.1} s: large encoder within {large} counts, handle encoder within {handle}",
        frames.len() as f64 * 1e-3
    );
    let result = if frames.len() < 100 {
        Err(format!(
            "{} frames came; check the connection",
            frames.len()
        ))
    } else if large.max(handle) <= NOISE {
        Ok(found)
    } else {
        Err(format!(
            "{found}; {NOISE} are allowed: a shaft turns, a line has noise, or a current is not zero \
             (zero-large and zero-small of cargo drive settings)"
        ))
    };
    vec![(name, result)]
}

#[cfg(test)]
mod tests {
    use drivers::link::Hello;

    use super::*;
    use crate::watch::tests::FRAME;

    #[test]
    fn image_for_other_files_than_those_of_the_tool_fails() {
        let result = |device, presets| {
            let hello = Hello {
                device,
                presets,
                ..Hello::default()
            };
            let rejected = None;
            identity(&Answer { hello, rejected }).1
        };
        let [device, presets] = [DEVICE_FINGERPRINT.0, PRESETS_FINGERPRINT.0];
        assert!(result(device, presets).is_ok());
        for (other, what) in [
            (result(device ^ 1, presets), "another device file"),
            (result(device, presets ^ 1), "another presets"),
        ] {
            let error = other.unwrap_err();
            assert!(error.contains(what), "{error}");
        }
    }

    fn is_at_rest(counts: impl Fn(u32) -> (i32, i32), frames: u32) -> bool {
        let frames = (0..frames).map(|seq| Frame {
            counts_large: counts(seq).0.cast_unsigned(),
            counts_small: counts(seq).1.cast_unsigned(),
            ..FRAME
        });
        let seen = Seen {
            frames: frames.collect(),
            ..Seen::default()
        };
        at_rest("", &seen)[0].1.is_ok()
    }

    #[test]
    fn encoders_at_rest_may_change_by_two_counts() {
        // Around the wrap of the counts.
        assert!(is_at_rest(|seq| (seq as i32 % 3 - 1, i32::MIN), 1000));
        assert!(!is_at_rest(|seq| (seq as i32 % 4 - 1, 0), 1000));
        assert!(!is_at_rest(|seq| (0, seq as i32 % 4 - 2), 1000));
        assert!(is_at_rest(|_| (0, 0), 100) && !is_at_rest(|_| (0, 0), 99));
    }
}
