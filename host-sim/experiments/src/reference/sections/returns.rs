//! Rows in which a counter is set to one number, mostly 0, again and again.
//!
//! Such a step is too small for a jump of a counter where the shaft counts up by a few rows' motion alone. What tells it
//! from motion is that the steps end at one count, from different ones, in one row each, and that the shaft turns on as
//! before. A shaft that turns back to a stop is between both in the rows of some of its returns, and rests at the stop.

use recordings::recording::{LONGEST_GAP, Recording};

use super::{Row, Speeds, signed, usual};

/// A step is large if it is this number of times larger than [`usual`] ones plus one count, and no part of a motion if
/// it is so against the steps beside it. It then is twice as large as the distance from one count to which it ends.
const LARGE: f64 = 4.0;

/// Largest distance from one count at which steps end, in usual steps plus one count: the motion in the rest of the row.
const NEAR: f64 = 2.0;

/// Fewest steps to one count. Fewer may each be a fast motion that begins and ends between two rows by chance.
const FEWEST: usize = 4;

/// Least share of the large steps that end at one count without being part of a motion. A shaft that turns back within
/// a twentieth of a row has as many; of readings that fail for several rows half of the steps are such ones.
const SHARE: f64 = 0.9;

/// Largest change of the speed over a step, as a part of the speed and beside one count: a shaft turns on when its counter
/// is set, and rests where it has turned back to a stop.
const CHANGE: f64 = 0.5;

/// Share of the steps from which on those of one size are the wraps of a counter, with a few others.
const OF_ONE_SIZE: f64 = 0.75;

/// Marks the rows of `recording` in which the counter is set to one number again and again.
pub(super) fn mark(recording: &Recording, speeds: &Speeds, kinds: &mut [Row]) {
    for row in found(recording, speeds).unwrap_or_default() {
        kinds[row] = Row::Returned;
    }
}

/// These rows, if there are enough of them.
fn found(recording: &Recording, speeds: &Speeds) -> Option<Vec<usize>> {
    let rows = recording.t.len();
    let longest = LONGEST_GAP * recording.trace.period_s();
    let [usual, _] = usual((1..rows).map(|k| speeds.between(k - 1, k)).collect());
    let unit = 1.0 + usual;
    let is_large = |k: &usize| {
        speeds.between(k - 1, *k) > LARGE * unit && recording.t[*k] - recording.t[k - 1] <= longest
    };
    let large: Vec<usize> = (1..rows).filter(is_large).collect();
    if large.len() < FEWEST {
        return None;
    }
    let count = |k: usize| f64::from(recording.trace.counts_large[k] as i32);
    let end = median(large.iter().map(|k| count(*k)).collect());
    let is_return = |k: &usize| {
        let before = if *k > 1 {
            speeds.between(k - 2, k - 1)
        } else {
            0.0
        };
        let after = if k + 1 < rows {
            speeds.between(*k, k + 1)
        } else {
            0.0
        };
        let is_alone = speeds.between(k - 1, *k) > LARGE * (1.0 + before.max(after));
        is_alone && (count(*k) - end).abs() <= NEAR * unit
    };
    let returns: Vec<usize> = large.iter().copied().filter(is_return).collect();
    let are_many = returns.len() >= FEWEST && returns.len() as f64 >= SHARE * large.len() as f64;
    let sizes = returns.iter().map(|k| signed(recording, k - 1, *k).abs());
    let sizes: Vec<_> = sizes.collect();
    (are_many && turns_on(recording, &returns) && !are_of_one_size(&sizes, NEAR * unit))
        .then_some(returns)
}

/// Whether the shaft moves after most of the rows `returns` as it does before them.
fn turns_on(recording: &Recording, returns: &[usize]) -> bool {
    let inner = returns
        .iter()
        .filter(|k| **k > 1 && **k + 1 < recording.t.len());
    let moved = |k: &usize| {
        [
            signed(recording, k - 2, k - 1),
            signed(recording, *k, k + 1),
        ]
    };
    let moved: Vec<_> = inner.map(moved).collect();
    let changes = moved.iter().map(|[before, after]| (after - before).abs());
    let largest = moved
        .iter()
        .map(|[before, after]| before.abs().max(after.abs()));
    median(changes.collect()) <= 1.0 + CHANGE * median(largest.collect())
}

/// Whether nearly all `sizes` differ from their median by `near` at most.
fn are_of_one_size(sizes: &[f64], near: f64) -> bool {
    let typical = median(sizes.to_vec());
    let close = sizes.iter().filter(|size| (**size - typical).abs() <= near);
    close.count() as f64 >= OF_ONE_SIZE * sizes.len() as f64
}

/// The median of `values`, or the larger one of the two in the middle; 0 without values.
pub(super) fn median(mut values: Vec<f64>) -> f64 {
    let middle = values.len() / 2;
    match values.is_empty() {
        true => 0.0,
        false => *values.select_nth_unstable_by(middle, f64::total_cmp).1,
    }
}

#[cfg(test)]
mod tests {
    use crate::reference::sections::Row;
    use crate::reference::sections::tests::marked;

