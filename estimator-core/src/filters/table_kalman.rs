//! Kalman filter with a preset table of gains.

use crate::design::DesignError;
use crate::design::riccati;
use crate::estimator::{AccelerationEstimator, VelocityEstimator};
use crate::memory::{Memory, memory};
use crate::models::CurrentInput;
use crate::models::NoInput;
use crate::models::linear::{Input, Model, as_taken, widened};
use crate::sample::{Sample, Signals};
use crate::units::{Count, CountsPerTick, CountsPerTickSquared};

/// [`KalmanTriple`](crate::KalmanTriple) with a table of N gains.
pub type TableKalmanTriple<const N: usize> = TableKalman<3, N, NoInput>;

/// [`KalmanMotor`](crate::KalmanMotor) with a table of N gains.
pub type TableKalmanMotor<const N: usize> = TableKalman<2, N, CurrentInput>;

/// Largest relative difference between the last gain of a table and the steady gain.
const SETTLED: f64 = 1e-6;

/// Kalman filter over a [`Model`] with the gains of the full recursion after a start:
/// `x = A x + B i`, then `x = x + K_k (y - x_0)`, with K_k from a table for the first N ticks and
/// the steady gain from then on.
///
/// The covariance does not depend on the measurements (eqs. 10 to 12), so the gains are known at
/// compile time. They are computed in f64; the velocity is that of [`Kalman`](crate::Kalman) but for
/// the rounding of its covariance. N is at least the number of ticks until the gain is within 1e-6
/// of its limit: for the triple integrator with 4096 counts 37 at 1 kHz and 1000 rad/s³/√Hz,
/// 167 at 10 kHz and 3650 rad/s³/√Hz. The table takes 4 (S + 1) N bytes of flash.
///
/// ```
/// use estimator_core::*;
/// const MODEL: Model<3, NoInput> =
///     preset!(Model::triple_integrator(4096, Hertz(1000.0), 1e4));
/// const FULL: KalmanTriple = preset!(Kalman::new(&MODEL));
/// const TABLE: TableKalmanTriple<40> = preset!(TableKalman::new(&MODEL));
/// let first = Sample::new(Count(0));
/// let (mut full, mut table) = (FULL.start(&first), TABLE.start(&first));
/// for tick in 1..200 {
///     let sample = Sample::new(Count(7 * tick));
///     let v = TABLE.update(&mut table, &sample).0;
///     assert!((v - FULL.update(&mut full, &sample).0).abs() < 1e-4);
/// }
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(C)]
pub struct TableKalman<const S: usize, const N: usize, U> {
    input: U,
    /// The first ticks.
    table: [Row<S>; N],
    /// All later ticks.
    steady: Row<S>,
}

memory!([const S: usize, const N: usize, U: Memory] TableKalman<S, N, U> { input, table, steady });

/// One tick of a [`TableKalman`].
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(C)]
struct Row<const S: usize> {
    /// K in the form of [`Input::tick`].
    gain: [f32; S],
    /// P_11 before the tick.
    velocity_variance: f32,
}

memory!([const S: usize] Row<S> { gain, velocity_variance });

impl<const S: usize, const N: usize, U: Copy> TableKalman<S, N, U> {
    /// The filter over `model` with the gains of its first N ticks.
    ///
    /// # Errors
    /// The errors of [`Model::steady_gain`]. [`DesignError::TABLE`] if the gain is not within 1e-6 of the
    /// steady gain at the N-th tick.
    pub const fn new(model: &Model<S, U>) -> Result<Self, DesignError> {
        let limit = match model.steady() {
            Ok(limit) => limit,
            Err(error) => return Err(error),
        };
        let steady = widened(&limit.gain);
        let (gains, variances): (_, [_; N]) =
            riccati::first_gains(&model.a, &model.q, model.r, &model.prior);
        let settled = Row {
            gain: as_taken(steady[0], &steady),
            velocity_variance: limit.velocity[1] as f32,
        };
        let mut table = [settled; N];
        // The first tick has no previous innovation.
        let mut last = [1.0; S];
        let mut tick = 0;
        while tick < N {
            table[tick] = Row {
                gain: as_taken(last[0], &gains[tick]),
                velocity_variance: variances[tick] as f32,
            };
            last = gains[tick];
            tick += 1;
        }
        let mut i = 0;
        while i < S {
            if !((last[i] - steady[i]).abs() <= SETTLED * steady[i].abs()) {
                return Err(DesignError::TABLE);
            }
            i += 1;
        }
        Ok(Self {
            input: model.input,
            table,
            steady: settled,
        })
    }

    /// P_11 of the state.
    pub(crate) fn velocity_variance(&self, state: &TableKalmanState<S>) -> f32 {
        let row = self.table.get(state.tick as usize).unwrap_or(&self.steady);
        row.velocity_variance
    }
}

/// State of a [`TableKalman`]: x relative to the newest count, and the index into the table.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TableKalmanState<const S: usize> {
    anchor: Count,
    /// Ticks since the start, at most N. It follows the anchor, so that one instruction reads both
    /// and one writes both.
    tick: u32,
    /// The state of [`Input::tick`].
    x: [f32; S],
}

impl<const S: usize, const N: usize, U: Input<S>> VelocityEstimator for TableKalman<S, N, U> {
    type State = TableKalmanState<S>;
    const NEEDS: Signals = U::NEEDS;

    fn start(&self, first: &Sample) -> TableKalmanState<S> {
        TableKalmanState {
            anchor: first.count,
            tick: 0,
            x: [0.0; S],
        }
    }

    #[inline(always)]
    fn update(&self, state: &mut TableKalmanState<S>, sample: &Sample) -> CountsPerTick {
        let displacement = (sample.count - state.anchor).to_f32();
        let mut step = |row: &Row<S>| {
            self.input
                .tick(&mut state.x, displacement, sample, &row.gain);
        };
        // Each arm has its own step, so that the steady gain is an immediate operand.
        let tick = match self.table.get(state.tick as usize) {
            Some(row) => {
                step(row);
                state.tick + 1
            }
            None => {
                step(&self.steady);
                state.tick
            }
        };
        state.anchor = sample.count;
        state.tick = tick;
        CountsPerTick(state.x[1])
    }
}

impl<const N: usize> AccelerationEstimator for TableKalmanTriple<N> {
    fn acceleration(&self, state: &TableKalmanState<3>) -> CountsPerTickSquared {
        CountsPerTickSquared(2.0 * state.x[2])
    }
}
