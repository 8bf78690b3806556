//! Times of the rows as a log has them.

use terminal::failure::Failure;

use super::columns::scaled;
use super::layout::Place;
use super::moment::{DAY_NS, Kind, Moment};
use super::row::Row;
use super::times::NEAR;
use super::units::Unit;

/// A day, s.
const DAY_S: f64 = DAY_NS as f64 / 1e9;

/// Bits of the counters that are read as times.
const BITS: [i32; 2] = [32, 16];

/// The log's own times, in s: numbers, dates or times of day.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct OwnTimes {
    form: Option<Form>,
    wraps: Wraps,
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
    pub(super) fn of(&mut self, row: &Row, at: Place) -> Result<f64, Failure> {
        let column = at.column.name();
        let Some(Moment { kind, ns }) = Moment::parse(row.text(column, at.place)?) else {
            let t = scaled(row, at, 1.0)?;
            let form = *self.form.get_or_insert(Form::Number { unit: at.unit });
            return match form {
                Form::Number { unit } => Ok(self.wraps.unwrapped(t, &periods(unit), row.line)),
                Form::Moment { .. } => Err(mixed(row, at)),
            };
        };
        // Seconds since 1970 in a float have no more digits than 0.2 us.
        let origin_ns = match kind {
            Kind::Clock => 0,
            Kind::Instant | Kind::Date => ns - ns.rem_euclid(DAY_NS),
        };
        match *self.form.get_or_insert(Form::Moment { kind, origin_ns }) {
            Form::Moment {
                kind: first,
                origin_ns,
            } if kind == first => {
                let t = (ns - origin_ns) as f64 / 1e9;
                Ok(match kind {
                    Kind::Clock => self.wraps.unwrapped(t, &[DAY_S], row.line),
                    Kind::Instant | Kind::Date => t,
                })
            }
            _ => Err(mixed(row, at)),
        }
    }

    /// Notes on the form of the times and on the first wrap.
    pub(super) fn notes(&self) -> impl Iterator<Item = String> {
        let form = match self.form {
            Some(Form::Moment {
                kind: Kind::Clock, ..
            }) => Some("t is a time of day or a duration: s from 0:00:00 on"),
            Some(Form::Moment { .. }) => {
                Some("t is a date and a time: s from the midnight before the first row on")
            }
            Some(Form::Number { .. }) | None => None,
        };
        let wrap = self.wraps.first.map(|(line, period)| match self.form {
            Some(Form::Number { unit }) if period != DAY_S => format!(
                "t wraps at 2^{bits} {} and is unwrapped, the first time in line {line}: a counter of {bits} bits",
                unit.name(),
                bits = (period * unit.per_s()).log2().round()
            ),
            _ => format!("midnight passes in line {line}, and t goes on"),
        });
        form.map(str::to_owned).into_iter().chain(wrap)
    }
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
    /// Whole periods since the first row, s.
    passed: f64,
    /// Line after the first wrap, and its period, s.
    first: Option<(u64, f64)>,
}

impl Wraps {
    /// The time `t`, s, with the periods that have passed before `line`. A time that goes back by one of
    /// `periods` within a hundredth has wrapped: in microseconds, if no more than 43 s are missing there. A signed
    /// counter wraps to half a period below 0.
    fn unwrapped(&mut self, t: f64, periods: &[f64], line: u64) -> f64 {
        let (last, back) = (self.last, self.last - t);
        let is_wrap = |period: &&f64| {
            let first = if t < 0.0 { -0.5 * **period } else { 0.0 };
            let is_within = t >= first && last < first + **period;
            is_within && (back - **period).abs() < NEAR * **period
        };
        if let Some(&period) = periods.iter().find(is_wrap) {
            self.passed += period;
            self.first.get_or_insert((line, period));
        }
        self.last = t;
        t + self.passed
    }
}

#[cfg(test)]
mod tests {
    use crate::recording::read_log as read;

    /// A log with the times `times`, and counts of 1 a row.
    fn log(times: &[&str]) -> String {
        let rows = times.iter().enumerate();
        let rows = rows.map(|(k, t)| format!("\"{t}\",{k}\n"));
        format!("t,counts_large\n{}", rows.collect::<String>())
    }

    #[test]
    fn dates_and_times_of_day_are_seconds_from_midnight_on() {
        let clock = "t is a time of day or a duration: s from 0:00:00 on";
        let date = "t is a date and a time: s from the midnight before the first row on";
        for (times, said, exact) in [
            (
                ["12:00:00", "12:00:00.0625", "12:00:00,125"],
                clock,
                43_200.0,
            ),
            (
                [
                    "0 days 00:00:01",
                    "0 days 00:00:01.0625",
                    "0 days 00:00:01.125",
                ],
                clock,
                1.0,
            ),
            (
                [
                    "2025-03-01T00:00:02",
                    "2025-03-01 00:00:02.0625",
                    "2025-03-01 00:00:02,125",
                ],
                date,
                2.0,
            ),
            // The midnight before the first row is that of UTC, and the offset may change.
            (
                [
                    "2025-03-01T00:30:00+01:00",
                    "2025-03-01T00:30:00.0625+01:00",
                    "2025-02-28T23:30:00.125Z",
                ],
                date,
                84_600.0,
            ),
        ] {
            let recording = read(&log(&times), "").unwrap();
            assert_eq!(
                recording.t,
                [exact, exact + 0.0625, exact + 0.125],
                "{times:?}"
            );
            assert_eq!(recording.notes, [said]);
        }
    }

