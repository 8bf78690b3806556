//! Dates and times of day in the column of time.

use jiff::civil::{DateTime, Time};
use jiff::{SignedDuration, Timestamp};

/// A day, ns.
pub(crate) const DAY_NS: i128 = 86_400_000_000_000;

/// An hour, ns.
pub(crate) const HOUR_NS: i128 = DAY_NS / 24;

/// A minute, ns.
const MINUTE_NS: i128 = HOUR_NS / 60;

/// What a field of time has in the place of a number.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Kind {
    /// A date and a time with an offset from UTC, by ISO 8601.
    Instant,
    /// A date and a time without an offset.
    Date,
    /// Hours, minutes and seconds: a time of day or a duration.
    Clock,
    /// Minutes, and seconds with a fraction: a duration, or a time of day without its hours.
    Minutes,
    /// Whole seconds, with the part of a second in another column.
    Seconds,
}

/// The content of such a field.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Moment {
    pub(crate) kind: Kind,
    /// From 1970 on, or from midnight on, ns.
    pub(crate) ns: i128,
}

impl Moment {
    /// Reads a field; `None` for a number and for all that is not listed in `docs/your-log.md`.
    pub(crate) fn parse(text: &str) -> Option<Self> {
        let (first, _) = text.split_once(':')?;
        if let Some((day, rest)) = text.split_once(' ')
            && is_day(day)
        {
            return Self::clock(rest.trim_start_matches(' '));
        }
        match first.contains(['-', '/']) {
            true => Self::date(text),
            false => Self::clock(text).or_else(|| Self::minutes(text)),
        }
    }

    /// `12:00.5`. Without a fraction these may be hours and minutes.
    fn minutes(text: &str) -> Option<Self> {
        let (minutes, seconds) = text.split_once(':')?;
        let (whole, fraction) = seconds.split_once(['.', ','])?;
        let is_number = |text: &str| !text.is_empty() && text.bytes().all(|c| c.is_ascii_digit());
        let is_second = whole.len() == 2 && whole < "60";
        if !is_number(minutes) || minutes.len() > 3 || !is_second || !is_number(fraction) {
            return None;
        }
        let within: Time = format!("00:00:{seconds}").parse().ok()?;
        let within: SignedDuration = within.duration_since(Time::midnight());
        Some(Self {
            kind: Kind::Minutes,
            ns: minutes.parse::<i128>().ok()? * MINUTE_NS + within.as_nanos(),
        })
    }

    /// `2025-03-01T12:00:00.5`, with or without an offset from UTC.
    fn date(text: &str) -> Option<Self> {
        let text = text.replace('/', "-");
        let text = match text.strip_suffix(" UTC") {
            Some(text) => format!("{text}Z"),
            None => text,
        };
        if let Ok(at) = text.parse::<Timestamp>() {
            return Some(Self {
                kind: Kind::Instant,
                ns: at.as_nanosecond(),
            });
        }
        let at: DateTime = text.parse().ok()?;
        Some(Self {
            kind: Kind::Date,
            ns: at
                .duration_since(DateTime::constant(1970, 1, 1, 0, 0, 0, 0))
                .as_nanos(),
        })
    }

    /// `12:00:00.5`, `12:00:00.5 PM` and `2 days 00:00:00.5`.
    fn clock(text: &str) -> Option<Self> {
        let (days, text) = match text.split_once(" day") {
            Some((days, text)) => (
                days.parse::<u32>().ok()?,
                text.trim_start_matches(['s', ',', ' ']),
            ),
            None => (0, text),
        };
        let (text, half) = half(text);
        let (hours, rest) = text.split_once(':')?;
        // Hours beyond those of a day are of a duration.
        let hours = match hours.bytes().all(|digit| digit.is_ascii_digit()) {
            true => hours.parse::<u32>().ok()?,
            false => return None,
        };
        let hours = match half {
            None => hours,
            Some(half) if (1..=12).contains(&hours) => hours % 12 + 12 * half,
            Some(_) => return None,
        };
        let (minutes, _) = rest.split_once(':')?;
        let within: Time = format!("00:{rest}")
            .parse()
            .ok()
            .filter(|_| minutes.len() == 2)?;
        let within: SignedDuration = within.duration_since(Time::midnight());
        Some(Self {
            kind: Kind::Clock,
            ns: i128::from(days) * DAY_NS + i128::from(hours) * HOUR_NS + within.as_nanos(),
        })
    }
}

/// Whether a text is a date with the year at its end, as `3/1/2025` or `01.03.25`. Of such a date nobody knows
/// which number is the month. Rows are less than a day apart, so their times of day suffice.
fn is_day(text: &str) -> bool {
    ['/', '.', '-'].into_iter().any(|mark| {
        let parts: Vec<_> = text.split(mark).collect();
        let is_number = |part: &&str| part.bytes().all(|byte| byte.is_ascii_digit());
        let lengths: Vec<_> = parts
            .iter()
            .filter(|part| is_number(part))
            .map(|part| part.len())
            .collect();
        matches!(lengths[..], [1 | 2, 1 | 2, 2 | 4]) && parts.len() == 3
    })
}

