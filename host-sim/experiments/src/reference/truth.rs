//! Whether the column of the true velocity of a recording fits the motion of its counts.
//!
//! A velocity in another unit, of the opposite sign, of other times or computed from the counts gives a ranking without
//! a meaning. Displacements of the counts in blocks of [`SKIP_S`](scoring::score::SKIP_S) are compared with those of
//! the velocity: over a block quantisation is a count at most, however slow the motion is in a row.

use std::f64::consts::{PI, TAU};

use recordings::recording::Recording;
use scoring::score::skipped;

use super::sections::{Row, rows};
use crate::table::number;

/// Least ratio of the displacements' mean square to that of quantisation, for a statement on them: they are then known
/// to a tenth.
const KNOWN_TO_A_TENTH: f64 = 100.0;

/// Fewest blocks, and fewest rows at which the count changes, for a statement.
const FEWEST: usize = 10;

/// Largest relative error of the gain that is not said: that to which the displacements are known.
const GAIN: f64 = 0.1;

/// Least magnitude of the correlation of displacements that belong to one motion.
const CORRELATED: f64 = 0.5;

/// Largest relative difference from the ratio of two units.
const UNIT: f64 = 0.03;

/// Largest delay that is not said, periods: a logger may write the velocity of the row before or after.
const DELAY: f64 = 2.0;

/// Largest share of the squared differences that is left without a delay, if the delay explains them.
const EXPLAINED: f64 = 0.5;

/// Largest RMS deviation of a velocity that is a difference of the counts, counts a row. A shaft's own velocity is
/// uniformly within a count, which is 0.3 counts RMS.
const DIFFERENCE: f64 = 0.05;

/// Sums over the blocks of a recording.
#[derive(Clone, Copy, Debug, Default)]
pub struct TruthCheck {
    blocks: usize,
    /// Squares and products of the displacement of the counts, rad, that of the velocity, rad, and the change of the
    /// velocity, rad/s.
    sums: [[f64; 3]; 3],
    /// Number of rows at which the count changes, and the squared deviations of the velocity there from the difference
    /// to the row before, and from half of that between the rows before and after, counts.
    changes: usize,
    deviations: [f64; 2],
    /// The least and the largest of these changes, counts.
    steps: Option<[f64; 2]>,
    quantum_rad: f64,
    period_s: f64,
}

impl TruthCheck {
    /// Adds the rows of `recording`, whose encoder has `counts_per_rev`, if it has a true velocity.
    pub fn add(&mut self, recording: &Recording, counts_per_rev: u32) {
        let trace = &recording.trace;
        let Some(omega) = &trace.true_omega else {
            return;
        };
        let (t, counts) = (&recording.t, &trace.counts_large);
        self.quantum_rad = TAU / f64::from(counts_per_rev);
        self.period_s = trace.period_s();
        let quantum = self.quantum_rad;
        let step = |k: usize| f64::from(counts[k].wrapping_sub(counts[k - 1]) as i32);
        let since = |k: usize| t[k] - t[k - 1];
        let kinds = rows(recording);
        let is_motion = |k: usize| kinds[k] == Row::Next && kinds[k - 1] != Row::Bad;
        let is_change = |k: &usize| step(*k) != 0.0 && is_motion(*k) && is_motion(*k + 1);
        for k in (1..t.len().saturating_sub(1)).filter(is_change) {
            let [least, largest] = self.steps.unwrap_or([step(k); 2]);
            self.steps = Some([least.min(step(k)), largest.max(step(k))]);
            let moved = omega[k] * since(k) / quantum;
            let central = 0.5 * (step(k) + step(k + 1));
            self.changes += 1;
            self.deviations[0] += (moved - step(k)).powi(2);
            self.deviations[1] += (moved - central).powi(2);
        }
        let length = skipped(trace.rate_hz).max(1);
        for first in (0..t.len().saturating_sub(length)).step_by(length) {
            let block = first + 1..first + length + 1;
            if !block.clone().all(is_motion) {
                continue;
            }
            let counted: f64 = block.clone().map(step).sum();
            let moved: f64 = (block.clone())
                .map(|k| 0.5 * (omega[k - 1] + omega[k]) * since(k))
                .sum();
            let values = [
                quantum * counted,
                moved,
                omega[first + length] - omega[first],
            ];
            self.blocks += 1;
            for (i, row) in self.sums.iter_mut().enumerate() {
                for (j, sum) in row.iter_mut().enumerate() {
                    *sum += values[i] * values[j];
                }
            }
        }
    }

