//! The motion of a recording in numbers that its owner knows: a wrong unit or a wrong encoder shows in them.

use std::f64::consts::TAU;

use device_files::to_digits;
use recordings::recording::Recording;
use simulation::trace::Trace;

use super::sections::{Row, rows};

/// Least time over which a speed is taken, s: at single rows a count is a large one.
const SPAN_S: f64 = 0.02;

/// How far and how fast a shaft turns, without bad counts and jumps of the counter.
#[derive(Clone, Copy, Debug, Default)]
pub struct ShaftMotion {
    /// Time, s, and count of the latest row that is not bad.
    last: Option<(f64, u32)>,
    /// Its position from the first one, counts.
    position: i64,
    least: i64,
    most: i64,
    /// Time, s, and position at which the span of a speed begins.
    begin: Option<(f64, i64)>,
    /// Largest speed, counts/s.
    fastest: f64,
}

impl ShaftMotion {
    /// The motion of a whole `recording`.
    #[must_use]
    pub fn of(recording: &Recording) -> Self {
        let mut motion = Self::default();
        motion.add(recording);
        motion
    }

    /// Adds the next rows of a recording, with unwrapped counts. Bad counts and jumps are those of these rows alone.
    pub fn add(&mut self, recording: &Recording) {
        let (known, with_last) = self.with_last(recording);
        let kinds = rows(&with_last);
        let counts = &with_last.trace.counts_large;
        for ((&t, &count), kind) in with_last.t.iter().zip(counts).zip(kinds).skip(known) {
            if kind != Row::Bad {
                self.add_row(t, count, kind);
            }
        }
    }

    /// The rows of `recording` behind the last one that was added, and the number of rows before them: a counter may
    /// jump from one part to the next.
    fn with_last(&self, recording: &Recording) -> (usize, Recording) {
        let (t, counts): (Vec<_>, Vec<_>) = self.last.into_iter().unzip();
        let trace = Trace {
            rate_hz: recording.trace.rate_hz,
            counts_large: [&counts, &recording.trace.counts_large[..]].concat(),
            ..Trace::default()
        };
        let with_last = Recording {
            t: [&t, &recording.t[..]].concat(),
            trace,
            ..Recording::default()
        };
        (t.len(), with_last)
    }

    /// Adds a row that is not bad.
    fn add_row(&mut self, t: f64, count: u32, kind: Row) {
        let (_, last) = self.last.unwrap_or((t, count));
        self.last = Some((t, count));
        // A counter counts on in a long gap; how far the shaft turned where it jumped is not known.
        if !matches!(kind, Row::Jumped | Row::Returned) {
            self.position += i64::from(count.wrapping_sub(last) as i32);
        }
        self.least = self.least.min(self.position);
        self.most = self.most.max(self.position);
        if kind != Row::Next {
            self.begin = None;
        }
        let (since, from) = *self.begin.get_or_insert((t, self.position));
        if t - since >= SPAN_S {
            let speed = (self.position - from).unsigned_abs() as f64 / (t - since);
            self.fastest = self.fastest.max(speed);
            self.begin = Some((t, self.position));
        }
    }

