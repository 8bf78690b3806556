//! Period of a recording's rows, and its uneven steps.

use super::Recording;
use super::lines::LineNumbers;
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

/// Rate of the rows of `t`, Hz, and the number of uneven steps.
///
/// The rate is one over the mean of the steps near the median, because the resolution of the median
/// alone is that of the digits of `t`.
pub(super) fn rate(t: &[f64], name: &str) -> Result<(f64, usize), Failure> {
    let mut steps: Vec<_> = t.windows(2).map(|t| t[1] - t[0]).collect();
    if steps.is_empty() {
        return Err(Failure::Input(format!(
            "{name}: fewer than two rows of data; a recording needs at least two"
        )));
    }
    steps.sort_unstable_by(f64::total_cmp);
    let median = steps[steps.len() / 2];
    if median <= 0.0 {
        return Err(Failure::Input(format!(
            "{name}: column t: does not increase in most rows; write it in seconds with enough digits to \
             distinguish rows"
        )));
    }
    let regular = steps
        .iter()
        .filter(|step| differs(**step, median) <= REGULAR);
    let (sum, number) = regular.fold((0.0, 0.0), |(sum, number), step| (sum + step, number + 1.0));
    let period = sum / number;
    // Decimal digits of `t` are rounded, so the rate is rounded too.
    let rate_hz = to_digits(1.0 / period, 7);
    if rate_hz < SLOWEST_HZ {
        return Err(Failure::Input(format!(
            "{name}: column t: rows {period} s apart are {rate_hz} Hz, which is below {SLOWEST_HZ} Hz; \
             t must be in seconds, check that it is not in ms or us, which --column t=NAME:ms states"
        )));
    }
    let uneven = steps.iter().filter(|step| differs(**step, period) > EVEN);
    Ok((rate_hz, uneven.count()))
}

/// Description of the gaps of `t` in which rows are missing; `None` if there is none.
pub(super) fn missing_rows(t: &[f64], rate_hz: f64, lines: &LineNumbers) -> Option<String> {
    let missing = |step: f64| (step * rate_hz).round() - 1.0;
    let steps = t.windows(2).map(|t| missing(t[1] - t[0])).enumerate();
    let gaps = steps.filter(|(_, missing)| *missing >= 1.0);
    let mut first = None;
    let (mut number, mut rows, mut most) = (0, 0.0, 0.0_f64);
    for (k, missing) in gaps {
        first = first.or(Some(k + 1));
        number += 1;
        rows += missing;
        most = most.max(missing);
    }
    let first = first?;
    Some(format!(
        "{rows} rows are missing in {number} gaps of at most {most}, the first before line {} at {} s",
        lines.of(first),
        t[first]
    ))
}

impl Recording {
    /// Description of the uneven steps of `t`; `None` if there are none.
    #[must_use]
    pub fn unevenness(&self) -> Option<String> {
        let period = self.trace.period_s();
        let steps = self.t.windows(2).map(|t| t[1] - t[0]);
        let uneven = steps.filter(|step| differs(*step, period) > EVEN);
        let most = uneven.fold(0.0_f64, |most, step| most.max((step - period).abs()));
        (self.uneven_steps > 0).then(|| {
            let all = self.t.len() - 1;
            format!(
                "t is uneven in {:.2} % of steps ({} of {all}), by up to {} us",
                100.0 * self.uneven_share(),
                self.uneven_steps,
                to_digits(1e6 * most, 4)
            )
        })
    }

    /// Checks that the estimators can take the rows as evenly spaced.
    ///
    /// # Errors
    /// [`Failure::Input`] with the remedy if more than a tenth of the steps of `t` differ from the
    /// period by more than half of it.
    pub fn check_even(&self, name: &str) -> Result<(), Failure> {
        let period = self.trace.period_s();
        let steps = self.t.windows(2).map(|t| t[1] - t[0]);
        let irregular = steps
            .filter(|step| differs(*step, period) > REGULAR)
            .count();
        let share = irregular as f64 / (self.t.len() - 1) as f64;
        if share <= IRREGULAR_SHARE {
            return Ok(());
        }
        let rate_hz = self.trace.rate_hz;
        Err(Failure::Input(format!(
            "{name}: column t: {:.0} % of the steps differ by more than half from the period of 1/{rate_hz} \
             s, {:.0} % may; the estimators assume a constant period: add --resample {:.0}",
            100.0 * share,
            100.0 * IRREGULAR_SHARE,
            rate_hz
        )))
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
