//! Times of the rows as a log has them.

use terminal::failure::Failure;

use super::NEAR;
use super::float_times::FloatTimes;
use super::moment::{DAY_NS, HOUR_NS, Kind, Moment};
use crate::recording::columns::scaled;
use crate::recording::layout::{Part, Place};
use crate::recording::options::units::{FILETIME, Quantity, Unit};
use crate::recording::text::row::Row;

/// A day, s.
const DAY_S: f64 = DAY_NS as f64 / 1e9;

/// An hour, s.
const HOUR_S: f64 = HOUR_NS as f64 / 1e9;

/// The period of `micros()`, s: 2^32 us.
const MICROS_S: f64 = 4_294_967_296.0 / 1e6;

/// Bits of the counters that are read as times.
const BITS: [i32; 2] = [32, 16];

/// The log's own times, in s: numbers, dates or times of day.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct OwnTimes {
    form: Option<Form>,
    wraps: Wraps,
    pub(crate) floats: FloatTimes,
}

/// What the times of all rows are.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Form {
    Number {
        unit: &'static Unit,
    },
    /// Counted from `origin_ns` on, a midnight at or before the first row.
    Moment {
        kind: Kind,
        origin_ns: i128,
    },
}

impl OwnTimes {
    /// The time of a row, s. A counter that has wrapped and a clock that has passed midnight go on.
    ///
    /// # Errors
    /// [`Failure::Input`] if the field is no time, or if it has another form than those above it.
    pub(crate) fn of(&mut self, row: &Row, at: Place) -> Result<f64, Failure> {
        let column = at.column.name();
        let moment = match at.part {
            Some(part) => Some(seconds(row, at, part)?),
            None if at.unit == &FILETIME => Some(Moment {
                kind: Kind::Seconds,
                ns: i128::from(row.count(column, at.place)?) * 100,
            }),
            None => Moment::parse(row.text(column, at.place)?),
        };
        let Some(Moment { kind, ns }) = moment else {
            let (t, unit) = match with_unit(row.text(column, at.place)?) {
                Some(found) => found,
                None => (scaled(row, at, 1.0)?, at.unit),
            };
            let form = *self.form.get_or_insert(Form::Number { unit });
            return match form {
                Form::Number { unit } => {
                    self.floats.add(t, unit.per_s());
                    // A counter of microseconds may be written in another unit.
                    Ok(self
                        .wraps
                        .unwrapped(t, &periods(unit), &[MICROS_S], row.line))
                }
                Form::Moment { .. } => Err(mixed(row, at)),
            };
        };
        // Seconds since 1970 in a float have no more digits than 0.2 us.
        let origin_ns = match kind {
            Kind::Clock | Kind::Minutes => 0,
            Kind::Instant | Kind::Date | Kind::Seconds => ns - ns.rem_euclid(DAY_NS),
        };
        match *self.form.get_or_insert(Form::Moment { kind, origin_ns }) {
            Form::Moment {
                kind: first,
                origin_ns,
            } if kind == first => {
                let t = (ns - origin_ns) as f64 / 1e9;
                Ok(match kind {
                    Kind::Clock => self.wraps.unwrapped(t, &[DAY_S], &[], row.line),
                    Kind::Minutes => self.wraps.unwrapped(t, &[HOUR_S], &[], row.line),
                    Kind::Instant | Kind::Date | Kind::Seconds => t,
                })
            }
            _ => Err(mixed(row, at)),
        }
    }

    /// Notes on the form of the times and on the first wrap.
    pub(crate) fn notes(&self) -> impl Iterator<Item = String> {
        let form = match self.form {
            Some(Form::Moment {
                kind: Kind::Clock, ..
            }) => Some("t is a time of day or a duration: s from 0:00:00 on"),
            Some(Form::Moment {
                kind: Kind::Minutes,
                ..
            }) => Some("t is minutes and seconds: s from 0:00 on"),
            Some(Form::Moment {
                kind: Kind::Seconds,
                origin_ns: 0,
            }) => None,
            Some(Form::Moment {
                kind: Kind::Seconds,
                ..
            }) => Some("t is s from the midnight before the first row on"),
            Some(Form::Moment { .. }) => {
                Some("t is a date and a time: s from the midnight before the first row on")
            }
            Some(Form::Number { .. }) | None => None,
        };
        let wrap = self.wraps.first.map(|(line, period)| match self.form {
            Some(Form::Number { unit }) if period != DAY_S => {
                let (bits, unit) = match period == MICROS_S {
                    true => (32.0, "us"),
                    false => ((period * unit.per_s()).log2().round(), unit.name()),
                };
                format!(
                    "t wraps at 2^{bits} {unit} and is unwrapped, the first time in line {line}: a counter of {bits} bits"
                )
            }
            _ if period == HOUR_S => format!("an hour is full in line {line}, and t goes on"),
            _ => format!("midnight passes in line {line}, and t goes on"),
        });
        form.map(str::to_owned).into_iter().chain(wrap)
    }
}