    /// Numbers from 0 on below `below` in no order.
    fn drawn(k: i64, below: i64) -> i64 {
        (k * 7919 + k * k * 104_729).rem_euclid(10_007) % below
    }

    /// A shaft that moves `step(k)` counts in row k, and whose counter is set to `to` in the rows of `set`.
    fn set_to(to: i64, rows: i64, set: &[i64], step: impl Fn(i64) -> i64) -> Vec<i64> {
        let mut count = to;
        let row = |k| {
            count = if set.contains(&k) {
                to + step(k) / 2
            } else {
                count + step(k)
            };
            count
        };
        (0..rows).map(row).collect()
    }

    /// Rows that are 10 to 35 apart.
    fn at_random(number: i64) -> Vec<i64> {
        let mut at = 0;
        let next = |k| {
            at += 10 + drawn(k, 26);
            at
        };
        (0..number).map(next).collect()
    }

    fn is_marked(counts: &[i64]) -> bool {
        let mut rows = marked(counts).into_iter();
        rows.any(|(_, row)| row == Row::Returned)
    }

    #[test]
    fn counter_that_is_set_to_one_number_is_found() {
        let set = at_random(30);
        let expected: Vec<_> = set.iter().map(|k| (*k as usize, Row::Returned)).collect();
        for to in [0, -70_000] {
            // In one direction, in the other one, and with a speed that changes by a factor of two.
            assert_eq!(
                marked(&set_to(to, 1100, &set, |k| 28 + drawn(k, 4))),
                expected
            );
            assert_eq!(marked(&set_to(to, 1100, &set, |_| -9)), expected);
            let speed = |k: i64| (9.0 + 3.0 * (k as f64 * 0.01).sin()) as i64;
            assert_eq!(marked(&set_to(to, 1100, &set, speed)), expected);
        }
        // Of three steps each may be a fast motion.
        assert!(!is_marked(&set_to(0, 80, &set[..3], |_| 9)));
    }

    #[test]
    fn wraps_of_an_encoder_are_no_returns() {
        // Of 1000 counts a revolution; an index pulse that comes up to 12 counts early sets the counter.
        let wraps: Vec<_> = (0..3000).map(|k| (17 * k) % 1000).collect();
        assert!(!is_marked(&wraps));
        let swing = |k: i64| (3000.0 * (k as f64 * 4e-3).sin()) as i64;
        let both: Vec<_> = (0..5000).map(|k| swing(k).rem_euclid(1000)).collect();
        assert!(!is_marked(&both));
        let index: Vec<_> = (1..40).map(|n| 50 * n - drawn(n, 2)).collect();
        assert!(!is_marked(&set_to(0, 2000, &index, |_| 12)));
    }

    #[test]
    fn fast_motions_and_failed_readings_are_no_returns() {
        // A shaft that springs back to a stop within two rows, or half of a row.
        for fall in [2.0, 0.5] {
            let lever = |k: i64| {
                let (n, phase) = (k / 40, (k % 40) as f64 + drawn(k / 40, 100) as f64 / 100.0);
                let top = 10.0 * (15 + drawn(n, 20)) as f64;
                let rise = top * (phase / 35.0).min(1.0);
                (rise * (1.0 - ((phase - 36.0) / fall).clamp(0.0, 1.0))) as i64
            };
            assert!(
                !is_marked(&(0..4000).map(lever).collect::<Vec<_>>()),
                "{fall}"
            );
        }
        // A spring that turns back from different angles within a row, and rests.
        let spring = |k: i64| match k % 60 {
            phase if phase < 15 + drawn(k / 60, 30) => 20 * phase,
            _ => 0,
        };
        assert!(!is_marked(&(0..4000).map(spring).collect::<Vec<_>>()));
        // A swing that a logger holds for ten rows, or that is slow against its rows.
        let held = |k: i64| (4000.0 * (k as f64 / 10.0).floor().mul_add(0.05, 0.3).sin()) as i64;
        assert!(!is_marked(&(0..4000).map(held).collect::<Vec<_>>()));
        let coarse = |k: i64| (900.0 * (k as f64 * 2.2).sin()) as i64;
        assert!(!is_marked(&(0..400).map(coarse).collect::<Vec<_>>()));
        // Readings that are 0 in one row, and in three rows.
        for failed in [1, 3] {
            let reading = |k: i64| if k % 50 < failed { 0 } else { 700 + 5 * k };
            assert!(
                !is_marked(&(1..2000).map(reading).collect::<Vec<_>>()),
                "{failed}"
            );
        }
        // A positioner between 0 and different places, in one row.
        let place = |k: i64| {
            if k / 20 % 2 == 0 {
                k % 2
            } else {
                300 + 40 * drawn(k / 20, 30)
            }
        };
        assert!(!is_marked(&(0..2000).map(place).collect::<Vec<_>>()));
        // A shaft that is turned by hand, rests, and turns back to a stop at 0 in ten rows.
        let turned = |k: i64| {
            let top = 200 + drawn(k / 200, 400);
            (top * (k % 200).min(100) / 100).min(top * (150 - k % 200).clamp(0, 10) / 10)
        };
        assert!(!is_marked(&(0..6000).map(turned).collect::<Vec<_>>()));
    }
}
