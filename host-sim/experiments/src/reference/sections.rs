//! Where the motion of a recording is lost: long gaps, jumps of the counter and single bad counts.
//!
//! After a gap of more than [`LONGEST_GAP`] periods little of the motion before it is known, and the
//! variances of the smoother are too far apart for its arithmetic. A jump of the counter is no motion.
//! The smoother starts anew after both: rows before and after do not depend on each other. It passes
//! over a single bad count.

mod returns;
mod said;
mod spikes;

use recordings::recording::{LONGEST_GAP, Recording};
use scoring::score::skipped;

pub use said::interruptions;

/// A displacement is no motion if it is this number of times larger than the displacements beside it,
/// plus one count, and than [`USUAL`] of all. An impact has large displacements beside it, and a count
/// that is held for several rows has many of its size.
const JUMP: f64 = 30.0;

/// Share of the displacements, of those that are not 0, that are usual.
const USUAL: f64 = 0.9;

/// A displacement is no motion either if it is this number of times larger than the displacements beside it, plus one
/// count, and than the fastest of all but [`FASTEST`] of them, and but [`FEW`]: a shaft does not come to many times its
/// highest speed for one row.
const RESET: f64 = 10.0;
const FASTEST: f64 = 1e-3;
const FEW: usize = 3;

/// What a row says of the motion.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Row {
    /// It continues the motion of the row before.
    Next,
    /// It begins another motion: the counter has jumped.
    Jumped,
    /// It begins another motion: the counter was set to a number to which it is set again and again.
    Returned,
    /// It begins another motion: a gap of more than [`LONGEST_GAP`] periods is before it.
    Resumed,
    /// Nothing: its count is bad.
    Bad,
}

/// The motion of a recording.
#[derive(Clone, Debug)]
pub(super) struct Motion {
    /// What each row says of it.
    pub rows: Vec<Row>,
    /// Largest displacement from a row to one that continues its motion, counts.
    pub fastest: f64,
}

impl Motion {
    /// The motion of `recording`.
    pub(super) fn of(recording: &Recording) -> Self {
        let rows = rows(recording);
        let fastest = fastest(recording, &rows);
        Self { rows, fastest }
    }
}

/// Least share of the rows at which an estimate is scored. Of a counter that is bad everywhere the errors at
/// the few other rows say nothing.
const LEAST_KNOWN: f64 = 0.5;

/// Whether an estimate is scored at each of `rows` at `rate_hz`: not at a row that is no motion of a shaft or that
/// follows a long gap, nor within [`SKIP_S`](scoring::score::SKIP_S) after it, as estimators do not know such rows and
/// begin anew. `None` if it is scored at all of them: there is no such row, or less than [`LEAST_KNOWN`] of the scored
/// rows would be left.
pub(super) fn known(rows: &[Row], rate_hz: f64) -> Option<Vec<bool>> {
    let passed = skipped(rate_hz).max(1);
    let mut since = passed;
    let is_known = |row: &Row| {
        since = match row {
            Row::Next => since + 1,
            Row::Jumped | Row::Returned | Row::Resumed | Row::Bad => 0,
        };
        since >= passed
    };
    let known: Vec<_> = rows.iter().map(is_known).collect();
    let scored = known.get(skipped(rate_hz)..).unwrap_or_default();
    let number = scored.iter().filter(|known| **known).count();
    let is_part = number < scored.len() && number as f64 >= LEAST_KNOWN * scored.len() as f64;
    is_part.then_some(known)
}

/// What each row of `recording` says of the motion.
pub(super) fn rows(recording: &Recording) -> Vec<Row> {
    let rows = recording.t.len();
    let mut kinds = vec![Row::Next; rows];
    let speeds = Speeds::of(recording);
    returns::mark(recording, &speeds, &mut kinds);
    let period = recording.trace.period_s();
    let speed = |from: usize, to: usize| speeds.between(from, to);
    let of_motion = (1..rows).filter(|k| kinds[*k] == Row::Next);
    let [usual, fastest] = usual(of_motion.map(|k| speed(k - 1, k)).collect());
    let jumps = |step: f64, beside: f64| {
        let beside = 1.0 + beside;
        step > JUMP * beside.max(usual) || step > RESET * beside.max(fastest)
    };
    let (mut last, mut before) = (0, 0.0);
    for (k, kind) in kinds.iter_mut().enumerate().skip(1) {
        let step = speed(last, k);
        let is_last = k + 1 == rows;
        if *kind == Row::Returned {
            (last, before) = (k, 0.0);
        } else if recording.t[k] - recording.t[k - 1] > LONGEST_GAP * period {
            *kind = Row::Resumed;
            (last, before) = (k, 0.0);
        } else if !jumps(step, before) {
            (last, before) = (k, step);
        } else if is_last || jumps(speed(k, k + 1), before) && !jumps(speed(last, k + 1), before) {
            *kind = Row::Bad;
        } else if jumps(step, speed(k, k + 1)) {
            *kind = Row::Jumped;
            last = k;
        } else {
            (last, before) = (k, step);
        }
    }
    spikes::mark(recording, &mut kinds);
    kinds
}

