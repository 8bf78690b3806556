//! Steps of a recording's times by their length, and the period that follows from them.

use std::collections::BTreeMap;

use super::mean_rate;
use device_files::presets::RATES_HZ;
use device_files::to_digits;
use terminal::failure::Failure;

use crate::recording::numbers::shown;

/// Largest relative difference of an even step from the period.
pub(crate) const EVEN: f64 = 0.1;

/// Largest relative difference from the median step of the steps that determine the rate. Steps with
/// rounded digits are included, steps over a missing row are not.
const REGULAR: f64 = 0.5;

/// Largest share of the steps that differ from the period by more than [`REGULAR`] of it, where `t` has
/// few digits.
const IRREGULAR_SHARE: f64 = 0.1;

/// Relative difference of two steps of the same length, which floats round.
const SAME: f64 = 1e-3;

/// Largest share of the steps that may differ from the period where rows are taken as even.
const RARE: f64 = 1e-3;

/// Longest step from a row to the next, and over a few missing rows, in periods.
const NEXT: f64 = 1.5;
pub(super) const FEW: f64 = 20.0;

/// Least ratio of a step to the one before for a pause behind rows that come together.
const RISE: f64 = 3.0;

/// Slowest and fastest rate of a recording, Hz.
pub const SLOWEST_HZ: f64 = *RATES_HZ.start();
pub(crate) const FASTEST_HZ: f64 = *RATES_HZ.end();

/// Steps of `t` by their length, in memory that does not grow with their number.
///
/// Steps whose lengths differ by less than 2^-12 of them share a class. Only the number and the sum
/// of the steps of a class are known, so limits apply to a class as to its mean.
#[derive(Clone, Debug, Default)]
pub(crate) struct Steps {
    classes: BTreeMap<u64, Class>,
    number: u64,
    /// The last step, s, and the number of steps of several times the one before.
    last: f64,
    pub(crate) rises: u64,
}

/// Steps of nearly one length.
#[derive(Clone, Copy, Debug, Default)]
struct Class {
    number: u64,
    sum: f64,
    least: f64,
    most: f64,
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

    /// Adds a step of `length` s, above zero, over which the counts change by `jump`.
    pub(crate) fn add(&mut self, length: f64, jump: [i64; 2]) {
        let key = length.to_bits() >> Self::SHARED_BITS;
        let class = self.classes.entry(key).or_default();
        class.least = match class.number {
            0 => length,
            _ => class.least.min(length),
        };
        class.most = class.most.max(length);
        class.number += 1;
        class.sum += length;
        for (most, jump) in class.jump.iter_mut().zip(jump) {
            if jump.abs() >= most.abs() {
                *most = jump;
            }
        }
        self.number += 1;
        self.rises += u64::from(length > RISE * self.last);
        self.last = length;
    }

    fn classes(&self) -> impl Iterator<Item = &Class> {
        self.classes.values()
    }

    /// The largest jump of an encoder's counts from one row of this `period`, s, to the next; or over a few
    /// missing rows, if the shaft was not fast enough for it in any other row.
    /// With it come the rows from one of its ends to the other.
    pub(crate) fn largest_jump(&self, period: f64, motor: usize) -> (i64, f64) {
        let next = |class: &&Class| class.mean() <= NEXT * period;
        let jumps = self.classes().filter(next).map(|class| class.jump[motor]);
        let jump = jumps.max_by_key(|jump| jump.abs()).unwrap_or_default();
        let rows = |class: &Class| class.mean() / period;
        let over_missing = self.classes().filter(|class| {
            let rows = rows(class);
            let fastest = 2.0 * rows * jump.unsigned_abs().max(1) as f64;
            (NEXT..=FEW).contains(&rows) && class.jump[motor].unsigned_abs() as f64 > fastest
        });
        let jumps = over_missing.map(|class| (class.jump[motor], rows(class)));
        jumps
            .chain([(jump, 1.0)])
            .max_by_key(|(jump, _)| jump.abs())
            .unwrap_or_default()
    }

