//! What is said of rows that are no motion.

use recordings::recording::{Recording, shown};
use scoring::score::SKIP_S;

use super::returns::median;
use super::{Row, rows, signed};
use crate::reference::Reference;

/// A count is nearly zero if it is at most this part of the steps to it.
const ZERO: f64 = 0.25;

/// Times that a message lists.
const LISTED: usize = 8;

/// One line on the rows of `recording` that are no motion of a shaft, or that follow a long gap; `None` if there are
/// none. Its scores are against `reference`, or against a true velocity.
///
/// Estimators do not know these rows: one of them can decide which estimator has the smallest error.
#[must_use]
pub fn interruptions(recording: &Recording, reference: Option<&Reference>) -> Option<String> {
    let rows = rows(recording);
    let cut = "cut the log there";
    let set = "the counter is set anew there; log it without that, or cut the log there";
    let returns = returned(recording, &rows);
    let remedies = [
        (Row::Bad, "is bad at", "delete these rows"),
        (Row::Jumped, "jumps at", cut),
        (Row::Returned, &returns[..], set),
        (Row::Resumed, "has a long gap before", cut),
    ];
    let said = remedies.iter().filter_map(|(kind, what, remedy)| {
        let of_kind = || {
            rows.iter()
                .zip(&recording.t)
                .filter(|(row, _)| *row == kind)
        };
        let times: Vec<_> = of_kind().take(LISTED).map(|(_, t)| shown(*t)).collect();
        let listed = times.join(", ");
        let more = match of_kind().skip(LISTED).count() {
            0 => String::new(),
            1 => " and at 1 row more".to_owned(),
            more => format!(" and at {more} rows more"),
        };
        (!times.is_empty()).then(|| format!("{what} t = {listed} s{more}: {remedy}"))
    });
    let said: Vec<_> = said.collect();
    let is_left_out = reference.is_some_and(|reference| reference.known.is_some());
    let has_motion = rows
        .iter()
        .all(|row| matches!(row, Row::Next | Row::Resumed));
    let scores = match (is_left_out, has_motion) {
        (true, _) => format!("scores leave out these rows and {SKIP_S} s after each"),
        (false, true) => "all scores contain what estimators do not know there".to_owned(),
        (false, false) => "all scores contain what is no motion of a shaft".to_owned(),
    };
    (!said.is_empty()).then(|| format!("counts_large {}; {scores}", said.join(", and ")))
}

/// Where the counter goes in the rows in which it is set to one number.
fn returned(recording: &Recording, rows: &[Row]) -> String {
    let set = || (1..rows.len()).filter(|k| rows[*k] == Row::Returned);
    let counts = &recording.trace.counts_large;
    let to = median(set().map(|k| f64::from(counts[k] as i32)).collect());
    let size = median(set().map(|k| signed(recording, k - 1, k).abs()).collect());
    let to = if to.abs() <= ZERO * size { 0.0 } else { to };
    format!(
        "returns to nearly {to} from different counts in {} rows, at",
        set().count()
    )
}

#[cfg(test)]
mod tests {
    use super::interruptions;
    use crate::reference::sections::tests::{recording, steady};

    #[test]
    fn interruptions_are_named_with_their_times_and_remedies() {
        let mut counts = steady();
        assert_eq!(interruptions(&recording(&counts), None), None);
        let scores = "all scores contain what is no motion of a shaft";
        for (k, said) in [(40, "0.04"), (30, "0.03, 0.04"), (50, "0.03, 0.04, 0.05")] {
            counts[k] += 1 << 20;
            let line = interruptions(&recording(&counts), None).unwrap();
            let said = format!("counts_large is bad at t = {said} s: delete these rows; {scores}");
            assert_eq!(line, said);
        }
        counts[60..].iter_mut().for_each(|count| *count += 1 << 20);
        let line = interruptions(&recording(&counts), None).unwrap();
        let said = "0.05 s: delete these rows, and jumps at t = 0.06 s: cut the log there; all";
        assert!(line.contains(said), "{line}");
        let set = recording(
            &counts[60..70]
                .iter()
                .chain(&counts[..30])
                .copied()
                .collect::<Vec<_>>(),
        );
        let said = format!("counts_large jumps at t = 0.01 s: cut the log there; {scores}");
        assert_eq!(interruptions(&set, None), Some(said));
    }

    #[test]
    fn many_interruptions_are_counted() {
        let mut counts: Vec<_> = (0..300).map(|k| 3 * k).collect();
        for k in 1..=9 {
            counts[10 * k] += 1 << 20;
        }
        let line = interruptions(&recording(&counts), None).unwrap();
        let said = "t = 0.01, 0.02, 0.03, 0.04, 0.05, 0.06, 0.07, 0.08 s and at 1 row more: delete";
        assert!(line.contains(said), "{line}");
        counts[95] += 1 << 20;
        let line = interruptions(&recording(&counts), None).unwrap();
        assert!(line.contains("0.08 s and at 2 rows more: delete"), "{line}");
    }

    #[test]
    fn counter_that_is_set_to_zero_again_and_again_is_named() {
        // Three counts a row; it is set after 20, 30, 20, 40, ... rows.
        let mut counts = Vec::new();
        for rows in [20, 30, 20, 40, 25, 60, 35] {
            counts.extend((0..rows).map(|k| 3 * k + 1));
        }
        let said = |counts: &[i64]| interruptions(&recording(counts), None).unwrap();
        let times = "t = 0.02, 0.05, 0.07, 0.11, 0.135, 0.195 s: the counter is set anew there; log it without that, or \
                     cut the log there; all scores contain what is no motion of a shaft";
        let from = "from different counts in 6 rows, at";
        assert_eq!(
            said(&counts),
            format!("counts_large returns to nearly 0 {from} {times}")
        );
        counts.iter_mut().for_each(|count| *count -= 5000);
        assert_eq!(
            said(&counts),
            format!("counts_large returns to nearly -4999 {from} {times}")
        );
    }
}