/// Speeds between rows of a recording, counts per period.
struct Speeds<'a> {
    recording: &'a Recording,
    period: f64,
}

impl<'a> Speeds<'a> {
    fn of(recording: &'a Recording) -> Self {
        Self {
            recording,
            period: recording.trace.period_s(),
        }
    }

    /// Magnitude of the mean speed from a row to another. Rows closer than a period are those of a late clock.
    fn between(&self, from: usize, to: usize) -> f64 {
        let periods = (self.recording.t[to] - self.recording.t[from]) / self.period;
        f64::from(displacement(self.recording, from, to)) / periods.max(1.0)
    }
}

/// Displacement between two rows, counts.
fn signed(recording: &Recording, from: usize, to: usize) -> f64 {
    let counts = &recording.trace.counts_large;
    f64::from(counts[to].wrapping_sub(counts[from]) as i32)
}

/// Its magnitude.
fn displacement(recording: &Recording, from: usize, to: usize) -> u32 {
    signed(recording, from, to).abs() as u32
}

/// The largest usual speed, which is 0 for a count that does not change, and the highest one of a motion, which is
/// infinite for few changes.
fn usual(mut speeds: Vec<f64>) -> [f64; 2] {
    speeds.retain(|speed| *speed > 0.0);
    speeds.sort_by(f64::total_cmp);
    let share = (speeds.len() as f64 * USUAL) as usize;
    let beyond = FEW.max((speeds.len() as f64 * FASTEST) as usize);
    let fastest = speeds.iter().rev().nth(beyond).copied();
    let usual = speeds.get(share).copied().unwrap_or_default();
    let determined = speeds.len() > 10 * FEW;
    [
        usual,
        fastest.filter(|_| determined).unwrap_or(f64::INFINITY),
    ]
}

/// Largest displacement from a row to one that continues its motion, counts.
fn fastest(recording: &Recording, rows: &[Row]) -> f64 {
    let (mut last, mut fastest) = (0, 0);
    for (k, row) in rows.iter().enumerate() {
        if *row == Row::Next {
            fastest = fastest.max(displacement(recording, last, k));
        }
        if *row != Row::Bad {
            last = k;
        }
    }
    f64::from(fastest)
}

#[cfg(test)]
mod tests {
    use simulation::trace::Trace;

    use super::*;

    pub(super) fn recording(counts: &[i64]) -> Recording {
        Recording {
            t: (0..counts.len()).map(|k| k as f64 * 1e-3).collect(),
            trace: Trace {
                rate_hz: 1e3,
                counts_large: counts.iter().map(|count| *count as u32).collect(),
                ..Trace::default()
            },
            ..Recording::default()
        }
    }

    /// The rows that do not continue a motion.
    pub(super) fn marked(counts: &[i64]) -> Vec<(usize, Row)> {
        let rows = Motion::of(&recording(counts)).rows.into_iter().enumerate();
        rows.filter(|(_, row)| *row != Row::Next).collect()
    }

    /// A motion of three counts a row.
    pub(super) fn steady() -> Vec<i64> {
        (0..100).map(|k| 3 * k).collect()
    }

    #[test]
    fn single_bad_counts_are_passed_over() {
        let mut counts = steady();
        for k in [10, 20, 22, 99] {
            counts[k] = 1 << 24;
        }
        let bad = [10, 20, 22, 99].map(|k| (k, Row::Bad));
        assert_eq!(marked(&counts), bad);
        // Two rows of three counts.
        assert_eq!(Motion::of(&recording(&counts)).fastest, 6.0);
    }

