//! Counts of a turn, measured between index pulses, against those of the device file.

use drivers::link::{Hello, Index};
use terminal::failure::Failure;
use tuned::DEVICE;

use crate::board::{Answer, Board};
use crate::check::{Line, show, skip};
use crate::strokes::{observe, plan};

/// Feature of an image that captures index pulses.
const FEATURE: &str = "index-pulse";

/// Largest difference of a turn from the counts of the device file: that of pulses of one place.
const TOLERANCE: u32 = haptic_control::Index::TOLERANCE;

/// Longest time for the turns by hand, s, in parts after each of which the turns are looked for.
const PART_S: f64 = 1.0;
const PARTS: usize = 30;

/// An encoder with its index.
struct Encoder {
    /// Name of the check.
    check: &'static str,
    /// Its table in the device file.
    table: &'static str,
    /// Counts of a turn by the device file.
    counts_per_turn: u32,
    /// Number of pulses, and count of the latest one.
    pulse: fn(&Index) -> (u32, u32),
}

const ENCODERS: [Encoder; 2] = [
    Encoder {
        check: "turn, large encoder",
        table: "large",
        counts_per_turn: DEVICE.large.counts_per_rev,
        pulse: |index| (index.pulses_large, index.count_large),
    },
    Encoder {
        check: "turn, handle encoder",
        table: "small",
        counts_per_turn: DEVICE.small.counts_per_rev,
        pulse: |index| (index.pulses_small, index.count_small),
    },
];

/// Whether an image captures index pulses.
pub(crate) fn are_captured(hello: &Hello) -> bool {
    hello.features.has(FEATURE)
}

/// Watches both shafts while they are turned by hand, with the amplifiers disabled, until both have made a
/// turn or the time is over.
///
/// # Errors
/// [`Failure::Check`] if the image captures no index pulses; otherwise those of the session.
pub(crate) fn by_hand(board: &mut Board, answer: &Answer) -> Result<Vec<Index>, Failure> {
    if !are_captured(&answer.hello) {
        return Err(Failure::Check(format!(
            "bring-up --turns: the image does not have the feature {FEATURE}; build it with this feature, or \
             leave --turns out"
        )));
    }
    board.note(format_args!(
        "turn the shafts of both motors by hand, through two turns in one direction, within {:.0} s; the \
         amplifiers are disabled",
        PART_S * PARTS as f64
    ));
    let pulses = until_turned(|| {
        let seen = observe(board, answer, plan(None, false, PART_S))?;
        Ok(seen.indices)
    })?;
    board.note(format_args!("take your hands off the device"));
    Ok(pulses)
}

/// The pulses of one part of the time after the other, until both shafts have made a turn or the time is over.
fn until_turned(
    mut part: impl FnMut() -> Result<Vec<Index>, Failure>,
) -> Result<Vec<Index>, Failure> {
    let mut pulses = Vec::new();
    for _ in 0..PARTS {
        pulses.extend(part()?);
        if have_turned(&pulses) {
            break;
        }
    }
    Ok(pulses)
}

/// Whether both shafts have made a turn.
fn have_turned(pulses: &[Index]) -> bool {
    ENCODERS
        .iter()
        .all(|encoder| !turns(pulses, encoder).is_empty())
}

/// Prints the lines on both encoders, and adds them to those before. An encoder without a turn has a line that
/// is no check.
///
/// # Errors
/// [`Failure`] if standard output takes no line.
pub(crate) fn shown(
    board: &mut Board,
    pulses: &[Index],
    lines: &mut Vec<Line>,
) -> Result<(), Failure> {
    for (check, result) in found(pulses) {
        let Some(result) = result else {
            skip(
                board,
                check,
                "not seen: run cargo drive bring-up --turns, and turn the shaft by hand through two turns",
            )?;
            continue;
        };
        let line = (check, result);
        show(board, &line)?;
        lines.push(line);
    }
    Ok(())
}

