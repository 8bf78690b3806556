//! Times that jitter where the rows do not: a computer that stamps the rows of an even measurement.

use super::mean_rate;
use crate::recording::columns::Columns;

/// Fewest rows that tell.
const FEWEST: u64 = 100;

/// Least part of these rows that fit even times better than the log's own.
const SHARE: f64 = 0.75;

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
}

impl Jitter {
    /// Adds a row.
    pub(crate) fn add(&mut self, t: f64, count: u32) {
        let [first, middle] = self.last;
        self.last = [middle, Some((t, count))];
        let (Some((t_first, first)), Some((t_middle, middle))) = (first, middle) else {
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

    /// The note on rows at a mean rate, if their counts fit even times better.
    fn note(&self, rate_hz: f64) -> Option<String> {
        let told = self.even + self.timed;
        let share = self.even as f64 / told as f64;
        let rate = mean_rate(1, 1.0 / rate_hz)?;
        (told >= FEWEST && share >= SHARE).then(|| {
            format!(
                "t jitters: in {:.0} % of the rows whose step tells, the count fits even steps better than those of t; if \
                 the rows were measured at an even rate, give it with --row-rate {rate}",
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
