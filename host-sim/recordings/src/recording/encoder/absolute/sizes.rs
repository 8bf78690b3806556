//! Sizes of the steps of a counter: those of one that wraps are small or nearly the modulus.

/// Fewest steps of other sizes. A bad reading makes two.
const FEWEST: u64 = 4;

/// Least ratio of these steps to those that are nearly the modulus. Of a counter that is set to zero at any count, at
/// least as many steps are of other sizes.
const OTHERS: f64 = 0.25;

/// Largest share of these steps in all. A fast shaft turns by more than a quarter of a revolution in more of its rows.
const RARE: f64 = 0.1;

/// Numbers of steps by their size: from each power of two on up to 1.5 times of it, and from there on.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Sizes {
    numbers: [[u64; 2]; 32],
    steps: u64,
}

impl Sizes {
    /// Adds a step.
    pub(super) fn add(&mut self, step: i64) {
        let size = step.unsigned_abs();
        self.steps += 1;
        if let Some(octave) = size.checked_ilog2() {
            let half = 2 * size >= 3 << octave;
            let octave = (octave as usize).min(self.numbers.len() - 1);
            self.numbers[octave][usize::from(half)] += 1;
        }
    }

    /// Whether the large steps are no wraps of a counter of this `modulus`: a shaft that turns by less than a quarter of
    /// it from row to row has no steps from a quarter to three quarters of it.
    pub(super) fn contradict(&self, modulus: i64) -> bool {
        let (from, to) = (0.25 * modulus as f64, 0.75 * modulus as f64);
        let (mut between, mut wraps) = (0, 0);
        for (octave, halves) in self.numbers.iter().enumerate() {
            let begin = (1_u64 << octave) as f64;
            for (number, [least, end]) in halves.iter().zip([[1.0, 1.5], [1.5, 2.0]]) {
                if begin * end > to {
                    wraps += number;
                } else if begin * least >= from {
                    between += number;
                }
            }
        }
        between >= FEWEST
            && between as f64 >= OTHERS * wraps as f64
            && between as f64 <= RARE * self.steps as f64
    }
}
