//! Rate of a recording's rows, its uneven steps, and gaps in which rows are missing.

use device_files::to_digits;

use super::steps::{EVEN, Steps, differs};
use crate::recording::Recording;
use crate::recording::numbers::shown;
use simulation::simulate::RATES_HZ;
use terminal::failure::Failure;

/// Time of each row from the row before, in periods of `rate_hz`, if the rows of `t` are uneven. That of
/// the first row is 1.
pub(crate) fn periods(t: &[f64], rate_hz: f64) -> Option<Vec<f32>> {
    let first = t.first().map(|_| 1.0);
    let later = t
        .windows(2)
        .map(|pair| ((pair[1] - pair[0]) * rate_hz) as f32);
    let are_uneven = Steps::of(t).are_uneven(1.0 / rate_hz);
    are_uneven.then(|| first.into_iter().chain(later).collect())
}

/// Description of those `steps` that differ from `period`, s; `None` if there are none. Steps of one
/// class count by their mean.
pub(crate) fn unevenness(steps: &Steps, period: f64) -> Option<String> {
    let mut uneven = Uneven::new(period);
    for (length, number) in steps.lengths() {
        uneven.add_equal(length, number as usize);
    }
    uneven.note()
}

/// Rate of the rows of `t`, Hz, and the number of uneven steps.
pub(crate) fn rate(t: &[f64], name: &str) -> Result<(f64, usize), Failure> {
    let (period, rate_hz) = Steps::of(t).period(name)?;
    let mut uneven = Uneven::new(period);
    for pair in t.windows(2) {
        uneven.add(pair[1] - pair[0]);
    }
    Ok((rate_hz, uneven.number))
}

/// Steps that differ from a period by more than a tenth of it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Uneven {
    period: f64,
    number: usize,
    all: usize,
    most: f64,
}

impl Uneven {
    pub(crate) fn new(period: f64) -> Self {
        Self {
            period,
            number: 0,
            all: 0,
            most: 0.0,
        }
    }

    pub(crate) fn add(&mut self, step: f64) {
        self.add_equal(step, 1);
    }

    /// Adds `number` steps of one length.
    fn add_equal(&mut self, step: f64, number: usize) {
        self.all += number;
        if differs(step, self.period) > EVEN {
            self.number += number;
            self.most = self.most.max((step - self.period).abs());
        }
    }

    /// Description; `None` if all steps are even.
    pub(crate) fn note(&self) -> Option<String> {
        (self.number > 0).then(|| {
            let (number, all) = (self.number, self.all);
            format!(
                "t is uneven in {:.2} % of steps ({number} of {all}), by up to {} us",
                100.0 * number as f64 / all as f64,
                to_digits(1e6 * self.most, 4)
            )
        })
    }
}

/// Rows a second above which a unit of the time is more likely wrong: those of the fastest control loop.
pub(crate) const FASTEST_HZ: f64 = RATES_HZ.1;

/// What to check where the rows of a log come at `rate_hz`; `None` if the rate is one of a control loop.
pub(crate) fn fast(rate_hz: f64) -> Option<String> {
    (rate_hz > FASTEST_HZ).then(|| {
        format!(
            "{rate_hz} rows a second are more than {FASTEST_HZ}: check the unit of t, which --column t=NAME:ms states"
        )
    })
}

/// Longest gap over which a motion is followed, periods. One row less is missing in it.
pub const LONGEST_GAP: f64 = 200.0;

/// Gaps of `t` in which rows are missing.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Gaps {
    /// Line and time after the first gap.
    first: Option<(u64, f64)>,
    number: u64,
    rows: f64,
    most: f64,
    /// Time after the gap in which the most rows are missing.
    end: f64,
    /// Time that all steps have more than a period each, in periods.
    excess: f64,
}

impl Gaps {
    /// Adds a step that ends at `t` in a line of the file.
    pub(crate) fn add(&mut self, step: f64, rate_hz: f64, t: f64, line: impl FnOnce() -> u64) {
        self.excess += step * rate_hz - 1.0;
        let missing = (step * rate_hz).round() - 1.0;
        if missing >= 1.0 {
            self.first = self.first.or_else(|| Some((line(), t)));
            self.number += 1;
            self.rows += missing;
            if missing > self.most {
                (self.most, self.end) = (missing, t);
            }
        }
    }

    /// Description; `None` if there is no gap, or if the short steps after late rows make up for all of
    /// them.
    pub(crate) fn note(&self) -> Option<String> {
        let (line, t) = self.first?;
        let t = shown(t);
        let Self {
            number, rows, most, ..
        } = self;
        let are_late = *most == 1.0 && self.excess < rows / 2.0;
        let remedy = match *most >= LONGEST_GAP {
            true => format!(
                "; cut the log before t = {} s: resampled rows in this gap are a straight line",
                shown(self.end)
            ),
            false => String::new(),
        };
        let are = if *rows == 1.0 { "row is" } else { "rows are" };
        let gaps = match number {
            1 => "a gap".to_owned(),
            _ => format!("{number} gaps of at most {most}, the first"),
        };
        (!are_late)
            .then(|| format!("{rows} {are} missing in {gaps} before line {line} at {t} s{remedy}"))
    }
}

impl Recording {
    /// Description of the uneven steps of `t`; `None` if there are none.
    #[must_use]
    pub fn unevenness(&self) -> Option<String> {
        let mut uneven = Uneven::new(self.trace.period_s());
        for pair in self.t.windows(2) {
            uneven.add(pair[1] - pair[0]);
        }
        // The number is that about the period before its digits were rounded.
        uneven.number = self.uneven_steps;
        uneven.note()
    }