/// A time of day without AM or PM at its end, and the half of the day that this was: 0 or 1.
fn half(text: &str) -> (&str, Option<u32>) {
    for (mark, half) in [("am", 0), ("pm", 1)] {
        let Some(at) = text.len().checked_sub(mark.len()) else {
            continue;
        };
        if text
            .get(at..)
            .is_some_and(|end| end.eq_ignore_ascii_case(mark))
        {
            return (text[..at].trim_end_matches(' '), Some(half));
        }
    }
    (text, None)
}

#[cfg(test)]
mod tests {
    use super::*;

    const SECOND: i128 = 1_000_000_000;

    #[test]
    fn dates_and_times_of_day_are_exact_to_the_nanosecond() {
        // 2025-03-01 is 20148 days after 1970: 55 years with 14 leap days, and 31 and 28 days on.
        let noon = 20_148 * DAY_NS + 12 * HOUR_NS;
        for (text, kind, ns) in [
            (
                "2025-03-01T12:00:00.123456789Z",
                Kind::Instant,
                noon + 123_456_789,
            ),
            ("2025-03-01T12:00:00+01:00", Kind::Instant, noon - HOUR_NS),
            (
                "2025-03-01 12:00:00.5+00:00",
                Kind::Instant,
                noon + SECOND / 2,
            ),
            (
                "2025-03-01T12:00:00.123",
                Kind::Date,
                noon + 123 * SECOND / 1000,
            ),
            (
                "2025-03-01 12:00:00,123",
                Kind::Date,
                noon + 123 * SECOND / 1000,
            ),
            ("2025-03-01 12:00:00 UTC", Kind::Instant, noon),
            ("2025/03/01 12:00:01", Kind::Date, noon + SECOND),
            ("12:00:00.000001", Kind::Clock, 12 * HOUR_NS + 1000),
            ("0:01:02,5", Kind::Clock, 125 * SECOND / 2),
            ("25:00:00", Kind::Clock, 25 * HOUR_NS),
            ("0 days 00:00:00.001000", Kind::Clock, SECOND / 1000),
            ("1 day, 0:00:01", Kind::Clock, DAY_NS + SECOND),
            ("2 days 00:00:01", Kind::Clock, 2 * DAY_NS + SECOND),
            ("12:00:00.5 PM", Kind::Clock, 12 * HOUR_NS + SECOND / 2),
            ("12:00:01 am", Kind::Clock, SECOND),
            ("00:00.000", Kind::Minutes, 0),
            ("1:02,5", Kind::Minutes, 125 * SECOND / 2),
            ("75:00.000001", Kind::Minutes, 75 * MINUTE_NS + 1000),
            ("1:00:00PM", Kind::Clock, 13 * HOUR_NS),
            ("3/1/2025 11:00:00 AM", Kind::Clock, 11 * HOUR_NS),
            (
                "31.12.2025 23:00:00,5",
                Kind::Clock,
                23 * HOUR_NS + SECOND / 2,
            ),
            (
                "31-12-25  23:00:00.5",
                Kind::Clock,
                23 * HOUR_NS + SECOND / 2,
            ),
        ] {
            assert_eq!(Moment::parse(text), Some(Moment { kind, ns }), "{text}");
        }
    }

    #[test]
    fn other_texts_are_no_moments() {
        for text in [
            "",
            "1.5",
            "-3",
            "2025-03-01",
            "12:00",
            "12:60.5",
            "12:0.5",
            "12:00.",
            "1234:00.5",
            "-1:00.5",
            "12:00.5 PM",
            ":",
            "::",
            "1:2:3",
            "-1:00:00",
            "+1:00:00",
            "12:60:00",
            "13:00:00 PM",
            "0:00:00 AM",
            "12:00:00 PM UTC",
            "PM",
            "3/1/2025",
            "3/1 12:00:00",
            "3/1/2025/4 12:00:00",
            "3/1.2025 12:00:00",
            "2025.3.1 12:00:00",
            "123/1/2025 12:00:00",
            "01-Mar-2025 12:00:00",
            "x days 00:00:00",
            "1:00:00:00",
            "99999999999:00:00",
            "2025-02-30 12:00:00",
            "12:00:00.5 ",
            "2025-03-01 12:00:00 CET",
            "2025-03-01 12:00:00+01:00 UTC",
            "2025-03-01 12:00:00Z UTC",
            "1 day",
        ] {
            assert_eq!(Moment::parse(text), None, "{text}");
        }
    }
}
