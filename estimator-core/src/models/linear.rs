//! Linear models of the motion, built at compile time from the constants of a motor.

use crate::design::DesignError;
use crate::design::riccati;
use crate::sample::{Sample, Signals};
use crate::sealed::Sealed;

/// Variance of the quantisation error of a count: uniform over one count, 1/12 counts².
pub(crate) const QUANTISATION_VARIANCE: f64 = 1.0 / 12.0;

/// Initial variance of the velocity, (32 counts/tick)²: a moving start settles within a few ticks.
pub(crate) const PRIOR_VELOCITY: f64 = 1024.0;

/// A linear model of the motion measured by one encoder, in counts and ticks:
/// `x_k = A x_{k-1} + B i_{k-1} + w`, `y_k = H x_k + n`, `H = [1 0 ..]`, with covariances Q of w
/// and r = 1/12 of n.
///
/// State `x`: position (counts), velocity (counts per tick), and with `S = 3` acceleration
/// (counts per tick²). A is S × S and upper triangular, Q is S × S and symmetric. `U` is
/// the input: [`NoInput`](crate::NoInput), with the acceleration as a state, or
/// [`CurrentInput`](crate::CurrentInput) with its B, S × 1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Model<const S: usize, U> {
    pub(crate) a: [[f64; S]; S],
    pub(crate) input: U,
    pub(crate) q: [[f64; S]; S],
    pub(crate) r: f64,
    /// Variances of the state before the first sample.
    pub(crate) prior: [f64; S],
}

/// Input of a [`Model`], with the recurrences of its Kalman filter written out: [`NoInput`] or
/// [`CurrentInput`].
///
/// This trait is sealed: only types of this crate implement it.
///
/// [`NoInput`]: crate::NoInput
/// [`CurrentInput`]: crate::CurrentInput
///
/// A state is `[e, v, ..]`: e is the latest innovation and replaces the position, which lies
/// `(1 - k0) e` behind the newest count; v is the velocity; with `S = 3`, half the acceleration.
pub trait Input<const S: usize>: Copy + Sealed {
    /// The parts of a sample that the model reads besides the count.
    const NEEDS: Signals;

    /// One tick of the state: predicts, then corrects by the innovation. `displacement` is that
    /// of the count, in counts; `gain` is `[1 - k0, k1]` or `[1 - k0, k1 - k2/2, k2/2]` with the
    /// k0 of the tick before.
    fn tick(&self, x: &mut [f32; S], displacement: f32, sample: &Sample, gain: &[f32; S]);

    /// One tick of the covariance, from one corrected state to the next: the `gain` that
    /// [`tick`](Input::tick) takes. `p` is a triangle, in the units of
    /// [`covariance`](Input::covariance), and `q` is Q / r.
    fn gain(&self, p: &mut [[f32; S]; S], q: &[[f32; S]; S]) -> [f32; S];

    /// P / r of position, velocity, .. as the triangle that [`gain`](Input::gain) works on: its
    /// first row is the gain K.
    fn triangle(&self, covariance: &[[f32; S]; S], q: &[[f32; S]; S]) -> [[f32; S]; S];

    /// The inverse of [`triangle`](Input::triangle).
    fn covariance(&self, p: &[[f32; S]; S], q: &[[f32; S]; S]) -> [[f32; S]; S];
}

impl<const S: usize, U: Copy> Model<S, U> {
    /// The steady Kalman gain K, S × 1: the limit of eq. 12.
    ///
    /// It is found in f64 by doubling the Riccati recursion (2, 4, 8 .. 2^20 ticks). Two checks
    /// follow: one further tick of the plain recursion does not change the gain, and the powers of the
    /// closed loop `(I - K H) A`, with the gain rounded to f32, converge to zero.
    ///
    /// # Errors
    /// [`DesignError::NOT_CONVERGED`], [`DesignError::NOT_STABLE`].
    pub const fn steady_gain(&self) -> Result<[f32; S], DesignError> {
        match self.steady() {
            Ok(steady) => Ok(steady.gain),
            Err(error) => Err(error),
        }
    }

    /// The steady gain with its variances.
    pub(crate) const fn steady(&self) -> Result<riccati::Steady<S>, DesignError> {
        riccati::steady(&self.a, &self.q, self.r)
    }

    /// Transition matrix A.
    #[must_use]
    pub const fn transition(&self) -> &[[f64; S]; S] {
        &self.a
    }

    /// The input, B.
    #[must_use]
    pub const fn input(&self) -> &U {
        &self.input
    }

    /// Covariance Q of the process noise.
    #[must_use]
    pub const fn process_noise(&self) -> &[[f64; S]; S] {
        &self.q
    }

    /// Variance r of the measurement noise, counts².
    #[must_use]
    pub const fn measurement_noise(&self) -> f64 {
        self.r
    }

    /// Variances of the state, uncorrelated, before the first sample.
    #[must_use]
    pub const fn prior(&self) -> &[f64; S] {
        &self.prior
    }
}

pub(crate) const fn counts_per_rad(counts_per_rev: u32) -> f64 {
    counts_per_rev as f64 / (2.0 * core::f64::consts::PI)
}

/// A gain that was rounded to f32, in f64.
pub(crate) const fn widened<const S: usize>(gain: &[f32; S]) -> [f64; S] {
    let mut wide = [0.0; S];
    let mut i = 0;
    while i < S {
        wide[i] = gain[i] as f64;
        i += 1;
    }
    wide
}

/// K in the form of [`Input::tick`], after a tick with `k0_before`.
pub(crate) const fn as_taken<const S: usize>(k0_before: f64, k: &[f64; S]) -> [f32; S] {
    let mut gain = [0.0; S];
    gain[0] = (1.0 - k0_before) as f32;
    gain[1] = k[1] as f32;
    if S == 3 {
        gain[1] = (k[1] - k[S - 1] / 2.0) as f32;
        gain[S - 1] = (k[S - 1] / 2.0) as f32;
    }
    gain
}
