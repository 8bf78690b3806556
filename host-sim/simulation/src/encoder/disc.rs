//! Errors of an encoder's disc.

use crate::device::Disc;
use crate::scenario::draw;
use rand_xoshiro::{Xoshiro256PlusPlus, rand_core::SeedableRng};
use std::f64::consts::TAU;

/// Offset of every boundary, counts; empty for an ideal disc.
#[derive(Clone, Debug, Default)]
pub struct DiscErrors(Vec<f64>);

impl DiscErrors {
    /// An ideal disc.
    #[must_use]
    pub const fn none() -> Self {
        Self(Vec::new())
    }

    /// A disc with errors of these sizes, drawn from `seed`.
    ///
    /// Four phase errors of mean zero, the largest exactly `phase_counts`, repeat with
    /// `e mod 4`; a sine of amplitude `line_counts` and seeded phase repeats once a turn; each
    /// boundary adds an error uniform within `random_counts`.
    #[must_use]
    pub fn new(errors: &Disc, counts_per_rev: u32, seed: u64) -> Self {
        if *errors == Disc::default() {
            return Self::none();
        }
        let mut random = Xoshiro256PlusPlus::seed_from_u64(seed);
        let mut phases = [0.0; 4].map(|_: f64| draw(&mut random, -1.0, 1.0));
        let mean = phases.iter().sum::<f64>() / 4.0;
        let largest = phases.iter().fold(0.0_f64, |a, p| a.max((p - mean).abs()));
        for phase in &mut phases {
            *phase = (*phase - mean) * errors.phase_counts / largest;
        }
        let turn = draw(&mut random, 0.0, TAU);
        let error = |e: u32| {
            phases[e as usize % 4]
                + errors.line_counts * (turn + TAU * f64::from(e) / f64::from(counts_per_rev)).sin()
                + errors.random_counts * draw(&mut random, -1.0, 1.0)
        };
        Self((0..counts_per_rev).map(error).collect())
    }

    /// Offset of boundary `e`, counts.
    #[inline]
    #[must_use]
    pub fn error(&self, e: i64) -> f64 {
        if self.0.is_empty() {
            return 0.0;
        }
        self.0[e.rem_euclid(self.0.len() as i64) as usize]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn parts(phase_counts: f64, line_counts: f64, random_counts: f64) -> Vec<f64> {
        let errors = Disc {
            phase_counts,
            line_counts,
            random_counts,
        };
        DiscErrors::new(&errors, 4096, 3).0
    }

    fn largest(errors: &[f64]) -> f64 {
        errors.iter().fold(0.0, |a: f64, e| a.max(e.abs()))
    }

    #[test]
    fn disc_errors_have_their_amplitude_and_period() {
        let phase = parts(0.2, 0.0, 0.0);
        assert!((largest(&phase) - 0.2).abs() < 1e-12);
        assert!(phase[..4].iter().sum::<f64>().abs() < 1e-12);
        assert!(phase.iter().zip(&phase[4..]).all(|(a, b)| a == b));

        let line = parts(0.0, 0.3, 0.0);
        assert!((largest(&line) - 0.3).abs() < 1e-6);
        assert!((line[100] + line[100 + 2048]).abs() < 1e-9);

        let random = parts(0.0, 0.0, 0.1);
        assert!(largest(&random) <= 0.1 && largest(&random) > 0.099);
        let mean = random.iter().sum::<f64>() / 4096.0;
        assert!(mean.abs() < 0.005, "{mean}");
    }

    #[test]
    fn disc_is_a_function_of_the_seed() {
        assert_eq!(parts(0.1, 0.1, 0.1), parts(0.1, 0.1, 0.1));
        for sizes in [[0.1, 0.0, 0.0], [0.0, 0.1, 0.0], [0.0, 0.0, 0.1]] {
            let [phase_counts, line_counts, random_counts] = sizes;
            let errors = Disc {
                phase_counts,
                line_counts,
                random_counts,
            };
            let of_seed = |seed| DiscErrors::new(&errors, 4096, seed).0;
            assert_ne!(of_seed(1), of_seed(2), "{sizes:?}");
        }
    }

    #[test]
    fn boundaries_below_the_first_one_are_those_of_the_turn_before() {
        let disc = DiscErrors(vec![0.1, 0.2, 0.3]);
        let errors = [-4, -3, -2, -1, 0, 1, 2, 3].map(|e| disc.error(e));
        assert_eq!(errors, [0.3, 0.1, 0.2, 0.3, 0.1, 0.2, 0.3, 0.1]);
    }
}