    /// Period of the rows, s, and the rate, Hz.
    ///
    /// The rate is one over the mean of the steps near the median, because the resolution of the
    /// median alone is that of the digits of `t`.
    pub(crate) fn period(&self, name: &str) -> Result<(f64, f64), Failure> {
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
                "{name}: column t: rows {} s apart are {rate_hz} Hz, which is below {SLOWEST_HZ} \
                 Hz; t must be in seconds, check that it is not in ms, us or ns, which --column \
                 t=NAME:ms states",
                shown(to_digits(period, 7))
            )));
        }
        if rate_hz > FASTEST_HZ {
            return Err(Failure::Input(format!(
                "{name}: column t: rows {} s apart are {rate_hz} Hz, which is above {FASTEST_HZ} Hz; t must be in \
                 seconds: if it is in minutes, hours or days, multiply it, or state its unit with --column \
                 t=NAME:UNIT",
                shown(to_digits(period, 7))
            )));
        }
        Ok((period, rate_hz))
    }

    /// Whether rows of this `period`, s, come at uneven times: a step over missing rows, or one of 1000 differs from it by
    /// more than a tenth, and the resolution of `t` does not explain the difference.
    pub(crate) fn are_uneven(&self, period: f64) -> bool {
        let resolution = self.resolution(period).unwrap_or(0.0);
        let explained = (1.0 - SAME) * resolution;
        let is_off =
            |step: &f64| differs(*step, period) > EVEN && (step - period).abs() >= explained;
        let off = self.classes().filter_map(|class| {
            let most = [class.least, class.most].into_iter().filter(is_off);
            Some((most.reduce(f64::max)?, class.number))
        });
        let (longest, number) = off
            .fold((0.0, 0), |(longest, number): (f64, u64), (step, more)| {
                (longest.max(step), number + more)
            });
        longest > NEXT * period || number as f64 > RARE * self.number as f64
    }

    /// Mean length and number of the steps of each class.
    pub(crate) fn lengths(&self) -> impl Iterator<Item = (f64, u64)> {
        self.classes().map(|class| (class.mean(), class.number))
    }

    /// The resolution of `t`, s, if every step is a multiple of it and it is more than a tenth of the
    /// `period`.
    fn resolution(&self, period: f64) -> Option<f64> {
        let steps: Vec<_> = self.classes().map(Class::mean).collect();
        let apart = steps.windows(2).map(|pair| pair[1] - pair[0]);
        // Steps of one length differ by the rounding of a float.
        let distances = steps.iter().copied().chain(apart);
        let distances = distances.filter(|distance| *distance > SAME * period);
        let unit = distances.fold(f64::INFINITY, f64::min);
        let is_multiple = |step: &f64| (step / unit - (step / unit).round()).abs() < SAME;
        (unit > EVEN * period && steps.iter().all(is_multiple)).then_some(unit)
    }

    /// Checks that the times of rows at `rate_hz` are known.
    ///
    /// # Errors
    /// [`Failure::Input`] with the remedy if more than a tenth of the steps differ from the period by
    /// more than half of it, and `t` has so few digits that late rows look as missing ones.
    pub(crate) fn check_times(&self, rate_hz: f64, name: &str) -> Result<(), Failure> {
        let Some(resolution) = self.resolution(1.0 / rate_hz) else {
            return Ok(());
        };
        let irregular = self
            .classes()
            .filter(|class| differs(class.mean(), 1.0 / rate_hz) > REGULAR);
        let irregular: u64 = irregular.map(|class| class.number).sum();
        let share = irregular as f64 / self.number as f64;
        if share <= IRREGULAR_SHARE {
            return Ok(());
        }
        let duration = self.classes().map(|class| class.sum).sum();
        let even = mean_rate(self.number, duration).map_or_else(String::new, |hz| {
            format!(", or, if the rows came at an even rate, give it with --row-rate {hz}")
        });
        Err(Failure::Input(format!(
            "{name}: column t: {:.0} % of the steps differ by more than half from the period of \
             1/{rate_hz} s, and t has steps of {} ms: late rows look as missing ones; log t with more \
             digits{even}, or, if t is exact and rows are missing, add --resample {rate_hz:.0}",
            100.0 * share,
            to_digits(1e3 * resolution, 4),
        )))
    }

    pub(crate) fn of(t: &[f64]) -> Self {
        Self::with_counts(t, |_| 0)
    }

    /// The steps of `t` with those of the counts of one encoder.
    pub(crate) fn with_counts(t: &[f64], count: impl Fn(usize) -> i64) -> Self {
        let mut steps = Self::default();
        for (k, pair) in t.windows(2).enumerate() {
            steps.add(pair[1] - pair[0], [count(k + 1) - count(k), 0]);
        }
        steps
    }
}

/// Difference of a step from a period, over the period.
pub(crate) fn differs(step: f64, period: f64) -> f64 {
    (step - period).abs() / period
}

#[cfg(test)]
mod tests {
    use super::*;

    const PERIOD: f64 = 1e-3;

    /// Ten steps of a period over which the count changes by `jump`, and one over three periods.
    fn over_missing(jump: i64, missing: i64) -> (i64, f64) {
        let mut steps = Steps::default();
        for _ in 0..10 {
            steps.add(PERIOD, [jump, 0]);
        }
        steps.add(3.0 * PERIOD, [missing, 0]);
        steps.largest_jump(PERIOD, 0)
    }

    #[test]
    fn jump_over_missing_rows_counts_beyond_twice_the_speed_of_the_others() {
        // Twice ten counts in each of three periods.
        assert_eq!(over_missing(10, 60), (10, 1.0));
        let (jump, rows) = over_missing(10, 61);
        assert!(jump == 61 && (rows - 3.0).abs() < 1e-12, "{jump} {rows}");
        // A shaft at rest may have moved by a count in each period.
        assert_eq!(over_missing(0, 6), (0, 1.0));
        assert_eq!(over_missing(0, -7).0, -7);
    }

    #[test]
    fn steps_are_uneven_beyond_a_tenth_of_the_period_and_the_digits_of_t() {
        let uneven_from = |period: f64, lengths: &[f64]| {
            let mut steps = Steps::default();
            for length in lengths {
                steps.add(length * PERIOD, [0; 2]);
            }
            steps.are_uneven(period * PERIOD)
        };
        let are_uneven = |lengths: &[f64]| uneven_from(1.0, lengths);
        assert!(!are_uneven(&[1.0; 20]));
        assert!(!are_uneven(&[1.0, 1.09, 0.91, 1.003]));
        assert!(are_uneven(&[1.0, 1.0, 1.11, 1.003]));
        assert!(are_uneven(&[1.0, 1.0, 0.89, 1.003]));
        // Rows 1.1 ms apart, whose times are rounded to a quarter of a millisecond.
        assert!(!uneven_from(1.1, &[1.0, 1.0, 1.25, 1.0, 1.25]));
        assert!(uneven_from(1.1, &[1.0, 1.0, 1.25, 1.0, 1.5]));
        // A late row among a thousand, two, and a missing one.
        let with = |others: &[f64]| are_uneven(&[&[1.0; 1500], others].concat());
        assert!(!with(&[1.4]) && !with(&[0.3]) && with(&[1.4, 0.6]) && with(&[2.0]));
    }
}
