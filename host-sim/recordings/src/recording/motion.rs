//! The motion of a recording in numbers that its owner knows: a wrong unit or a wrong encoder shows in them.

use std::f64::consts::TAU;

use device_files::to_digits;

use super::Recording;

/// Least time over which a speed is taken, s: at single rows a count is a large one.
const SPAN_S: f64 = 0.02;

/// How far and how fast a shaft turns.
#[derive(Clone, Copy, Debug, Default)]
pub struct Motion {
    /// The latest count, and its position from the first one, counts.
    last: Option<(u32, i64)>,
    least: i64,
    most: i64,
    /// Time, s, and position at which the span of a speed begins.
    begin: Option<(f64, i64)>,
    /// Largest speed, counts/s.
    fastest: f64,
}

impl Recording {
    /// Its motion, with unwrapped counts.
    #[must_use]
    pub fn motion(&self) -> Motion {
        let mut motion = Motion::default();
        motion.add(&self.t, &self.trace.counts_large);
        motion
    }
}

impl Motion {
    /// Adds rows with the times `t`, s, and their unwrapped `counts`.
    pub fn add(&mut self, t: &[f64], counts: &[u32]) {
        for (&t, &count) in t.iter().zip(counts) {
            let position = self.last.map_or(0, |(last, position)| {
                position + i64::from(count.wrapping_sub(last) as i32)
            });
            self.last = Some((count, position));
            self.least = self.least.min(position);
            self.most = self.most.max(position);
            let (since, from) = *self.begin.get_or_insert((t, position));
            if t - since >= SPAN_S {
                let speed = (position - from).unsigned_abs() as f64 / (t - since);
                self.fastest = self.fastest.max(speed);
                self.begin = Some((t, position));
            }
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
    use super::Motion;

    #[test]
    fn motion_is_that_of_the_shaft() {
        // From 2^32 - 100 on, half a revolution back and a whole one forward, at 10 rev/s and 5 rev/s.
        let back = (0..=50).map(|k| (1e-3 * f64::from(k), -10 * k));
        let forth = (1..=200).map(|k| (0.05 + 1e-3 * f64::from(k), -500 + 5 * k));
        let (t, counts): (Vec<_>, Vec<_>) = back
            .chain(forth)
            .map(|(t, moved)| (t, (moved - 100) as u32))
            .unzip();
        let said = "the shaft turns within 1 rev, at up to 62.8 rad/s (600 rpm)";
        let mut whole = Motion::default();
        whole.add(&t, &counts);
        assert_eq!(whole.line(1000), said);
        let mut parts = Motion::default();
        for (t, counts) in t.chunks(7).zip(counts.chunks(7)) {
            parts.add(t, counts);
        }
        assert_eq!(parts.line(1000), said);
    }

    #[test]
    fn one_count_of_a_shaft_at_rest_is_no_speed_of_a_row() {
        let t: Vec<_> = (0..1000).map(|k| 1e-4 * f64::from(k)).collect();
        let counts: Vec<_> = (0..1000).map(|k| u32::from(k >= 500)).collect();
        let mut motion = Motion::default();
        motion.add(&t, &counts);
        let said = "the shaft turns within 0.01 rev, at up to 3.14 rad/s (30 rpm)";
        assert_eq!(motion.line(100), said);
    }

    #[test]
    fn speed_of_slow_rows_is_that_of_a_row() {
        let t = [0.0, 0.1, 0.2];
        let mut motion = Motion::default();
        motion.add(&t, &[0, 10, 40]);
        let said = "the shaft turns within 0.4 rev, at up to 18.8 rad/s (180 rpm)";
        assert_eq!(motion.line(100), said);
    }
}
