//! Scenario `step`: open-loop current steps from zero and back to zero, the paper's figure 6.

use super::{Drive, EncoderCounts, Scenario, draw, draw_sign};
use rand_xoshiro::Xoshiro256PlusPlus;

/// Time between steps, s.
const HOLD_S: f64 = 0.25;

pub(super) struct Step {
    period: f64,
    random: Xoshiro256PlusPlus,
    steps: u64,
    current: f64,
}

impl Step {
    pub(super) fn new(period_s: f64, random: Xoshiro256PlusPlus) -> Self {
        Self {
            period: period_s,
            random,
            steps: 0,
            current: 0.0,
        }
    }
}

impl Scenario for Step {
    fn tick(&mut self, k: u64, _: EncoderCounts) -> Drive {
        let due = (k as f64 * self.period / HOLD_S + 1e-9) as u64 + 1;
        while self.steps < due {
            self.steps += 1;
            self.current = match self.steps % 2 {
                0 => 0.0,
                _ => draw_sign(&mut self.random) * draw(&mut self.random, 0.15, 0.9),
            };
        }
        Drive::clamped(self.current, 0.0)
    }
}
