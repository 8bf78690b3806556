//! Times of the rows while they are read.

pub(super) mod bursts;
pub(super) mod clock;
pub(super) mod float_times;
pub(super) mod jitter;
pub(super) mod moment;
pub(super) mod own_times;
pub(super) mod resample;
pub(super) mod steps;

use device_files::to_digits;
use terminal::failure::Failure;

use super::numbers::shown;
use super::text::row::Row;
use steps::SLOWEST_HZ;

/// Largest difference of the mean rate of the rows from that of --row-rate, relative.
const SAME_RATE: f64 = 0.05;

/// Longest run of a log, s: beyond it a time is wrong.
const LONGEST_RUN_S: f64 = 1e8;

/// Part of a distance from which the time at a wrap or at a new run may differ.
pub(super) const NEAR: f64 = 0.01;

/// Largest difference of a mean rate from a number of two digits that is taken for it, relative.
const ROUND: f64 = 2e-3;

/// Mean rate of `steps` equal steps over `duration_s`, for an option, Hz; `None` if it is none of a recording.
pub(super) fn mean_rate(steps: u64, duration_s: f64) -> Option<f64> {
    let hz = steps as f64 / duration_s;
    let round = to_digits(hz, 2);
    let hz = match (hz / round - 1.0).abs() < ROUND {
        true => round,
        false => to_digits(hz, 4),
    };
    (hz.is_finite() && hz >= SLOWEST_HZ).then_some(hz)
}

/// Largest distance, in mean steps, by which a time goes back where two rows have changed places.
const SWAPPED: f64 = 1.5;

/// Error for a row at `t` below one at `last`, s. `first` is the first time of the log, of which `taken` rows are
/// above.
pub(super) fn back(row: &Row, t: f64, [first, last]: [f64; 2], taken: usize) -> Failure {
    let back = last - t;
    let steps = back * taken.saturating_sub(1) as f64 / (last - first);
    let remedy = if (t - first).abs() <= NEAR * (last - first) && back < LONGEST_RUN_S {
        "a second run begins: cut the log there"
    } else if lacks_zeros(last, t) {
        "if fractions of a second lack their leading zeros, as .9 before .10, write them with all digits; else sort the \
         rows by time"
    } else if steps > SWAPPED {
        "if the clock was set back, cut the log there, because sorted rows would mix two motions; else sort the rows by \
         time, or remove the row"
    } else {
        "sort the rows by time, or remove the row; where the column is no time, --row-rate HZ is the rate of the rows in \
         its place"
    };
    let [t, last] = [t, last].map(shown);
    row.failure(
        "t",
        &format!("{t} s is before the {last} s above it; {remedy}"),
    )
}

/// Whether fractions of a second whose leading zeros are missing explain the time `t` after `last`: after 0.9 and 0.99
/// come 0.10 and 0.100 within one second.
fn lacks_zeros(last: f64, t: f64) -> bool {
    let [before, now] = [last, t].map(|t| t - t.floor());
    t.floor() == last.floor() && before >= 0.5 && (0.1 - 1e-6..0.2).contains(&now)
}

/// Largest share of the rows that may have the time of the row before.
const REPEATED_SHARE: f64 = 0.1;

/// Rows that have the time of the row before, and are left out: a velocity over no time is none.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Repeated {
    /// Line and time of the first one.
    first: Option<(u64, f64)>,
    rows: usize,
}

impl Repeated {
    /// Adds a row at `t`, s.
    pub(super) fn add(&mut self, line: u64, t: f64) {
        self.first.get_or_insert((line, t));
        self.rows += 1;
    }

    /// Number of the rows.
    pub(super) fn rows(&self) -> usize {
        self.rows
    }

