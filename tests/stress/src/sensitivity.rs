//! Parameters at the limits of their ranges: a design is stable or refused by name.

use serde::{Deserialize, Serialize};

use crate::course::Course;
use crate::designs::{self, Refusable};
use crate::pair::Pair;

/// Control rates, Hz: periods of 10 µs to 10 ms.
const RATES: [f64; 4] = [1e2, 1e3, 1e4, 1e5];

/// Counts per turn: 16 lines to a million.
const COUNTS_PER_REV: [u32; 4] = [64, 4096, 65_536, 4_000_000];

/// Seeds of the courses of each accepted design. Together the courses have every kind of [`Stretch`] and
/// a wrap of the 32-bit count. The estimator starts anew on each: after random counts, of up to 2^31 in a
/// tick, no deviation is large beside the fastest velocity.
const SEEDS: [u64; 8] = [1, 2, 3, 4, 5, 6, 7, 8];

/// Stretches of each course.
const STRETCHES: u32 = 10;

/// Ticks of each stretch.
const TICKS: u32 = 100;

/// Results of one kind of estimator over the whole grid.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub struct Outcome {
    /// Name.
    pub estimator: String,
    /// Number of designs.
    pub tried: u32,
    /// Numbers of refused designs by the parameter that the error names.
    pub refused: std::collections::BTreeMap<String, u32>,
    /// Largest |f32 - f64| of an accepted design, relative to the largest velocity.
    #[serde(with = "shards::exact")]
    pub relative_deviation: f64,
    /// Failures of accepted designs, with their parameters.
    pub broken: Vec<String>,
}

/// Every kind of estimator with parameters, over the whole grid.
#[must_use]
pub fn all() -> Vec<Outcome> {
    designs::kinds().into_iter().map(outcome).collect()
}

/// One kind of estimator over the whole grid.
#[must_use]
pub fn outcome(kind: &str) -> Outcome {
    let mut outcome = Outcome {
        estimator: kind.to_owned(),
        ..Outcome::default()
    };
    for rate in RATES {
        for counts_per_rev in COUNTS_PER_REV {
            for parameter in designs::parameters(kind, rate) {
                let design = designs::design(kind, rate, counts_per_rev, parameter);
                let what = format!("{rate} Hz, {counts_per_rev} counts, {parameter:e}");
                outcome.take(design, rate, &what);
            }
        }
    }
    outcome
}

impl Outcome {
    fn take(&mut self, design: Refusable, rate: f64, what: &str) {
        self.tried += 1;
        match design {
            Err(error) => *self.refused.entry(error).or_default() += 1,
            Ok(mut pair) => match survives(&mut *pair, rate) {
                Ok(deviation) => self.relative_deviation = self.relative_deviation.max(deviation),
                Err(fault) => self.broken.push(format!("{what}: {fault}")),
            },
        }
    }
}

/// The largest relative deviation from the twin over the courses, unless something breaks.
fn survives(pair: &mut dyn Pair, rate: f64) -> Result<f64, String> {
    let deviations = SEEDS.map(|seed| survives_course(pair, seed, rate));
    deviations
        .into_iter()
        .try_fold(0.0, |most: f64, deviation| Ok(most.max(deviation?)))
}

/// The largest relative deviation from the twin over the course of a seed, unless something breaks.
fn survives_course(pair: &mut dyn Pair, seed: u64, rate: f64) -> Result<f64, String> {
    let mut course = Course::new(seed, rate);
    pair.start(&course.shown());
    let (mut fastest, mut deviation) = (1.0f64, 0.0f64);
    for _ in 0..STRETCHES {
        let stretch = course.move_on_for(TICKS);
        for tick in 0..TICKS {
            let broken = |fault: &str| format!("seed {seed}, {stretch:?}, tick {tick}: {fault}");
            let before = course.shown().large;
            let shown = course.step();
            let (narrow, wide) = pair.update(&shown);
            let step = f64::from(shown.large.wrapping_sub(before) as i32);
            fastest = fastest.max(step.abs()).max(wide.abs());
            if !narrow.is_finite() {
                return Err(broken(&narrow.to_string()));
            }
            if let Some(fault) = pair.fault() {
                return Err(broken(fault));
            }
            deviation = deviation.max((f64::from(narrow) - wide).abs() / fastest);
        }
    }
    Ok(deviation)
}

#[cfg(test)]
mod tests {
    use std::collections::HashSet;
    use std::mem::discriminant;

    use super::*;
    use crate::course::Stretch;

    #[test]
    fn courses_have_every_kind_of_stretch_and_a_wrap() {
        let every = [
            Stretch::Rest,
            Stretch::Top(1),
            Stretch::Slope(1.0),
            Stretch::Creep(64, 1),
            Stretch::Chatter,
            Stretch::Walk(1),
            Stretch::Sine(1.0, 1.0),
            Stretch::Noise,
        ];
        for rate in RATES {
            let (mut kinds, mut wraps) = (HashSet::new(), 0);
            for seed in SEEDS {
                let mut course = Course::new(seed, rate);
                for _ in 0..STRETCHES {
                    let stretch = course.move_on_for(TICKS);
                    kinds.insert(discriminant(&stretch));
                    for _ in 0..TICKS {
                        let before = course.shown().large;
                        let step = course.step().large.wrapping_sub(before) as i32;
                        let is_wrap = before.checked_add_signed(step).is_none();
                        wraps += u32::from(is_wrap && stretch != Stretch::Noise);
                    }
                }
            }
            assert_eq!(kinds, every.iter().map(discriminant).collect());
            assert!(wraps > 0);
        }
    }
}