    #[test]
    fn signed_counter_wraps_to_negative_times() {
        let text = "time_us,counts\n2147481648,0\n2147482648,1\n-2147483648,2\n-2147482648,3\n-2147481648,4\n";
        let recording = read(text, "").unwrap();
        let steps: Vec<_> = recording
            .t
            .windows(2)
            .map(|pair| pair[1] - pair[0])
            .collect();
        assert!(
            steps.iter().all(|step| (step - 1e-3).abs() < 1e-6),
            "{steps:?}"
        );
        let said =
            "t wraps at 2^32 us and is unwrapped, the first time in line 4: a counter of 32 bits";
        assert!(
            recording.notes.iter().any(|note| note == said),
            "{:?}",
            recording.notes
        );
        // A time that is negative before goes back.
        let error = read("time_us,counts\n0,0\n1000,1\n-500,2\n", "").unwrap_err();
        assert!(error.contains("line 4"), "{error}");
    }

    #[test]
    fn a_microsecond_is_kept_in_a_date() {
        let times: Vec<_> = (0..50)
            .map(|k| format!("2025-03-01T23:59:00.{:06}Z", 20 * k))
            .collect();
        let times: Vec<_> = times.iter().map(String::as_str).collect();
        let recording = read(&log(&times), "").unwrap();
        assert!(
            (recording.trace.rate_hz - 50e3).abs() < 0.1,
            "{}",
            recording.trace.rate_hz
        );
    }

    #[test]
    fn clock_passes_midnight() {
        let recording = read(
            &log(&["23:59:59.875", "23:59:59.9375", "00:00:00", "00:00:00.0625"]),
            "",
        )
        .unwrap();
        assert_eq!(
            recording.t,
            [86_399.875, 86_399.937_5, 86_400.0, 86_400.062_5]
        );
        assert_eq!(
            recording.notes[1],
            "midnight passes in line 4, and t goes on"
        );
        // As a number: VESC Tool logs the milliseconds of today.
        let text = "t,counts_large\n86399980,0\n86399990,1\n0,2\n10,3\n";
        let recording = read(text, "t=t:ms").unwrap();
        assert_eq!(recording.t, [86_399.98, 86_399.99, 86_400.0, 86_400.01]);
        assert_eq!(
            recording.notes[1],
            "midnight passes in line 4, and t goes on"
        );
        // A day is in a date, so nothing is added there.
        let dated = [
            "2025-03-02T23:59:59",
            "2025-03-02T23:59:59.875",
            "2025-03-02T00:00:00",
        ];
        let error = read(&log(&dated), "").unwrap_err();
        assert!(
            error.starts_with("r.csv: line 4: column t: 0 s is before the 86399.875 s above it"),
            "{error}"
        );
    }

    #[test]
    fn forms_of_time_do_not_mix() {
        for times in [
            ["12:00:00", "43200.5"],
            ["43200", "12:00:00.5"],
            ["2025-03-01T12:00:00", "2025-03-01T12:00:00.5Z"],
            ["12:00:00", "2025-03-01T12:00:00.5"],
        ] {
            let error = read(&log(&times), "").unwrap_err();
            let said =
                "r.csv: line 3: column t: the form of the time differs from that of the rows above";
            assert!(error.starts_with(said), "{error}");
        }
    }

    #[test]
    fn header_is_found_above_times_of_day() {
        let text = "made by a logger\nClock;Position\n12:00:00.1;5\n12:00:00.2;6\n";
        let error = read(text, "").unwrap_err();
        assert!(
            error.starts_with("r.csv: line 2: no column t; found: Clock; Position"),
            "{error}"
        );
        let recording = read(text, "t=Clock,counts_large=Position").unwrap();
        assert_eq!(recording.trace.counts_large, [5, 6]);
    }

    #[test]
    fn counter_of_32_bits_is_unwrapped() {
        let mut text = String::from("t,counts_large\n");
        for k in 0..50_u32 {
            text += &format!("{},{k}\n", (1000 * k).wrapping_sub(5_500));
        }
        let recording = read(&text, "t=t:us").unwrap();
        let note =
            "t wraps at 2^32 us and is unwrapped, the first time in line 8: a counter of 32 bits";
        assert_eq!(recording.notes[1], note);
        assert_eq!(recording.trace.rate_hz, 1000.0);
        assert_eq!(recording.uneven_steps, 0);
        let (t, last) = (&recording.t, recording.t.len() - 1);
        assert!((t[last] - t[0] - 1e-3 * last as f64).abs() < 1e-9);
        // Of 16 bits; a step back by less is none.
        let short = |back: u32| -> String {
            let rows = (65_530..65_536)
                .chain(65_536 - back..65_542 - back)
                .zip(0..);
            rows.map(|(ms, k): (u32, u32)| format!("{ms},{k}\n"))
                .collect()
        };
        let text = |rows: String| format!("t,counts_large\n{rows}");
        let recording = read(&text(short(65_536)), "t=t:ms").unwrap();
        let note =
            "t wraps at 2^16 ms and is unwrapped, the first time in line 8: a counter of 16 bits";
        assert_eq!(recording.notes[1], note);
        assert!((recording.t[11] - 65.541).abs() < 1e-9);
        assert!(read(&text(short(64_000)), "t=t:ms").is_err());
        // Seconds are no counter, and a step to below zero is no wrap.
        for (unit, times) in [
            ("s", "4294967295,0\n0,1\n"),
            ("us", "4294966000,0\n-1000,1\n"),
        ] {
            let error = read(&format!("t,counts_large\n{times}"), &format!("t=t:{unit}"));
            assert!(
                error.unwrap_err().contains("sort the rows by time"),
                "{times}"
            );
        }
    }
}
