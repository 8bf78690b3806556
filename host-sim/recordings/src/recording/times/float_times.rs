//! Times that were numbers of 32 bits, which are far apart after a long time.

use device_files::to_digits;

use super::mean_rate;
use super::steps::EVEN;
use crate::recording::numbers::shown;

/// Largest distance of a time from a number of 32 bits, in distances of these: what the digits of a log round.
const OFF: f64 = 5e-3;

/// Fewest rows that tell.
const FEWEST: u64 = 100;

/// Least distance of two numbers of 32 bits, in periods of the rows: they make the steps of `t` uneven.
const COARSE: f64 = 0.15;

/// Distances of two numbers by which a step of rounded times may be longer than the period.
const ROUNDED: f64 = 1.5;

/// The times of a log that have been numbers of 32 bits so far.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct FloatTimes {
    is_other: bool,
    /// Whether a time has a fraction: whole numbers are those of a counter.
    has_fraction: bool,
    rows: u64,
    first_s: f64,
    last_s: f64,
    /// Longest step, s.
    longest_s: f64,
    /// Distance of the largest time to the next one, s.
    apart_s: f64,
}

impl FloatTimes {
    /// Adds a time `t_s`, s, of a log that writes `per_s` of its units for a second.
    pub(crate) fn add(&mut self, t_s: f64, per_s: f64) {
        if self.is_other {
            return;
        }
        let number = t_s * per_s;
        let float = number as f32;
        let apart = f64::from(float.abs().next_up() - float.abs());
        self.is_other = (number - f64::from(float)).abs() > OFF * apart;
        self.has_fraction |= number.fract() != 0.0;
        match self.rows {
            0 => self.first_s = t_s,
            _ => self.longest_s = self.longest_s.max(t_s - self.last_s),
        }
        self.last_s = t_s;
        self.rows += 1;
        self.apart_s = self.apart_s.max(apart / per_s);
    }

    /// Note with the mean rate of the rows; `None` if the times are others, or numbers of 32 bits are near enough.
    pub(crate) fn note(&self) -> Option<String> {
        let duration_s = self.last_s - self.first_s;
        let hz = mean_rate(self.rows.saturating_sub(1), duration_s)?;
        // Over missing rows steps are longer.
        let steps = 1.0 + EVEN..1.0 + ROUNDED * self.apart_s * hz;
        let is_uneven = self.apart_s * hz > COARSE && steps.contains(&(self.longest_s * hz));
        (self.rows >= FEWEST && is_uneven && self.has_fraction && !self.is_other).then(|| {
            format!(
                "t has the digits of a 32-bit float, which are {} us apart: if the rows are even, give --row-rate {hz}, or \
                 log t as a 64-bit float",
                shown(to_digits(1e6 * self.apart_s, 3))
            )
        })
    }
}

#[cfg(test)]
mod tests {
    use crate::recording::{read_log as read, read_log_at as read_at};

    /// Rows of 1 kHz whose times are written by `time`.
    fn log(time: impl Fn(f64) -> String) -> String {
        let row = |k: u32| format!("{},{k}\n", time(f64::from(k) * 1e-3));
        let rows: String = (0..2000).map(row).collect();
        format!("t,counts_large\n{rows}")
    }

    #[test]
    fn times_of_32_bits_are_reported_where_they_are_coarse() {
        let float = |begin: f64| log(|t| format!("{:.6}", (begin + t) as f32));
        let said = "t has the digits of a 32-bit float, which are 488 us apart: if the rows are even, give --row-rate \
                    1000, or log t as a 64-bit float";
        assert_eq!(read(&float(5000.0), "").unwrap().notes, [said]);
        // Of few rows the mean rate is not known. A line more is that of the header.
        for (rows, is_said) in [(99, false), (100, true)] {
            let text: Vec<_> = float(5000.0)
                .lines()
                .take(rows + 1)
                .map(str::to_owned)
                .collect();
            let notes = read(&(text.join("\n") + "\n"), "").unwrap().notes;
            assert_eq!(
                notes.iter().any(|note| note.contains("32-bit")),
                is_said,
                "{rows}"
            );
        }
        let rated = read_at(Some(1000.0), &float(5000.0), "").unwrap();
        assert!(
            !rated.notes.iter().any(|note| note.contains("32-bit")),
            "{:?}",
            rated.notes
        );
        for other in [
            float(50.0),
            log(|t| format!("{:.6}", 5000.0 + t)),
            log(|t| format!("{:.3}", 5000.0 + t)),
        ] {
            assert!(read(&other, "").unwrap().notes.is_empty());
        }
        // Counters of milliseconds that miss some, and of half ones.
        for other in [
            log(|t| format!("{}", 5e6 + (1.3e3 * t).round())),
            log(|t| format!("{:.1}", 5e6 + 500.0 * t)),
        ] {
            let notes = read(&other, "t=t:ms").unwrap().notes;
            assert!(
                !notes.iter().any(|note| note.contains("32-bit")),
                "{notes:?}"
            );
        }
    }
}