    /// Note on the rows of the recording `name` that are left out beside `taken` ones, which span `duration_s`, s;
    /// `None` if there are none.
    ///
    /// # Errors
    /// [`Failure::Input`] with the mean rate of all rows if they are more than a tenth of them.
    pub(super) fn check(
        &self,
        name: &str,
        taken: usize,
        duration_s: f64,
    ) -> Result<Option<String>, Failure> {
        let Some((line, t)) = self.first else {
            return Ok(None);
        };
        let (rows, t) = (self.rows, shown(t));
        let share = rows as f64 / (rows + taken) as f64;
        if share > REPEATED_SHARE {
            let mean_hz = mean_rate((rows + taken) as u64 - 1, duration_s);
            let hz = mean_hz.map_or("HZ".to_owned(), |hz| hz.to_string());
            return Err(Failure::Input(format!(
                "{name}: column t: {:.0} % of the rows have the time of the row before, the first in line \
                 {line} at {t} s; log t with more digits, or give the rate of the rows with --row-rate {hz}",
                100.0 * share
            )));
        }
        let (are, have) = if rows == 1 {
            ("row is", "has")
        } else {
            ("rows are", "have")
        };
        Ok(Some(format!(
            "{rows} {are} left out that {have} the time of the row before, the first in line {line} at {t} s"
        )))
    }
}

/// The log's own times, which --row-rate replaces.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Replaced {
    first: Option<f64>,
    last: f64,
    rows: u64,
}

impl Replaced {
    /// Adds a time of the log, s.
    pub(super) fn add(&mut self, t: f64) {
        self.first.get_or_insert(t);
        self.last = t;
        self.rows += 1;
    }

    /// Note on the column `theirs` that is not used; `None` if there are no times in it.
    ///
    /// # Errors
    /// [`Failure::Input`] if the rows of the recording `name` come at another rate than `rate_hz`.
    pub(super) fn check(
        &self,
        name: &str,
        theirs: &str,
        rate_hz: f64,
    ) -> Result<Option<String>, Failure> {
        let duration_s = self.last - self.first.unwrap_or(self.last);
        if self.rows < 2 || duration_s <= 0.0 {
            return Ok(None);
        }
        let own_hz = (self.rows - 1) as f64 / duration_s;
        if (own_hz / rate_hz - 1.0).abs() > SAME_RATE {
            return Err(Failure::Input(format!(
                "{name}: --row-rate {rate_hz}: column '{theirs}' has {hz} rows a second; give \
                 --row-rate {hz} if they came at an even rate, leave the option out, or rename the column if it is no time",
                hz = shown(to_digits(own_hz, 6))
            )));
        }
        Ok(Some(format!(
            "rows are 1/{rate_hz} s apart, as --row-rate states; the times of column '{theirs}' are not used"
        )))
    }
}

#[cfg(test)]
mod tests {
    use crate::recording::{ReadOptions, Recording};

    fn read(text: &str, columns: &str, row_rate_hz: Option<f64>) -> Result<Recording, String> {
        let mut options = ReadOptions::default();
        if !columns.is_empty() {
            options.add_columns(columns).unwrap();
        }
        if let Some(hz) = row_rate_hz {
            options.set_row_rate(hz).unwrap();
        }
        Recording::parse_as(text.as_bytes(), "r.csv", &options).map_err(|error| error.to_string())
    }

    #[test]
    fn time_that_goes_back_is_reported_with_the_reason() {
        for (unit, times, said) in [
            (
                "ms",
                &[5_u64, 6, 7, 8, 5][..],
                "a second run begins: cut the log there",
            ),
            // 8 ms, 9 ms and 10 ms.
            (
                "s",
                &[700, 800, 900, 100],
                "if fractions of a second lack their leading zeros, as .9 before .10, write them with all digits",
            ),
            // A row at another place, and a clock that was set.
            ("s", &[700, 800, 900, 300], "else sort the rows by time"),
            (
                "ms",
                &[5, 6, 7, 8, 9, 10, 11, 8],
                "0.008 s is before the 0.011 s above it; if the clock was set back, cut the log there",
            ),
            // A clock that is set from 1970 to 2023, and back.
            (
                "ms",
                &[0, 1, 1_700_000_000_000, 2],
                "if the clock was set back, cut the log there",
            ),
            (
                "ms",
                &[5, 6, 8, 7],
                "s above it; sort the rows by time, or remove the row",
            ),
        ] {
            let time = |t: &u64| match unit {
                "s" => format!("7.{t}"),
                _ => t.to_string(),
            };
            let rows: String = times.iter().map(|t| format!("{},0\n", time(t))).collect();
            let error = read(
                &format!("t,counts_large\n{rows}"),
                &format!("t=t:{unit}"),
                None,
            );
            let error = error.unwrap_err();
            let line = format!("r.csv: line {}: column t: ", times.len() + 1);
            assert!(error.starts_with(&line) && error.contains(said), "{error}");
        }
    }