    /// How far the shaft turns, and its largest mean speed over 20 ms or a row.
    #[must_use]
    pub fn line(&self, counts_per_rev: u32) -> String {
        let revolutions = (self.most - self.least) as f64 / f64::from(counts_per_rev);
        let per_s = self.fastest / f64::from(counts_per_rev);
        let [revolutions, omega, rpm] =
            [revolutions, TAU * per_s, 60.0 * per_s].map(|number| to_digits(number, 3));
        format!("the shaft turns within {revolutions} rev, at up to {omega} rad/s ({rpm} rpm)")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Rows at the times `t`, s, whose rate is `rate_hz`.
    fn recording(rate_hz: f64, t: &[f64], counts: &[i64]) -> Recording {
        Recording {
            t: t.to_vec(),
            trace: Trace {
                rate_hz,
                counts_large: counts.iter().map(|count| *count as u32).collect(),
                ..Trace::default()
            },
            ..Recording::default()
        }
    }

    /// What is said of rows at 1 kHz that come in parts of `size` rows, with 1000 counts per revolution.
    fn said(counts: &[i64], size: usize) -> String {
        let t: Vec<_> = (0..counts.len()).map(|k| 1e-3 * k as f64).collect();
        let mut motion = ShaftMotion::default();
        for (t, counts) in t.chunks(size).zip(counts.chunks(size)) {
            motion.add(&recording(1e3, t, counts));
        }
        motion.line(1000)
    }

    #[test]
    fn motion_is_that_of_the_shaft() {
        // From 2^32 - 100 on, half a revolution back and a whole one forward, at 10 rev/s and 5 rev/s.
        let back = (0..=50).map(|k| -10 * k);
        let forth = (1..=200).map(|k| -500 + 5 * k);
        let counts: Vec<_> = back.chain(forth).map(|moved| moved - 100).collect();
        let expected = "the shaft turns within 1 rev, at up to 62.8 rad/s (600 rpm)";
        assert_eq!(said(&counts, 1000), expected);
        assert_eq!(said(&counts, 7), expected);
    }

    #[test]
    fn one_count_of_a_shaft_at_rest_is_no_speed_of_a_row() {
        let t: Vec<_> = (0..1000).map(|k| 1e-4 * f64::from(k)).collect();
        let counts: Vec<_> = (0..1000).map(|k| i64::from(k >= 500)).collect();
        let motion = ShaftMotion::of(&recording(1e4, &t, &counts));
        let said = "the shaft turns within 0.01 rev, at up to 3.14 rad/s (30 rpm)";
        assert_eq!(motion.line(100), said);
    }

    #[test]
    fn speed_of_slow_rows_is_that_of_a_row() {
        let motion = ShaftMotion::of(&recording(10.0, &[0.0, 0.1, 0.2], &[0, 10, 40]));
        let said = "the shaft turns within 0.4 rev, at up to 18.8 rad/s (180 rpm)";
        assert_eq!(motion.line(100), said);
    }

    /// Two counts a row are 2 rev/s; 900 rows of them are 1.8 revolutions.
    #[test]
    fn bad_counts_and_jumps_are_no_motion() {
        let steady = |k: i64| 2 * k;
        let expected = "the shaft turns within 1.8 rev, at up to 12.6 rad/s (120 rpm)";
        for at in [1, 299, 300, 301, 450, 899] {
            let bad: Vec<_> = (0..=900)
                .map(|k| steady(k) + if k == at { 40_000 } else { 0 })
                .collect();
            // In parts that end before, with and behind the row.
            for size in [1000, 300] {
                assert_eq!(said(&bad, size), expected, "bad {at} {size}");
            }
        }
        // Of the motion in the row of a jump nothing is known: two counts, which three digits do not show.
        for at in [1, 299, 300, 301, 450] {
            let jump: Vec<_> = (0..=900)
                .map(|k| steady(k) + if k >= at { -40_000 } else { 0 })
                .collect();
            for size in [1000, 300] {
                assert_eq!(said(&jump, size), expected, "jump {at} {size}");
            }
        }
    }

    #[test]
    fn counter_counts_on_in_a_long_gap() {
        let t: Vec<_> = (0..200)
            .map(|k| 1e-3 * f64::from(k + if k < 100 { 0 } else { 1000 }))
            .collect();
        let counts: Vec<_> = (0..200)
            .map(|k| k + if k < 100 { 0 } else { 700 })
            .collect();
        let motion = ShaftMotion::of(&recording(1e3, &t, &counts));
        let said = "the shaft turns within 0.899 rev, at up to 6.28 rad/s (60 rpm)";
        assert_eq!(motion.line(1000), said);
    }
}
