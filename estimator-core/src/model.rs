//! Linear models of the motion, built at compile time from a device description.

use crate::design_error::DesignError;
use crate::riccati;
use crate::sample::{Sample, Signals};

/// Variance of the quantisation error of a count: uniform over one count, 1/12 counts².
pub(crate) const QUANTISATION_VARIANCE: f64 = 1.0 / 12.0;

/// (32 counts per tick)²: a start in motion is caught within a few ticks.
pub(crate) const PRIOR_VELOCITY: f64 = 1024.0;

/// A linear model of the motion seen through one encoder, in counts and ticks:
/// `x_k = A x_{k-1} + B i_{k-1} + w`, `y_k = H x_k + n`, `H = [1 0 ..]`, with covariances Q of w
/// and r = 1/12 of n.
///
/// State `x`: position (counts), velocity (counts per tick), and with `S = 3` acceleration
/// (counts per tick²). A is S × S and upper triangular, Q is S × S and symmetric. `U` says
/// what drives it: [`NoInput`](crate::NoInput), so that the acceleration is a state, or
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

/// What drives a [`Model`], and what follows from it: the filter's recurrences, written out.
///
/// A state is `[e, v, ..]`: e is the latest innovation and stands for the position, which lies
/// `(1 - k0) e` behind the newest count; v the velocity; with `S = 3`, half the acceleration.
pub trait Input<const S: usize>: Copy {
    /// What it reads of a sample.
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
    /// The limit K, S × 1, of the Kalman gain (eq. 12) as the recursion runs on.
    ///
    /// Found in f64 by doubling the Riccati recursion (2, 4, 8 .. 2^20 ticks), then checked: one
    /// further tick of the plain recursion leaves the gain in place, and powers of the closed
    /// loop `(I - K H) A`, with the gain rounded as it will run, shrink.
    ///
    /// # Errors
    /// [`DesignError::NOT_CONVERGED`], [`DesignError::NOT_STABLE`].
    pub const fn steady_gain(&self) -> Result<[f32; S], DesignError> {
        riccati::steady_gain(&self.a, &self.q, self.r)
    }

    /// The same limit with its variances.
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

/// A gain as it was rounded, in f64.
pub(crate) const fn widened<const S: usize>(gain: &[f32; S]) -> [f64; S] {
    let mut wide = [0.0; S];
    let mut i = 0;
    while i < S {
        wide[i] = gain[i] as f64;
        i += 1;
    }
    wide
}

/// K as [`Input::tick`] takes it, after a tick with `k0_before`.
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