    /// One line if the velocity is not that of the counts; `None` if it is, or too little of the motion is known.
    #[must_use]
    pub fn line(&self) -> Option<String> {
        let [[dd, dt, dw], [_, tt, tw], [_, _, ww]] = self.sums;
        let quantisation = self.blocks as f64 * self.quantum_rad.powi(2) / 6.0;
        if self.blocks < FEWEST || dd.is_nan() || dd < KNOWN_TO_A_TENTH * quantisation {
            return None;
        }
        let rename = "rename the column for scores against a reference";
        if tt == 0.0 {
            return Some(format!("true_omega is 0, and counts_large moves: {rename}"));
        }
        if let Some(line) = self.difference() {
            return Some(format!("{line}, which has no error against it: {rename}"));
        }
        let correlation = dt / (dd * tt).sqrt();
        if correlation.abs() < CORRELATED {
            return Some(format!(
                "true_omega does not follow counts_large; the correlation of their displacements is {}: it is of \
                 another shaft or of other times; {rename}",
                number(Some(correlation))
            ));
        }
        // Noise of the velocity makes the first of these too small, noise of the counts the second one too large.
        let gains = [dt / tt, dd / dt];
        let is_off = gains.iter().all(|gain| *gain < 1.0 - GAIN)
            || gains.iter().all(|gain| *gain > 1.0 + GAIN);
        if is_off {
            return Some(self.scaled(dt / tt));
        }
        // Of d = gain (t + delay w).
        let determinant = tt * ww - tw * tw;
        let gain = (dt * ww - dw * tw) / determinant;
        let slope = (dw * tt - dt * tw) / determinant;
        let before = dd - 2.0 * dt + tt;
        let after = dd - gain * dt - slope * dw;
        let delay_s = slope / gain;
        let is_late = delay_s.abs() > DELAY * self.period_s && after < EXPLAINED * before;
        is_late.then(|| {
            let side = if delay_s > 0.0 { "behind" } else { "ahead of" };
            format!(
                "true_omega is about {} ms {side} counts_large, and errors and delays contain it: shift the column",
                number(Some(1e3 * delay_s.abs()))
            )
        })
    }

    /// What is said of a velocity that is computed from the counts.
    fn difference(&self) -> Option<&'static str> {
        // Where all rows are the same number of counts apart, as in a computed log, the true velocity is that too.
        let is_even = self.steps.is_none_or(|[least, largest]| least == largest);
        if self.changes < FEWEST || is_even {
            return None;
        }
        let said = [
            "true_omega is the finite difference of counts_large",
            "true_omega is the central difference of counts_large, which is half a period from finite difference",
        ];
        let largest = self.changes as f64 * DIFFERENCE.powi(2);
        let mut found = self.deviations.iter().zip(said);
        found.find_map(|(sum, line)| (*sum < largest).then_some(line))
    }

    /// What is said of a velocity of which that of the counts is `gain` times as large.
    fn scaled(&self, gain: f64) -> String {
        let ratio = gain.recip();
        let units = [
            ("deg/s", 180.0 / PI),
            ("rpm", 30.0 / PI),
            ("rev/s", TAU.recip()),
        ];
        let is_near = |of: f64| (ratio.abs() / of - 1.0).abs() < UNIT;
        let of_unit = units.iter().find_map(|(unit, factor)| {
            if is_near(*factor) {
                Some(format!(
                    "as in {unit}: give the unit, --column true_omega=NAME:{unit}"
                ))
            } else if is_near(factor.recip()) {
                Some(format!("as of a column in rad/s that is read in {unit}"))
            } else {
                None
            }
        });
        let is_reversed = ratio < 0.0;
        let of_size = of_unit.or_else(|| {
            (!is_reversed || (ratio.abs() - 1.0).abs() > GAIN).then(|| {
                let counts = TAU / self.quantum_rad * gain.abs();
                format!(
                    "as with {} counts/rev: check --counts-per-rev and the unit",
                    counts.round()
                )
            })
        });
        let of_sign = is_reversed.then(|| "reverse the sign of one of them".to_owned());
        let remedies: Vec<_> = of_size.into_iter().chain(of_sign).collect();
        format!(
            "true_omega is {} times the velocity of counts_large, {}",
            number(Some(ratio)),
            remedies.join("; ")
        )
    }
}

#[cfg(test)]
mod tests {
    use simulation::trace::Trace;

    use super::*;

    const RATE_HZ: f64 = 1e3;

    /// A swing of 4096 counts/rev and its velocity, which is changed by `truth` from that at a time.
    fn swing(truth: impl Fn(&dyn Fn(f64) -> f64, f64) -> f64) -> Recording {
        let t: Vec<f64> = (0..10_000).map(|k| f64::from(k) / RATE_HZ).collect();
        let angle = |t: f64| 2.0 * (TAU * 0.7 * t).sin() + 0.3 * (TAU * 3.1 * t).sin();
        let omega = |t: f64| TAU * (1.4 * (TAU * 0.7 * t).cos() + 0.93 * (TAU * 3.1 * t).cos());
        let count = |t: &f64| (angle(*t) / TAU * 4096.0).floor() as i64 as u32;
        Recording {
            trace: Trace {
                rate_hz: RATE_HZ,
                counts_large: t.iter().map(count).collect(),
                true_omega: Some(t.iter().map(|t| truth(&omega, *t)).collect()),
                ..Trace::default()
            },
            t,
            ..Recording::default()
        }
    }

