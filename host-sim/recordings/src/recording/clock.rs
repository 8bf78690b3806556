//! Period of a recording's rows, and its uneven steps.

use std::collections::BTreeMap;

use super::Recording;
use terminal::failure::Failure;

/// Largest relative difference of an even step from the period.
const EVEN: f64 = 0.1;

/// Largest relative difference from the median step of the steps that determine the rate. Steps with
/// rounded digits are included, steps over a missing row are not.
const REGULAR: f64 = 0.5;

/// Largest share of the steps that differ from the period by more than [`REGULAR`] of it, for the
/// estimators, which assume a constant period.
const IRREGULAR_SHARE: f64 = 0.1;

/// Slowest rate of a recording, Hz.
pub(super) const SLOWEST_HZ: f64 = 10.0;

/// Steps of `t` by their length, in memory that does not grow with their number.
///
/// Steps whose lengths differ by less than 2^-12 of them share a class. Only the number and the sum
/// of the steps of a class are known, so limits apply to a class as to its mean.
#[derive(Clone, Debug, Default)]
pub(super) struct Steps {
    classes: BTreeMap<u64, Class>,
    number: u64,
}

/// Steps of nearly one length.
#[derive(Clone, Copy, Debug, Default)]
struct Class {
    number: u64,
    sum: f64,
    /// The largest change of each encoder's count over one of the steps.
    jump: [i64; 2],
}

impl Class {
    /// Mean length, s.
    fn mean(&self) -> f64 {
        self.sum / self.number as f64
    }
}

impl Steps {
    /// Bits of a length that do not distinguish classes.
    const SHARED_BITS: u32 = 52 - 12;

    /// Adds a step of `length` s, not negative, over which the counts change by `jump`.
    pub(super) fn add(&mut self, length: f64, jump: [i64; 2]) {
        // A zero has a sign.
        let key = (length + 0.0).to_bits() >> Self::SHARED_BITS;
        let class = self.classes.entry(key).or_default();
        class.number += 1;
        class.sum += length;
        for (most, jump) in class.jump.iter_mut().zip(jump) {
            if jump.abs() >= most.abs() {
                *most = jump;
            }
        }
        self.number += 1;
    }

    fn classes(&self) -> impl Iterator<Item = &Class> {
        self.classes.values()
    }

    /// The largest jump of an encoder's counts over steps of at most `longest` s.
    pub(super) fn largest_jump(&self, longest: f64, motor: usize) -> i64 {
        let short = self.classes().filter(|class| class.mean() <= longest);
        let jumps = short.map(|class| class.jump[motor]);
        jumps.max_by_key(|jump| jump.abs()).unwrap_or_default()
    }

    /// Period of the rows, s, and the rate, Hz.
    ///
    /// The rate is one over the mean of the steps near the median, because the resolution of the
    /// median alone is that of the digits of `t`.
    pub(super) fn period(&self, name: &str) -> Result<(f64, f64), Failure> {
        if self.number == 0 {
            return Err(Failure::Input(format!(
                "{name}: fewer than two rows of data; a recording needs at least two"
            )));
        }
        let mut below = 0;
        let median = self.classes().find(|class| {
            below += class.number;
            below > self.number / 2
        });
        let median = median.map_or(0.0, Class::mean);
        if median <= 0.0 {
            return Err(Failure::Input(format!(
                "{name}: column t: does not increase in most rows; write it in seconds with enough \
                 digits to distinguish rows"
            )));
        }
        let regular = self
            .classes()
            .filter(|class| differs(class.mean(), median) <= REGULAR);
        let (sum, number) = regular.fold((0.0, 0), |(sum, number), class| {
            (sum + class.sum, number + class.number)
        });
        let period = sum / number as f64;
        // Decimal digits of `t` are rounded, so the rate is rounded too.
        let rate_hz = to_digits(1.0 / period, 7);
        if rate_hz < SLOWEST_HZ {
            return Err(Failure::Input(format!(
                "{name}: column t: rows {period} s apart are {rate_hz} Hz, which is below {SLOWEST_HZ} \
                 Hz; t must be in seconds, check that it is not in ms or us, which --column t=NAME:ms \
                 states"
            )));
        }
        Ok((period, rate_hz))
    }

