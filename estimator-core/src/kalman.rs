//! Kalman filter with its full covariance.

use crate::design_error::DesignError;
use crate::estimator::{AccelerationEstimator, VelocityEstimator};
use crate::model::{CurrentInput, Input, Model, NoInput};
use crate::sample::{Sample, Signals};
use crate::units::{Count, CountsPerTick, CountsPerTickSquared};

/// The paper's triple-integrator filter (eqs. 9 to 12).
pub type KalmanTriple = Kalman<3, NoInput>;

/// The paper's realistic filter (eqs. 14 and 16).
pub type KalmanMotor = Kalman<2, CurrentInput<2>>;

/// Largest variance of the process noise in one tick, (512 counts a tick)² for the velocity.
///
/// Above it the update cancels more digits than an f32 has, and P loses its definiteness.
const LARGEST_PROCESS_NOISE: f64 = 262_144.0;

/// Kalman filter over a [`Model`], with its covariance at run time:
/// ```text
/// predict   x = A x + B i          P = A P Aᵀ + Q
/// update    e = y - x_0            S = P_00 + r         K = P_·0 / S
///           x = x + K e            P = P - K P_0·
/// ```
/// x is S × 1, P is S × S and computed as a triangle, so it is symmetric by construction; its
/// first row shrinks by the factor `r / S`, which cannot turn the variance of the position
/// negative. The position is a residual to the newest count, so f32 suffices at any distance.
///
/// Starts wide open (velocity ±32 counts a tick) and settles to the steady gain; once it has,
/// [`SteadyKalman`](crate::SteadyKalman) gives the same for less.
///
/// ```
/// use estimator_core::{Count, Hertz, KalmanTriple, Model, Sample, VelocityEstimator, Kalman, preset};
/// const FILTER: KalmanTriple =
///     preset!(Kalman::new(&preset!(Model::triple_integrator(4096, Hertz(1000.0), 1e4))));
/// let mut state = FILTER.start(&Sample::new(Count(0)));
/// let mut v = 0.0;
/// for tick in 1..200 {
///     v = FILTER.update(&mut state, &Sample::new(Count(7 * tick))).0;
/// }
/// assert!((v - 7.0).abs() < 1e-5);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Kalman<const S: usize, U> {
    a: [[f32; S]; S],
    input: U,
    q: [[f32; S]; S],
    r: f32,
    prior: [f32; S],
}

impl<const S: usize, U: Copy> Kalman<S, U> {
    /// The filter of `model`.
    ///
    /// # Errors
    /// As [`Model::steady_gain`]: a filter that does not settle is refused.
    /// [`DesignError::ProcessNoise`] if a variance of Q is above 2^18.
    pub const fn new(model: &Model<S, U>) -> Result<Self, DesignError> {
        const { assert!(S >= 2, "position and velocity at least") };
        if let Err(error) = model.steady_gain() {
            return Err(error);
        }
        let mut filter = Self {
            a: [[0.0; S]; S],
            input: model.input,
            q: [[0.0; S]; S],
            r: model.r as f32,
            prior: [0.0; S],
        };
        let mut i = 0;
        while i < S {
            if !(model.q[i][i] <= LARGEST_PROCESS_NOISE) {
                return Err(DesignError::ProcessNoise);
            }
            filter.prior[i] = model.prior[i] as f32;
            let mut j = 0;
            while j < S {
                filter.a[i][j] = model.a[i][j] as f32;
                filter.q[i][j] = model.q[i][j] as f32;
                j += 1;
            }
            i += 1;
        }
        Ok(filter)
    }

    /// `A P Aᵀ + Q`, its upper triangle; A is upper triangular.
    // Here and below: a preset's zeros and ones vanish only where they are seen.
    #[inline(always)]
    fn predicted(&self, p: &[[f32; S]; S]) -> [[f32; S]; S] {
        let mut next = self.q;
        for i in 0..S {
            let mut ap = [0.0; S];
            for k in i..S {
                ap[k] = self.a[i][i] * p[i][k];
                for m in i + 1..S {
                    ap[k] += self.a[i][m] * p[m.min(k)][m.max(k)];
                }
            }
            for j in i..S {
                for k in j..S {
                    next[i][j] += ap[k] * self.a[j][k];
                }
            }
        }
        next
    }
}

/// State of a [`Kalman`]: x relative to the newest count, and P.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct KalmanState<const S: usize> {
    anchor: Count,
    x: [f32; S],
    /// Its upper triangle; the rest stays zero.
    p: [[f32; S]; S],
}

impl<const S: usize> KalmanState<S> {
    /// P_11.
    pub(crate) const fn velocity_variance(&self) -> f32 {
        self.p[1][1]
    }

    /// Covariance P of the state, in counts and ticks.
    #[must_use]
    pub const fn covariance(&self) -> [[f32; S]; S] {
        let mut p = self.p;
        let mut i = 0;
        while i < S {
            let mut j = 0;
            while j < i {
                p[i][j] = p[j][i];
                j += 1;
            }
            i += 1;
        }
        p
    }
}

impl<const S: usize, U: Input<S>> VelocityEstimator for Kalman<S, U> {
    type State = KalmanState<S>;
    type Output = CountsPerTick;
    const NEEDS: Signals = U::NEEDS;

    fn start(&self, first: &Sample) -> KalmanState<S> {
        let mut p = [[0.0; S]; S];
        for (i, row) in p.iter_mut().enumerate() {
            row[i] = self.prior[i];
        }
        KalmanState {
            anchor: first.large,
            x: [0.0; S],
            p,
        }
    }

    #[inline(always)]
    fn update(&self, state: &mut KalmanState<S>, sample: &Sample) -> CountsPerTick {
        let mut x = transitioned(&self.a, &state.x);
        self.input.drive(&mut x, sample);
        let mut p = self.predicted(&state.p);

        let innovation = (sample.large - state.anchor).to_f32() - x[0];
        state.anchor = sample.large;
        let inverse = 1.0 / (p[0][0] + self.r);
        let row = p[0];
        for i in 1..S {
            let gain = row[i] * inverse;
            x[i] += gain * innovation;
            for j in i..S {
                p[i][j] -= gain * row[j];
            }
        }
        let shrink = self.r * inverse;
        for i in 0..S {
            p[0][i] = row[i] * shrink;
        }
        // Relative to the new anchor, the corrected position is what the gain left over.
        x[0] = -shrink * innovation;

        state.x = x;
        for i in 0..S {
            for j in i..S {
                state.p[i][j] = p[i][j];
            }
        }
        CountsPerTick(x[1])
    }
}

impl KalmanState<3> {
    /// Acceleration at the latest update.
    #[must_use]
    pub const fn acceleration(&self) -> CountsPerTickSquared {
        CountsPerTickSquared(self.x[2])
    }
}

impl AccelerationEstimator for KalmanTriple {
    fn acceleration(&self, state: &KalmanState<3>) -> CountsPerTickSquared {
        state.acceleration()
    }
}

/// `A x`; A is upper triangular.
#[inline(always)]
pub(crate) fn transitioned<const S: usize>(a: &[[f32; S]; S], x: &[f32; S]) -> [f32; S] {
    let mut next = *x;
    for i in 0..S {
        next[i] = a[i][i] * x[i];
        for j in i + 1..S {
            next[i] += a[i][j] * x[j];
        }
    }
    next
}