    #[test]
    fn jump_that_stays_begins_another_motion() {
        let mut counts = steady();
        counts[25..].iter_mut().for_each(|count| *count += 1 << 20);
        assert_eq!(marked(&counts), [(25, Row::Jumped)]);
        assert_eq!(Motion::of(&recording(&counts)).fastest, 3.0);
    }

    #[test]
    fn counter_that_jumps_by_many_times_the_highest_speed_is_found() {
        // At most 8 counts a row, and no more than 7 in most of them.
        let swing = |k: i64| (1600.0 * (k as f64 * 5e-3).sin()).floor() as i64;
        for (at, jump, found) in [
            (900, 120, true),
            (950, -120, true),
            (2200, 300, true),
            (900, 60, false),
        ] {
            let counts: Vec<_> = (0..3000)
                .map(|k| swing(k) + if k < at { 0 } else { jump })
                .collect();
            let expected = [(at as usize, Row::Jumped)];
            assert_eq!(
                marked(&counts),
                expected[..usize::from(found)],
                "{at} {jump}"
            );
        }
        // Short motion in a log of rest with noise.
        let brief = |k: i64| k % 2 + 40 * (k - 2000).clamp(0, 12);
        assert_eq!(marked(&(0..4000).map(brief).collect::<Vec<_>>()), []);
    }

    #[test]
    fn rows_that_are_no_motion_and_a_tenth_of_a_second_after_are_not_known() {
        let rows = |marked: &[usize]| -> Vec<_> {
            let row = |k| match marked.iter().position(|at| *at == k) {
                None => Row::Next,
                Some(nth) => [Row::Bad, Row::Jumped, Row::Resumed][nth % 3],
            };
            (0..40).map(row).collect()
        };
        let unknown = |marked: &[usize]| {
            let known = known(&rows(marked), 50.0)?;
            Some((0..40).filter(|k| !known[*k]).collect::<Vec<_>>())
        };
        assert_eq!(unknown(&[]), None);
        assert_eq!(
            unknown(&[0, 9]),
            Some(vec![0, 1, 2, 3, 4, 9, 10, 11, 12, 13])
        );
        assert_eq!(
            unknown(&[7, 8, 38]),
            Some(vec![7, 8, 9, 10, 11, 12, 38, 39])
        );
        // Rows that are not scored anyway.
        assert_eq!(unknown(&[0]), None);
        // Of 35 scored rows 18 are left, and 17.
        assert_eq!(unknown(&[5, 10, 15, 38]).map(|rows| rows.len()), Some(17));
        assert_eq!(unknown(&[5, 10, 15, 37]), None);
    }

    #[test]
    fn abrupt_motion_is_no_jump() {
        // From rest to 50 counts a row, and back.
        let counts: Vec<_> = (0..40).map(|k| 50 * (k - 20).clamp(0, 4)).collect();
        assert_eq!(marked(&counts), []);
        // A count that is held for ten rows at a time.
        let held: Vec<_> = (0..400).map(|k| k / 10 * 80).collect();
        assert_eq!(marked(&held), []);
        assert_eq!(marked(&vec![7; 40]), []);
    }

    #[test]
    fn motion_after_a_long_gap_is_not_that_before_it() {
        let mut recording = recording(&steady());
        recording.t[50..].iter_mut().for_each(|t| *t += 0.201);
        let motion = Motion::of(&recording);
        let resumed: Vec<_> = (0..100).filter(|k| motion.rows[*k] != Row::Next).collect();
        assert_eq!((resumed, motion.rows[50]), (vec![50], Row::Resumed));
        let line = interruptions(&recording, None).unwrap();
        let said = "counts_large has a long gap before t = 0.251 s: cut the log there; all scores contain what \
                    estimators do not know there";
        assert_eq!(line, said);
        // The displacement over the gap is not that of a row.
        recording.trace.counts_large[50..]
            .iter_mut()
            .for_each(|count| *count += 5000);
        assert_eq!(Motion::of(&recording).fastest, 3.0);
        recording.t[50..].iter_mut().for_each(|t| *t -= 2e-3);
        assert_eq!(Motion::of(&recording).rows[50], Row::Next);
    }

    #[test]
    fn displacement_over_a_gap_is_no_jump() {
        let counts: Vec<_> = (0..40)
            .map(|k| if k < 20 { 3 * k } else { 3 * k + 180 })
            .collect();
        let mut recording = recording(&counts);
        recording.t[20..].iter_mut().for_each(|t| *t += 60e-3);
        assert!(rows(&recording).iter().all(|row| *row == Row::Next));
    }
}