    /// Checks that the times of the rows are known.
    ///
    /// # Errors
    /// [`Failure::Input`] with the remedy if more than a tenth of the steps of `t` differ from the
    /// period by more than half of it, and `t` has so few digits that late rows look as missing ones; or if
    /// the rows come in bursts.
    pub fn check_times(&self, name: &str) -> Result<(), Failure> {
        let steps = Steps::of(&self.t);
        steps.check_bursts(self.repeated_rows, name)?;
        steps.check_times(self.trace.rate_hz, name)
    }

    /// Share of uneven steps of `t`, 0 to 1.
    #[must_use]
    pub fn uneven_share(&self) -> f64 {
        self.uneven_steps as f64 / (self.t.len() - 1) as f64
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn stamps(show: impl Fn(f64) -> String) -> Vec<f64> {
        let rows = (0..20_000).map(|k| f64::from(k) / 11_600.0);
        rows.map(|t| show(t).parse().unwrap()).collect()
    }

    /// `x` with six significant digits, as printf's %g and the streams of C++ write it.
    fn six_digits(x: f64) -> String {
        let exponent = if x > 0.0 { x.log10().floor() as i32 } else { 0 };
        format!("{x:.0$}", (5 - exponent) as usize)
    }

    #[test]
    fn rate_does_not_depend_on_the_digits_of_t() {
        let (exact, uneven) = rate(&stamps(|t| t.to_string()), "r").unwrap();
        assert_eq!((exact, uneven), (11_600.0, 0));
        for t in [stamps(|t| format!("{t:.6}")), stamps(six_digits)] {
            let (rate_hz, uneven) = rate(&t, "r").unwrap();
            // A stamp is off by 5 us at most, of 1.7 s.
            assert!((rate_hz / 11_600.0 - 1.0).abs() < 1e-5, "{rate_hz}");
            assert_eq!(uneven, 0);
        }
    }

    #[test]
    fn missing_rows_do_not_change_the_rate() {
        let mut t = stamps(|t| format!("{t:.6}"));
        let mut k = 0;
        t.retain(|_| {
            k += 1;
            k % 7 > 0
        });
        let (rate_hz, uneven) = rate(&t, "r").unwrap();
        assert!((rate_hz / 11_600.0 - 1.0).abs() < 1e-4, "{rate_hz}");
        assert_eq!(uneven, 20_000 / 7);
    }

    #[test]
    fn late_rows_are_not_missing_rows() {
        let note = |times: &[f64]| {
            let mut gaps = Gaps::default();
            for pair in times.windows(2) {
                gaps.add(pair[1] - pair[0], 1000.0, pair[1], || 7);
            }
            gaps.note()
        };
        let late = |k: u32| if k % 10 == 5 { 0.6e-3 } else { 0.0 };
        let times: Vec<_> = (0..100).map(|k| f64::from(k) * 1e-3 + late(k)).collect();
        assert_eq!(note(&times), None);
        let mut cut = times.clone();
        cut.drain(50..53);
        assert!(
            note(&cut)
                .unwrap()
                .contains("gaps of at most 3, the first before line 7")
        );
        let even: Vec<_> = (0..100)
            .filter(|k| k % 10 != 5)
            .map(|k| f64::from(k) * 1e-3)
            .collect();
        assert!(
            note(&even)
                .unwrap()
                .starts_with("10 rows are missing in 10 gaps of at most 1")
        );
    }

    #[test]
    fn longest_gap_is_to_be_cut_if_a_motion_is_not_followed_over_it() {
        let note = |missing: u32| {
            let mut gaps = Gaps::default();
            gaps.add(3e-3, 1000.0, 0.5, || 7);
            let step = f64::from(missing + 1) * 1e-3;
            gaps.add(step, 1000.0, 1.0 + step, || 9);
            gaps.add(3e-3, 1000.0, 2.0, || 11);
            gaps.note().unwrap()
        };
        let short =
            "203 rows are missing in 3 gaps of at most 199, the first before line 7 at 0.5 s";
        assert_eq!(note(199), short);
        let cut = "at 0.5 s; cut the log before t = 1.201 s: resampled rows in this gap are a straight line";
        assert!(note(200).ends_with(cut), "{}", note(200));
        let mut one = Gaps::default();
        one.add(2e-3, 1000.0, 0.5, || 7);
        assert_eq!(
            one.note().unwrap(),
            "1 row is missing in a gap before line 7 at 0.5 s"
        );
        let mut one = Gaps::default();
        one.add(4e-3, 1000.0, 0.6, || 9);
        let said = "3 rows are missing in a gap before line 9 at 0.6 s";
        assert_eq!(one.note().unwrap(), said);
    }

    #[test]
    fn milliseconds_are_refused_with_the_unit() {
        let t: Vec<_> = (0..10).map(f64::from).collect();
        let error = rate(&t, "r.csv").unwrap_err().to_string();
        assert!(
            error.starts_with("r.csv: column t: rows 1 s apart are 1 Hz"),
            "{error}"
        );
        assert!(error.contains("not in ms, us or ns"), "{error}");
    }

    /// `sleep(0.1)` in a loop makes somewhat less than 10 rows a second.
    #[test]
    fn rows_of_a_loop_that_sleeps_are_read() {
        let rows = |step: f64| (0..10).map(|k| f64::from(k) * step).collect::<Vec<_>>();
        let (hz, _) = rate(&rows(0.1035), "r.csv").unwrap();
        assert!((hz * 0.1035 - 1.0).abs() < 1e-6);
        let error = rate(&rows(0.21), "r.csv").unwrap_err().to_string();
        assert!(error.contains("below 5 Hz"), "{error}");
    }
}
