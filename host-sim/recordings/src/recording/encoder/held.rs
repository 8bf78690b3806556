//! Positions that are held over several rows: an encoder that is read less often than the log is written.

use crate::recording::Recording;
use crate::recording::columns::Columns;

/// Longest number of rows from a change to the next that is counted.
const LONGEST: usize = 64;

/// Fewest changes that tell.
const FEWEST: usize = 50;

/// Least part of the changes that are a multiple of the number of rows after the one before. Missing rows shift them.
const SHARE: f64 = 0.98;

/// Least part of the changes that come as soon as they can: the shaft is fast.
const AT_ONCE: f64 = 0.5;

/// End of the note, which a rate of --resample makes needless.
const REMEDY: &str = "to read it at the rows with new positions";

/// Numbers of rows from each change of a column to the next.
#[derive(Clone, Debug)]
pub(crate) struct Held {
    gaps: [u64; LONGEST + 1],
    since: usize,
}

impl Default for Held {
    fn default() -> Self {
        Self {
            gaps: [0; LONGEST + 1],
            since: 0,
        }
    }
}

impl Held {
    /// Adds whether a row differs from the one before.
    pub(crate) fn add(&mut self, changes: bool) {
        self.since += 1;
        if changes {
            if let Some(gap) = self.gaps.get_mut(self.since) {
                *gap += 1;
            }
            self.since = 0;
        }
    }

    /// Number of rows in which the position is held, 2 or more; `None` if it may be new in each row.
    pub(crate) fn rows(&self) -> Option<usize> {
        let sum = |is: &dyn Fn(usize) -> bool| -> u64 {
            let gaps = self.gaps.iter().enumerate();
            gaps.filter(|(rows, _)| is(*rows))
                .map(|(_, number)| number)
                .sum()
        };
        let all = sum(&|_| true) as f64;
        let fits = |rows: &usize| {
            let multiples = sum(&|gap| gap % rows == 0) as f64;
            multiples >= SHARE * all && self.gaps[*rows] as f64 >= AT_ONCE * all
        };
        (2..=LONGEST)
            .rev()
            .find(fits)
            .filter(|_| all >= FEWEST as f64)
    }
}

/// The note on a `column` whose position is held over a number of rows at `rate_hz`.
pub(crate) fn note(column: &str, rows: usize, rate_hz: f64) -> String {
    let hz = (rate_hz / rows as f64).round();
    format!(
        "{column} changes only in every {} row: the position is held between them, which the estimators take for rest; \
         add --resample {hz} {REMEDY}",
        ordinal(rows)
    )
}

/// A number as 2nd, 3rd, 10th.
fn ordinal(number: usize) -> String {
    let end = match (number % 10, number % 100) {
        (_, 11..=13) => "th",
        (1, _) => "st",
        (2, _) => "nd",
        (3, _) => "rd",
        _ => "th",
    };
    format!("{number}{end}")
}

impl Columns<'_> {
    /// Notes on the positions that are held over several rows at `rate_hz`.
    pub(crate) fn held(&self, rate_hz: f64) -> impl Iterator<Item = String> {
        let encoders = [&self.counts_large, &self.counts_small];
        (0..)
            .zip(encoders)
            .filter_map(move |(motor, encoder)| encoder.held(motor, rate_hz))
    }
}

impl Recording {
    /// Removes the notes on positions that are held: the rows have another rate.
    pub(crate) fn remove_held_notes(&mut self) {
        self.notes.retain(|note| !note.ends_with(REMEDY));
    }
}

#[cfg(test)]
mod tests {
    use super::Held;
    use crate::recording::Recording;

    /// 3 s of 1 kHz whose row k has the count of the motion `count` that `latest` gives.
    fn read(count: impl Fn(f64) -> f64, latest: impl Fn(u32) -> u32) -> Recording {
        let row = |k: u32| format!("{}e-3,{}\n", k, count(f64::from(latest(k)) * 1e-3).floor());
        let text: String = (0..3000).map(row).collect();
        Recording::parse(format!("t,counts_large\n{text}").as_bytes(), "r.csv").unwrap()
    }

    #[test]
    fn fifty_changes_tell_that_a_position_is_held() {
        let mut held = Held::default();
        (0..99).for_each(|k| held.add(k % 2 == 1));
        assert_eq!(held.rows(), None);
        held.add(true);
        assert_eq!(held.rows(), Some(2));
    }

    fn swing(t: f64) -> f64 {
        900.0 * (4.0 * t).sin()
    }

    #[test]
    fn position_that_is_held_over_rows_is_reported() {
        for (rows, said, hz) in [
            (2, "2nd", 500),
            (3, "3rd", 333),
            (10, "10th", 100),
            (12, "12th", 83),
        ] {
            let mut recording = read(swing, |k| k / rows * rows);
            let said = format!(
                "counts_large changes only in every {said} row: the position is held between them, which the estimators \
                 take for rest; add --resample {hz} to read it at the rows with new positions"
            );
            assert_eq!(recording.notes, [said]);
            recording.resample(f64::from(hz), "r.csv").unwrap();
            assert!(recording.notes.is_empty());
            // Two lost rows shift those behind them.
            let lost = |k: u32| if k < 1500 { k } else { k + 2 };
            let recording = read(swing, |k| lost(k) / rows * rows);
            assert_eq!(recording.notes.len(), 1, "{rows}");
        }
    }

    #[test]
    fn slow_shafts_are_not_reported() {
        // A swing, some speeds of less than a count a row, and rest with noise.
        for speed in [0.02, 0.3, 0.7, 1.0, 250.0, 333.0] {
            let recording = read(|t| speed * swing(t), |k| k);
            assert!(recording.notes.is_empty(), "{speed}: {:?}", recording.notes);
        }
        for speed in [90.0, 170.0, 400.0, 700.0, 999.0] {
            let recording = read(|t| speed * t, |k| k);
            assert!(recording.notes.is_empty(), "{speed}: {:?}", recording.notes);
        }
        let recording = read(|t| (t * 1e3 % 7.0 / 5.0).floor() + 5.0, |k| k);
        assert!(recording.notes.is_empty(), "{:?}", recording.notes);
    }
}