/// The result of each encoder; `None` without a turn.
fn found(pulses: &[Index]) -> [(&'static str, Option<Result<String, String>>); 2] {
    let of = |encoder: &Encoder| (encoder.check, counted(&turns(pulses, encoder), encoder));
    ENCODERS.each_ref().map(of)
}

/// Counts from each index pulse of an encoder to the next one, in messages in their order. Pulses at one
/// place, which a shaft passes in both directions, are no turn. Pulses whose messages were lost are left out.
fn turns(pulses: &[Index], encoder: &Encoder) -> Vec<u32> {
    let distance = |pair: &[Index]| {
        let [(before, from), (after, to)] = [&pair[0], &pair[1]].map(encoder.pulse);
        let distance = to.wrapping_sub(from).cast_signed().unsigned_abs();
        // Without a reference there is no pulse.
        let is_next = before > 0 && after == before.wrapping_add(1);
        (is_next && distance > TOLERANCE).then_some(distance)
    };
    pulses.windows(2).filter_map(distance).collect()
}

/// Whether all turns have the counts of the device file; `None` without a turn.
fn counted(turns: &[u32], encoder: &Encoder) -> Option<Result<String, String>> {
    let stated = encoder.counts_per_turn;
    let is_wrong = |turn: &&u32| turn.abs_diff(stated) > TOLERANCE;
    let turn = turns.iter().find(is_wrong).or(turns.first())?;
    let found = format!("{turn} counts from index to index, {stated} in the device file");
    if !is_wrong(&turn) {
        return Some(Ok(found));
    }
    let others = turns.iter().find(|other| other.abs_diff(*turn) > TOLERANCE);
    Some(Err(match others {
        Some(other) => format!(
            "{found}, and {other} in another turn: counts are lost or gained; check cable, receiver and \
             index line of the encoder"
        ),
        None => format!(
            "{found}: set counts_per_rev in [{}] of the device file to four times the lines of the \
             encoder, which is near {turn}, and build image and tool for this file",
            encoder.table
        ),
    }))
}

#[cfg(test)]
mod tests {
    use drivers::link::FEATURES;

    use super::*;

    const LARGE: &Encoder = &ENCODERS[0];
    /// Counts of a turn of the large encoder by the device file.
    const N: u32 = LARGE.counts_per_turn;

    /// The messages of pulses of the large encoder: their numbers and counts.
    fn pulses(pairs: &[(u32, u32)]) -> Vec<Index> {
        let message = |(pulses_large, count_large): &(u32, u32)| Index {
            pulses_large: *pulses_large,
            count_large: *count_large,
            ..NOTHING
        };
        pairs.iter().map(message).collect()
    }

    const NOTHING: Index = Index {
        seq: 0,
        pulses_large: 0,
        count_large: 0,
        deviation_large: 0,
        position_large: 0,
        pulses_small: 0,
        count_small: 0,
        deviation_small: 0,
        position_small: 0,
    };

    fn counted_large(pairs: &[(u32, u32)]) -> Option<Result<String, String>> {
        counted(&turns(&pulses(pairs), LARGE), LARGE)
    }

    #[test]
    fn feature_is_one_of_the_firmware() {
        assert!(FEATURES.contains(&FEATURE));
    }

    #[test]
    fn pulses_of_one_place_of_no_reference_and_after_lost_messages_are_no_turn() {
        for none in [
            &[][..],
            &[(1, 50)],
            // The same pulse again, and a reversal over an index of two counts.
            &[(1, 50), (1, 50), (2, 53), (3, 50)],
            // The first pulse after the begin.
            &[(0, 0), (1, N)],
            // A message between them was lost.
            &[(1, 50), (3, 50 + 2 * N)],
            // The reference was taken anew.
            &[(4, 50), (1, 50 + 2 * N)],
        ] {
            assert_eq!(counted_large(none), None, "{none:?}");
        }
    }

    #[test]
    fn turn_of_the_device_file_passes_in_both_directions_and_over_the_wrap() {
        for (from, to) in [(0, N), (N, 0), (u32::MAX - 5, N - 3), (50, 50 + N - 3)] {
            let passed = counted_large(&[(7, from), (7, from), (8, to)]);
            let text = passed.expect("a turn").expect("right");
            assert!(
                text.ends_with(&format!(" {N} in the device file")),
                "{text}"
            );
        }
    }

    #[test]
    fn multiple_and_part_of_the_counts_fail_with_both_numbers() {
        for turn in [2 * N, 3 * N, 4 * N, N / 2, N / 4, N - 4, N + 4, 2000] {
            let wrong = counted_large(&[(1, 9), (2, 9 + turn), (3, 9 + 2 * turn)]);
            let text = wrong.expect("a turn").expect_err("wrong");
            let begin = format!(
                "{turn} counts from index to index, {N} in the device file: set counts_per_rev in [large]"
            );
            assert!(text.starts_with(&begin), "{text}");
        }
    }

    #[test]
    fn turns_of_different_counts_fail_as_lost_counts() {
        for wrong in [[N, N - 8], [N - 8, N]] {
            let [first, second] = wrong;
            let found = counted_large(&[(1, 0), (2, first), (3, first + second)]);
            let text = found.expect("turns").expect_err("wrong");
            let begin = format!(
                "{} counts from index to index, {N} in the device file, and {N} in",
                N - 8
            );
            assert!(text.starts_with(&begin), "{text}");
        }
    }

    /// The messages of a turn of the small encoder.
    fn turn_of_small() -> [Index; 2] {
        let turn = [(1, 10), (2, 10 + ENCODERS[1].counts_per_turn)];
        turn.map(|(pulses_small, count_small)| Index {
            pulses_small,
            count_small,
            ..NOTHING
        })
    }

    #[test]
    fn turns_by_hand_end_with_those_of_both_shafts() {
        let mut seen = pulses(&[(1, 10), (2, 10 + N)]);
        assert!(!have_turned(&seen) && !have_turned(&turn_of_small()));
        seen.extend(turn_of_small());
        assert!(have_turned(&seen));
    }

    /// One shaft is turned after the other, in parts of the time.
    #[test]
    fn no_part_is_awaited_after_the_turns_of_both_shafts() {
        let large = pulses(&[(1, 10), (2, 10 + N)]);
        let parts = [vec![], large, vec![], turn_of_small().into()];
        let mut left = parts.into_iter();
        let found = until_turned(|| Ok(left.next().expect("no part more")));
        assert!(have_turned(&found.unwrap()));
    }

    #[test]
    fn time_for_turns_ends_without_one() {
        let mut parts = 0;
        let found = until_turned(|| {
            parts += 1;
            Ok(Vec::new())
        });
        assert_eq!((found, parts), (Ok(Vec::new()), PARTS));
    }

    #[test]
    fn each_encoder_has_its_own_pulses() {
        let [large, handle] = found(&turn_of_small());
        assert_eq!(large, ("turn, large encoder", None));
        assert_eq!(handle.0, "turn, handle encoder");
        assert!(handle.1.expect("a turn").is_ok());
    }
}