    /// Times of 1 kHz, of which every `nth` row has that of the row before.
    fn repeated(nth: usize, first: usize) -> String {
        let mut text = String::from("t,counts_large\n");
        for k in 0..100 {
            let late = usize::from(k >= first && (k - first).is_multiple_of(nth));
            text += &format!("{},{}\n", 20.0 + 1e-3 * (k - late) as f64, 2 * k);
        }
        text
    }

    #[test]
    fn rows_at_the_time_of_the_row_before_are_left_out() {
        let recording = read(&repeated(100, 50), "", None).unwrap();
        assert!(recording.t.windows(2).all(|pair| pair[1] > pair[0]));
        // The counts are those of the first row at a time, so the velocity is right on both sides.
        assert_eq!(recording.t.len(), 99);
        assert_eq!(recording.trace.counts_large[48..52], [96, 98, 102, 104]);
        assert_eq!(recording.trace.periods.unwrap()[50], 2.0);
        let note = "1 row is left out that has the time of the row before, the first in line 52 at 20.049 s";
        assert_eq!(recording.notes[0], note);
        let several = read(&repeated(20, 10), "", None).unwrap();
        assert!(several.notes[0].starts_with("5 rows are left out that have the time"));
        let rated = read(&repeated(100, 50), "", Some(1000.0)).unwrap();
        assert_eq!(rated.t.len(), 100);
    }

    #[test]
    fn log_with_few_digits_of_time_is_refused() {
        let error = read(&repeated(2, 10), "", None).unwrap_err();
        let said = "r.csv: column t: 45 % of the rows have the time of the row before, the first in line \
                    12 at 20.009 s; log t with more digits, or give the rate of the rows with --row-rate 1000";
        assert_eq!(error, said);
    }

    #[test]
    fn rate_of_the_rows_that_differs_from_their_times_is_refused() {
        let mut text = String::from("t,counts_large,edge_tick,edge_bound\n");
        for k in 0..50 {
            // Times that are up to 0.4 ms late, and an edge 0.2 ms before each.
            let t = f64::from(k) * 1e-3 + 0.1e-3 * f64::from(k % 5);
            text += &format!("{t},{k},{},{k}\n", 84e6 * (t - 0.2e-3));
        }
        for hz in [500.0, 2000.0] {
            let error = read(&text, "", Some(hz)).unwrap_err();
            let said = format!("r.csv: --row-rate {hz}: column 't' has 99");
            assert!(
                error.starts_with(&said) && error.contains("leave the option out"),
                "{error}"
            );
        }
        let recording = read(&text, "", Some(1000.0)).unwrap();
        assert_eq!(recording.t[49], 0.049);
        let said =
            "rows are 1/1000 s apart, as --row-rate states; the times of column 't' are not used";
        assert_eq!(recording.notes, [said]);
        // The age of an edge follows from the log's own times.
        let ages = recording.trace.edges.unwrap();
        assert!(
            ages.iter()
                .all(|edge| (edge.unwrap().age_s - 0.2e-3).abs() < 1e-9)
        );
        // The options that two messages ask for, one after the other.
        let named = read(&text, "t=t:s", Some(1000.0)).unwrap();
        assert_eq!(named.t, recording.t);
        assert!(named.notes.contains(&said.to_owned()), "{:?}", named.notes);
    }
}
