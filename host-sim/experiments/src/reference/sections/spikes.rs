//! Single counts that are off the line through those beside them.

use recordings::recording::Recording;

use super::{Row, signed};

/// A bad count is this number of times farther from the line than the share [`CLOSE`] of all counts.
const SPIKE: f64 = 10.0;

/// Share of the counts whose distance from the line is usual.
const CLOSE: f64 = 0.98;

/// Smallest distance of a bad count from the line, counts: that of one beside counts that rest.
const COUNTS: f64 = 30.0;

/// Fewest rows of which one has a line, and both rows beside it have one.
const FEWEST: usize = 5;

/// Marks single counts that are far from the line through the two beside them, which a shaft does not leave for one row.
/// A count that was read late by less than a period is as far from it as the shaft moves in a row: a bad one is farther.
/// The first and the last two rows are not marked.
pub(super) fn mark(recording: &Recording, kinds: &mut [Row]) {
    if kinds.len() < FEWEST {
        return;
    }
    // Distance from the line, counts; 0 where a row beside is no part of the motion.
    let from_line = |k: usize| {
        if k == 0 || k + 1 >= kinds.len() || kinds[k - 1..=k + 1] != [Row::Next; 3] {
            return 0.0;
        }
        let t = &recording.t[k - 1..=k + 1];
        let share = (t[1] - t[0]) / (t[2] - t[0]);
        let [to, over] = [k, k + 1].map(|to| signed(recording, k - 1, to));
        to - share * over
    };
    let distances: Vec<f64> = (0..kinds.len()).map(from_line).collect();
    let mut sizes: Vec<f64> = distances.iter().map(|distance| distance.abs()).collect();
    let close = (sizes.len() as f64 * CLOSE) as usize;
    let close = *sizes.select_nth_unstable_by(close, f64::total_cmp).1;
    let bound = (SPIKE * close).max(COUNTS);
    for k in 2..kinds.len() - 2 {
        let at = distances[k];
        // A bad count has half of its distance, with the other sign, on both sides; a jump has its own on one side.
        let is_alone = [k - 1, k + 1].into_iter().all(|beside| {
            let half = -distances[beside] / at;
            (0.25..0.75).contains(&half)
        });
        if at.abs() > bound && is_alone {
            let moved = [(k - 2, k - 1), (k + 1, k + 2)]
                .map(|(from, to)| signed(recording, from, to).abs());
            if at.abs() > moved[0].max(moved[1]) {
                kinds[k] = Row::Bad;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::Row;
    use crate::reference::sections::tests::marked;

    #[test]
    fn single_count_far_from_the_line_through_its_neighbours_is_bad() {
        // A swing of up to 40 counts a row, with one row that is off.
        let swing = |k: usize| (2000.0 * (k as f64 * 0.02).sin()).floor() as i64;
        let off = |at: usize, by: i64| -> Vec<_> {
            (0..2000)
                .map(|k| swing(k) + if k == at { by } else { 0 })
                .collect()
        };
        // The shaft turns back at row 1021.
        for (at, by, is_bad) in [
            (942, 60, true),
            (942, -60, true),
            // A row that was read late is as far off as the shaft moves, at most.
            (942, 38, false),
            (1021, 60, true),
            (1021, 35, true),
            (1021, 25, false),
        ] {
            let expected = [(at, Row::Bad)];
            let found = marked(&off(at, by));
            assert_eq!(found, expected[..usize::from(is_bad)], "{at} {by}");
        }
        // A counter that jumps by less than ten rows' motion does not come back.
        let jump: Vec<_> = (0..2000_i64)
            .map(|k| 8 * k + if k < 900 { 0 } else { 70 })
            .collect();
        assert_eq!(marked(&jump), []);
        // A shaft that is struck changes its speed in one row.
        let struck: Vec<_> = (0..2000_i64)
            .map(|k| 3 * k + 90 * (k - 900).max(0))
            .collect();
        assert_eq!(marked(&struck), []);
        // A noise of up to 11 counts, in which 60 counts are one outlier, and 300 are bad.
        let noisy = |by| -> Vec<_> {
            let noise = |k: usize| (k * 7919 % 23) as i64 - 11;
            off(500, by)
                .iter()
                .enumerate()
                .map(|(k, count)| count + noise(k))
                .collect()
        };
        assert_eq!(marked(&noisy(60)), []);
        assert_eq!(marked(&noisy(300)), [(500, Row::Bad)]);
        for rows in 0..8 {
            assert_eq!(marked(&(0..rows).collect::<Vec<_>>()), []);
        }
    }
}