/// The time, s, and the unit of a field that has its unit in it, as MATLAB writes durations: `0.5 sec`.
fn with_unit(text: &str) -> Option<(f64, &'static Unit)> {
    // Most fields are numbers: no unit is compared with them.
    if text.ends_with(|c: char| c.is_ascii_digit()) {
        return None;
    }
    let mut units = Quantity::Time.units().iter();
    let (number, unit) = units.find_map(|unit| Some((unit.before(text)?, unit)))?;
    let number: f64 = number.trim_end().parse().ok()?;
    number
        .is_finite()
        .then(|| (unit.scale.of(number, 1.0), unit))
}

/// The moment that whole seconds and the part of a second in another column state.
fn seconds(row: &Row, at: Place, part: Part) -> Result<Moment, Failure> {
    let column = at.column.name();
    let whole = row.count(column, at.place)?;
    let fraction = row.count(column, part.place)?;
    let per_s = part.unit.per_s() as i64;
    if !(0..per_s).contains(&fraction) {
        let (name, unit) = (&row.names[part.place], part.unit.name());
        return Err(row.failure(
            column,
            &format!(
                "'{name}' has {fraction} {unit}, which is no part of the second that '{}' counts; if it is a \
                 time of its own, name it with --column 't={name}:{unit}'",
                row.names[at.place]
            ),
        ));
    }
    let ns = fraction * (1_000_000_000 / per_s);
    Ok(Moment {
        kind: Kind::Seconds,
        ns: i128::from(whole) * 1_000_000_000 + i128::from(ns),
    })
}

/// Periods, s, of a number of `unit`: a day, and those of counters, which count no seconds.
fn periods(unit: &Unit) -> [f64; 3] {
    let [long, short] = BITS.map(|bits| match unit.per_s() > 1.0 {
        true => 2.0_f64.powi(bits) / unit.per_s(),
        false => DAY_S,
    });
    [DAY_S, long, short]
}

fn mixed(row: &Row, at: Place) -> Failure {
    row.failure(
        at.column.name(),
        "the form of the time differs from that of the rows above; write all times as numbers, as dates, or \
         as times of day",
    )
}

/// A time that begins anew after a period.
#[derive(Clone, Copy, Debug, Default)]
struct Wraps {
    /// The last time in the log, s.
    last: f64,
    /// The last step between two rows, s.
    step: f64,
    /// Whole periods since the first row, s.
    passed: f64,
    /// Line after the first wrap, and its period, s.
    first: Option<(u64, f64)>,
}

impl Wraps {
    /// The time `t`, s, with the periods that have passed before `line`. A time that goes back by one of
    /// `periods` within a hundredth has wrapped: in microseconds, if no more than 43 s are missing there. So has one
    /// after which the step is at most twice the step before, which is a larger part of a short period; this alone
    /// tells a wrap after one of `by_steps`. A signed counter wraps to half a period below 0.
    fn unwrapped(&mut self, t: f64, periods: &[f64], by_steps: &[f64], line: u64) -> f64 {
        let (last, back) = (self.last, self.last - t);
        let is_within = |period: f64| {
            let first = if t < 0.0 { -0.5 * period } else { 0.0 };
            t >= first && last < first + period
        };
        let is_near = |period: f64| (back - period).abs() < NEAR * period;
        let step = self.step;
        let is_step = |period: f64| {
            let over = period - back;
            over > 0.0 && over <= 2.0 * step && 4.0 * step < period
        };
        let own = periods
            .iter()
            .find(|period| is_within(**period) && (is_near(**period) || is_step(**period)));
        let by_step = || {
            by_steps
                .iter()
                .find(|period| is_within(**period) && is_step(**period))
        };
        self.step = -back;
        if let Some(&period) = own.or_else(by_step) {
            self.passed += period;
            self.step += period;
            self.first.get_or_insert((line, period));
        }
        self.last = t;
        t + self.passed
    }
}

#[cfg(test)]
mod tests;