    fn line(recording: &Recording, counts_per_rev: u32) -> String {
        let mut truth = TruthCheck::default();
        truth.add(recording, counts_per_rev);
        truth.line().unwrap_or_default()
    }

    #[test]
    fn velocity_of_another_unit_sign_or_time_is_named() {
        for (factor, late_ms, said) in [
            (1.0, 0.0, ""),
            (1.05, 0.0, ""),
            (1.0, 1.5, ""),
            (
                180.0 / PI,
                0.0,
                "57.30 times the velocity of counts_large, as in deg/s: give the unit",
            ),
            (
                30.0 / PI,
                0.0,
                "as in rpm: give the unit, --column true_omega=NAME:rpm",
            ),
            (1.0 / TAU, 0.0, "as in rev/s"),
            (TAU, 0.0, "as of a column in rad/s that is read in rev/s"),
            (
                -1.0,
                0.0,
                "-1.000 times the velocity of counts_large, reverse the sign of one of them",
            ),
            (
                -30.0 / PI,
                0.0,
                "as in rpm: give the unit, --column true_omega=NAME:rpm; reverse the sign",
            ),
            (4.0, 0.0, "as with 1024 counts/rev"),
            (0.905, 0.0, "as with 4526 counts/rev"),
            (1.0, 15.0, "ms behind counts_large"),
            (1.0, -15.0, "ms ahead of counts_large"),
            (0.0, 0.0, "true_omega is 0, and counts_large moves"),
        ] {
            let log = swing(|omega, t| factor * omega(t - 1e-3 * late_ms));
            let line = line(&log, 4096);
            assert_eq!(
                line.is_empty(),
                said.is_empty(),
                "{factor} {late_ms}: {line}"
            );
            assert!(line.contains(said), "{factor} {late_ms}: {line}");
        }
        let log = swing(|_, t| 3.0 * (TAU * 1.9 * t).cos());
        assert!(line(&log, 4096).contains("does not follow counts_large"));
    }

    /// Most of the error is a motion that is added, which no delay explains.
    #[test]
    fn delay_that_explains_little_of_an_error_is_not_said() {
        for (added, said) in [(0.0, true), (3.0, false)] {
            let other = |t: f64| added * (TAU * 1.9 * t).cos();
            let line = line(&swing(|omega, t| omega(t - 5e-3) + other(t)), 4096);
            assert_eq!(line.contains("ms behind counts_large"), said, "{line}");
            assert_eq!(line.is_empty(), !said, "{line}");
        }
    }

    #[test]
    fn velocity_that_is_computed_from_the_counts_is_named() {
        let mut log = swing(|omega, t| omega(t));
        let count = |k: usize| f64::from(log.trace.counts_large[k.min(9999)] as i32);
        let scale = TAU / 4096.0 * RATE_HZ;
        let before: Vec<_> = (0..10_000)
            .map(|k: usize| scale * (count(k) - count(k.saturating_sub(1))))
            .collect();
        let central: Vec<_> = (0..10_000)
            .map(|k: usize| 0.5 * scale * (count(k + 1) - count(k.saturating_sub(1))))
            .collect();
        for (omega, said) in [
            (
                before,
                "is the finite difference of counts_large, which has no error against it",
            ),
            (central, "is the central difference of counts_large"),
        ] {
            log.trace.true_omega = Some(omega);
            let line = line(&log, 4096);
            assert!(line.contains(said), "{line}");
        }
        // Three counts in each row.
        log.trace.counts_large = (0..10_000).map(|k| 3 * k).collect();
        log.trace.true_omega = Some(vec![3.0 * scale; 10_000]);
        assert_eq!(line(&log, 4096), "");
    }

    #[test]
    fn rows_that_are_no_motion_and_rest_say_nothing() {
        let mut log = swing(|omega, t| omega(t));
        log.trace.counts_large[5000..]
            .iter_mut()
            .for_each(|count| *count = count.wrapping_add(1 << 20));
        log.trace.counts_large[3210] ^= 1 << 22;
        log.t[7000..].iter_mut().for_each(|t| *t += 100.0);
        assert_eq!(line(&log, 4096), "");
        // The sections of a long log.
        let mut truth = TruthCheck::default();
        for number in [4000, 10, 6000] {
            truth.add(&log.split_front(number), 1024);
        }
        assert!(truth.line().unwrap().contains("as with 4096 counts/rev"));
        let mut rest = swing(|_, _| 0.0);
        rest.trace.counts_large.fill(7);
        rest.trace.counts_large[5000..].fill(8);
        assert_eq!(line(&rest, 4096), "");
        assert_eq!(line(&Recording::default(), 4096), "");
    }
}