    /// Checks that the estimators can take rows at `rate_hz` as evenly spaced.
    ///
    /// # Errors
    /// [`Failure::Input`] with the remedy if more than a tenth of the steps differ from the period by
    /// more than half of it.
    pub(super) fn check_even(&self, rate_hz: f64, name: &str) -> Result<(), Failure> {
        let irregular = self
            .classes()
            .filter(|class| differs(class.mean(), 1.0 / rate_hz) > REGULAR);
        let irregular: u64 = irregular.map(|class| class.number).sum();
        let share = irregular as f64 / self.number as f64;
        if share <= IRREGULAR_SHARE {
            return Ok(());
        }
        Err(Failure::Input(format!(
            "{name}: column t: {:.0} % of the steps differ by more than half from the period of \
             1/{rate_hz} s, {:.0} % may; the estimators assume a constant period: add --resample {:.0}",
            100.0 * share,
            100.0 * IRREGULAR_SHARE,
            rate_hz
        )))
    }

    fn of(t: &[f64]) -> Self {
        let mut steps = Self::default();
        for pair in t.windows(2) {
            steps.add(pair[1] - pair[0], [0; 2]);
        }
        steps
    }
}

/// Rate of the rows of `t`, Hz, and the number of uneven steps.
pub(super) fn rate(t: &[f64], name: &str) -> Result<(f64, usize), Failure> {
    let (period, rate_hz) = Steps::of(t).period(name)?;
    let mut uneven = Uneven::new(period);
    for pair in t.windows(2) {
        uneven.add(pair[1] - pair[0]);
    }
    Ok((rate_hz, uneven.number))
}

/// Steps that differ from a period by more than a tenth of it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Uneven {
    period: f64,
    number: usize,
    all: usize,
    most: f64,
}

impl Uneven {
    pub(super) fn new(period: f64) -> Self {
        Self {
            period,
            number: 0,
            all: 0,
            most: 0.0,
        }
    }

    pub(super) fn add(&mut self, step: f64) {
        self.all += 1;
        if differs(step, self.period) > EVEN {
            self.number += 1;
            self.most = self.most.max((step - self.period).abs());
        }
    }

    /// Description; `None` if all steps are even.
    pub(super) fn note(&self) -> Option<String> {
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

/// Gaps of `t` in which rows are missing.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Gaps {
    /// Line and time after the first gap.
    first: Option<(u64, f64)>,
    number: u64,
    rows: f64,
    most: f64,
}

impl Gaps {
    /// Adds a step that ends at `t` in a line of the file.
    pub(super) fn add(&mut self, step: f64, rate_hz: f64, t: f64, line: impl FnOnce() -> u64) {
        let missing = (step * rate_hz).round() - 1.0;
        if missing >= 1.0 {
            self.first = self.first.or_else(|| Some((line(), t)));
            self.number += 1;
            self.rows += missing;
            self.most = self.most.max(missing);
        }
    }

    /// Description; `None` if there is no gap.
    pub(super) fn note(&self) -> Option<String> {
        let (line, t) = self.first?;
        let Self {
            number, rows, most, ..
        } = self;
        Some(format!(
            "{rows} rows are missing in {number} gaps of at most {most}, the first before line {line} at \
             {t} s"
        ))
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

    /// Checks that the estimators can take the rows as evenly spaced.
    ///
    /// # Errors
    /// [`Failure::Input`] with the remedy if more than a tenth of the steps of `t` differ from the
    /// period by more than half of it.
    pub fn check_even(&self, name: &str) -> Result<(), Failure> {
        Steps::of(&self.t).check_even(self.trace.rate_hz, name)
    }

    /// Share of uneven steps of `t`, 0 to 1.
    #[must_use]
    pub fn uneven_share(&self) -> f64 {
        self.uneven_steps as f64 / (self.t.len() - 1) as f64
    }
}

fn differs(step: f64, period: f64) -> f64 {
    (step - period).abs() / period
}

/// `x` with `digits` significant digits.
fn to_digits(x: f64, digits: usize) -> f64 {
    format!("{x:.0$e}", digits - 1).parse().unwrap_or(x)
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
    fn milliseconds_are_refused_with_the_unit() {
        let t: Vec<_> = (0..10).map(f64::from).collect();
        let error = rate(&t, "r.csv").unwrap_err().to_string();
        assert!(
            error.starts_with("r.csv: column t: rows 1 s apart are 1 Hz"),
            "{error}"
        );
        assert!(error.contains("not in ms or us"), "{error}");
    }
}
