//! Parameters at the limits of their ranges: a design is stable or refused by name.

use serde::{Deserialize, Serialize};

use crate::course::Course;
use crate::designs::{self, Refusable};
use crate::pair::Pair;

/// Control rates, Hz: periods of 10 µs to 10 ms.
const RATES: [f64; 4] = [1e2, 1e3, 1e4, 1e5];

/// Counts per turn: 16 lines to a million.
const COUNTS_PER_REV: [u32; 4] = [64, 4096, 65_536, 4_000_000];

/// Ticks of the test of each accepted design.
const TICKS: u64 = 4000;

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

/// The largest relative deviation from the twin, unless something breaks.
fn survives(pair: &mut dyn Pair, rate: f64) -> Result<f64, String> {
    let mut course = Course::new(5, rate);
    pair.start(&course.shown());
    let (mut fastest, mut deviation) = (1.0f64, 0.0f64);
    for tick in 0..TICKS {
        if course.is_over() {
            course.move_on();
        }
        let before = course.shown().large;
        let shown = course.step();
        let (narrow, wide) = pair.update(&shown);
        let step = f64::from(shown.large.wrapping_sub(before) as i32);
        fastest = fastest.max(step.abs()).max(wide.abs());
        if !narrow.is_finite() {
            return Err(format!("tick {tick}: {narrow}"));
        }
        if let Some(fault) = pair.fault() {
            return Err(format!("tick {tick}: {fault}"));
        }
        deviation = deviation.max((f64::from(narrow) - wide).abs() / fastest);
    }
    Ok(deviation)
}
