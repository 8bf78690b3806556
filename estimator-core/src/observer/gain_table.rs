//! Steady gains by the time between corrections, computed at compile time.

use super::gain::Gain;
use super::uncertainty::Noise;
use crate::branch::unlikely;
use crate::design::DesignError;
use crate::design::const_math::{exp, phi1, phi2};
use crate::design::matrix::{Matrix, product};
use crate::design::riccati;
use crate::memory::memory;

/// Number of gaps that have a row each.
const EACH: usize = 64;

/// Number of longer gaps that share a row.
const STEP: usize = 32;

/// Rows of the table: gaps up to 961 ticks; a longer gap takes the last row.
pub(super) const ROWS: usize = EACH + 29;

/// Row of a gap of `more + 1` ticks: the row of the longest gap that is not longer.
#[inline(always)]
fn row_after(more: usize) -> usize {
    let shared = EACH - EACH / STEP + more / STEP;
    let row = if more < EACH { more } else { shared };
    row.min(ROWS - 1)
}

/// Steady gain and variance by the gap between corrections. Row n is the steady state of the filter
/// that is corrected once every n ticks.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(C)]
pub(super) struct GainTable {
    gains: [Gain; ROWS],
    /// Variance of the velocity before the correction, (counts/tick)². The rows of the gains are a
    /// power of two long without it.
    velocity_variances: [f32; ROWS],
}

memory!(GainTable {
    gains,
    velocity_variances
});

/// Transition and process noise of position, velocity and disturbance over one tick.
#[rustfmt::skip]
pub(super) const fn one_tick(beta: f64, noise: &Noise) -> (Matrix, Matrix) {
    let white = noise.white;
    (
        [
            1.0, phi1(beta), phi2(beta),
            0.0, exp(-beta), phi1(beta),
            0.0, 0.0, noise.decay,
        ],
        [
            white / 3.0, white / 2.0, 0.0,
            white / 2.0, white, 0.0,
            0.0, 0.0, noise.disturbance,
        ],
    )
}

impl GainTable {
    /// The table of a motor with `beta = b T / J`, for `noise`.
    ///
    /// # Errors
    /// As [`Model::steady_gain`](crate::Model::steady_gain), for any row.
    pub(super) const fn new(beta: f64, noise: &Noise) -> Result<Self, DesignError> {
        let (a, q) = one_tick(beta, noise);
        let r = noise.boundary * noise.boundary;
        let none = Gain {
            position: 0.0,
            velocity: 0.0,
            disturbance: 0.0,
            variance: 0.0,
        };
        let mut table = Self {
            gains: [none; ROWS],
            velocity_variances: [0.0; ROWS],
        };
        let (mut a_n, mut q_n) = (a, q);
        let (mut row, mut ticks) = (0, 1);
        while row < ROWS {
            let steady = match riccati::steady_of_three(&a_n, &q_n, r) {
                Ok(steady) => steady,
                Err(error) => return Err(error),
            };
            table.gains[row] = Gain {
                position: steady.gain[0],
                velocity: steady.gain[1],
                disturbance: steady.gain[2],
                variance: steady.innovation as f32,
            };
            table.velocity_variances[row] = steady.velocity[0] as f32;
            row += 1;
            let next = if row < EACH {
                row + 1
            } else {
                EACH + 1 + (row - EACH) * STEP
            };
            while ticks < next {
                q_n = riccati::later_noise(&a, &q, &q_n);
                a_n = product(&a, &a_n);
                ticks += 1;
            }
        }
        Ok(table)
    }

    /// The gain after a gap of `gap` ticks.
    #[inline(always)]
    pub(super) fn gain(&self, gap: f32) -> &Gain {
        // A float-to-integer cast saturates.
        let more = (gap - 0.5) as usize;
        if more < EACH {
            &self.gains[more]
        } else {
            unlikely();
            &self.gains[row_after(more)]
        }
    }

    /// Variance of the velocity after a gap of `gap` ticks, (counts/tick)².
    pub(super) fn velocity_variance(&self, gap: f32) -> f32 {
        self.velocity_variances[row_after((gap - 1.0) as usize)]
    }
}

#[cfg(test)]
mod tests {
    use super::{GainTable, Noise, one_tick, product, riccati};

    #[test]
    fn gap_selects_the_longest_row_that_is_not_longer() {
        let noise = Noise {
            white: 1e-6,
            load: 1e-3,
            disturbance: 1e-8,
            decay: 0.99,
            boundary: 0.0625,
        };
        let table = GainTable::new(1e-3, &noise).expect("valid");
        let (a, q) = one_tick(1e-3, &noise);
        for (gaps, row) in [
            ([1.0, 0.2], 1),
            ([64.0, 63.6], 64),
            ([65.0, 96.4], 65),
            ([97.0, 128.0], 97),
            ([961.0, 1e9], 961),
        ] {
            let (mut a_n, mut q_n) = (a, q);
            for _ in 1..row {
                q_n = riccati::later_noise(&a, &q, &q_n);
                a_n = product(&a, &a_n);
            }
            let steady = riccati::steady_of_three(&a_n, &q_n, 0.0625 * 0.0625).expect("settles");
            for gap in gaps {
                assert_eq!(table.gain(gap).velocity, steady.gain[1], "{gap}");
            }
            assert_eq!(table.velocity_variance(gaps[0]), steady.velocity[0] as f32);
        }
    }
}
