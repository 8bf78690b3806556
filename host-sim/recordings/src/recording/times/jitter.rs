//! Times that jitter where the rows do not: a computer that stamps the rows of an even measurement.

use super::mean_rate;
use super::steps::FEW;
use crate::recording::columns::Columns;

/// Least part of the rows that tell which fit even times better than the log's own.
const SHARE: f64 = 0.75;

/// Least excess of these rows over the others, in standard deviations of their number where nothing is told: 25 rows
/// that all fit even times, or three of four of 100.
const SURE: f64 = 5.0;

/// Least difference of the two lines through the rows beside, counts: quantisation is less.
const COUNTS: f64 = 1.0;

/// Numbers of rows whose count is nearer to the middle of those beside it, or to the line through them at the log's
/// times.
#[derive(Clone, Debug, Default)]
pub(crate) struct Jitter {
    /// Time, s, and count of the last two rows.
    last: [Option<(f64, u32)>; 2],
    even: u64,
    timed: u64,
    /// Number, sum and largest of the steps, s.
    steps: u64,
    duration: f64,
    longest: f64,
}

impl Jitter {
    /// Adds a row.
    pub(crate) fn add(&mut self, t: f64, count: u32) {
        let [first, middle] = self.last;
        self.last = [middle, Some((t, count))];
        let Some((t_middle, middle)) = middle else {
            return;
        };
        self.steps += 1;
        self.duration += t - t_middle;
        self.longest = self.longest.max(t - t_middle);
        let Some((t_first, first)) = first else {
            return;
        };
        let since_first = |count: u32| f64::from(count.wrapping_sub(first) as i32);
        let moved = since_first(count);
        let even = 0.5 * moved;
        let timed = moved * (t_middle - t_first) / (t - t_first);
        if (even - timed).abs() < COUNTS {
            return;
        }
        let off = |line: f64| (since_first(middle) - line).abs();
        match off(even) < off(timed) {
            true => self.even += 1,
            false => self.timed += 1,
        }
    }

    /// The note on rows that are mostly a period of 1/`rate_hz` apart, if their counts fit even times better. Rows that
    /// were measured evenly came at their mean rate, unless a gap is among them.
    fn note(&self, rate_hz: f64) -> Option<String> {
        let told = (self.even + self.timed) as f64;
        let share = self.even as f64 / told;
        let is_told = share >= SHARE && (2.0 * share - 1.0) * told.sqrt() >= SURE;
        let (part, rate) = match self.longest <= FEW / rate_hz {
            true => ("", mean_rate(self.steps, self.duration)?),
            false => (
                ", for the log up to its first gap alone",
                mean_rate(1, 1.0 / rate_hz)?,
            ),
        };
        is_told.then(|| {
            format!(
                "t jitters: in {:.0} % of the rows whose step tells, the count fits even steps better than those of t; if \
                 the rows were measured at an even rate, give it with --row-rate {rate}{part}",
                100.0 * share
            )
        })
    }
}

impl Columns<'_> {
    /// The note on times that jitter where the rows do not, which come at a mean rate of `rate_hz`.
    pub(crate) fn jitter(&self, rate_hz: f64) -> Option<String> {
        self.jitter.note(rate_hz)
    }
}

#[cfg(test)]
mod tests {
    use crate::recording::Recording;

    /// The notes on 2 s of a swing at 1 kHz: row k is measured at `measured` and stamped at `stamped` milliseconds.
    fn notes(
        measured: impl Fn(u32) -> f64,
        stamped: impl Fn(u32) -> f64,
        amplitude: f64,
    ) -> String {
        let row = |k: u32| {
            let count = (amplitude * (4e-3 * measured(k)).sin()).floor();
            format!("{:.6},{count}\n", 1e-3 * stamped(k))
        };
        let text: String = (0..2000).map(row).collect();
        let text = format!("t,counts_large\n{text}");
        let recording = Recording::parse(text.as_bytes(), "r.csv").unwrap();
        recording.notes.join("\n")
    }

    /// A delay of up to 0.4 ms, of no order.
    fn late(k: u32) -> f64 {
        f64::from(k) + 0.4 * f64::from(k * 7919 % 101) / 101.0
    }

    #[test]
    fn stamps_that_are_late_beside_an_even_measurement_are_named() {
        let said = notes(f64::from, late, 3000.0);
        assert!(said.contains("t jitters: in 100 % of the rows"), "{said}");
        assert!(said.contains("--row-rate 1000"), "{said}");
    }

    /// A row of 100 is stamped 0.9 ms late.
    #[test]
    fn single_late_stamps_are_named() {
        let late = |k: u32| f64::from(k) + if k % 100 == 7 { 0.9 } else { 0.0 };
        let said = notes(f64::from, late, 3000.0);
        assert!(said.contains("t jitters: in 100 % of the rows"), "{said}");
        // The rows themselves were late.
        let said = notes(late, late, 3000.0);
        assert!(!said.contains("jitters"), "{said}");
    }

    /// Rows 1.04 ms apart whose stamps are whole milliseconds, 1999 steps in 2078 ms; and rows with a pause of 100 ms.
    #[test]
    fn offered_rate_is_the_mean_one_without_a_gap() {
        let slow = |k: u32| 1.04 * f64::from(k);
        let said = notes(slow, |k| slow(k).floor(), 3000.0);
        assert!(said.contains("give it with --row-rate 962"), "{said}");
        let paused = |t: f64| if t > 1000.0 { t + 100.0 } else { t };
        let said = notes(|k| paused(f64::from(k)), |k| paused(late(k)), 3000.0);
        let offered = "give it with --row-rate 1000, for the log up to its first gap alone";
        assert!(said.contains(offered), "{said}");
    }

    #[test]
    fn times_of_the_measurement_itself_are_not_named() {
        for said in [
            notes(late, late, 3000.0),
            notes(f64::from, f64::from, 3000.0),
            // The shaft moves by less than a count in the time by which stamps are late.
            notes(f64::from, late, 300.0),
        ] {
            assert!(!said.contains("jitters"), "{said}");
        }
    }

    #[test]
    fn missing_rows_are_no_jitter() {
        let missing = |k: u32| f64::from(k + k / 3);
        let said = notes(missing, missing, 3000.0);
        assert!(!said.contains("jitters"), "{said}");
    }
}
