//! The variance of an estimate, according to its own model.

use crate::estimator::VelocityEstimator;
use crate::filters::{
    FiniteDifference, Fit, Foaw, FoawState, Kalman, KalmanState, LateCurrent, LateCurrentState,
    SteadyKalman, SteadyKalmanState, TableKalman, TableKalmanState,
};
use crate::models::Input;
use crate::observer::{Adaptation, Correction, CurrentSource, Observer, ObserverState, SlipSource};
use crate::units::{Count, CountsPerTick};

/// An estimator that gives the variance of its latest velocity.
///
/// | estimator | variance, (counts/tick)² |
/// |---|---|
/// | finite difference | 1: one count/tick |
/// | FOAW | 1 / n²: one count over the window of n intervals |
/// | Kalman | P_11 of its covariance |
/// | Kalman, table | P_11 after the same number of ticks, computed at compile time |
/// | Kalman, steady | P_11 of the limit, computed at compile time |
/// | observer | n ticks after the last correction, P_11 before a correction of the filter that is corrected every n ticks |
/// | bank | variance of the mixture of its members, `Σ w_i (P_11,i + (v_i - v)²)` |
/// | driven bank | variance of the mixture of the bank and the driven bank |
/// | late current | that of the filter that gets the current a tick late |
/// | handover | the larger of the two while both run |
///
/// The variance covers the errors that the model contains, and no others: with friction that the
/// model lacks, the error is larger than the variance says.
///
/// ```
/// use estimator_core::*;
/// const FOAW: Foaw<16, EndFit> = preset!(Foaw::new(16, 1));
/// let mut state = FOAW.start(&Sample::new(Count(0)));
/// for tick in 1..=20 {
///     FOAW.update(&mut state, &Sample::new(Count(tick)));
/// }
/// // A full window: 1/16 count/tick.
/// assert_eq!(FOAW.variance(&state).std_dev(), CountsPerTick(0.0625));
/// ```
pub trait Confidence: VelocityEstimator {
    /// Variance of the latest velocity.
    fn variance(&self, state: &Self::State) -> Variance;
}

/// Variance of a velocity, (counts/tick)².
#[derive(Clone, Copy, Debug, Default, PartialEq, PartialOrd)]
pub struct Variance(pub f32);

impl Variance {
    /// The standard deviation, correct to the last digit; 0 unless the variance is positive.
    ///
    /// Newton's iteration, which falls monotonically to the root after its first step. It begins at half the
    /// exponent, within 7 % of the root of a normal number, and takes at most four divisions there; call it
    /// outside the control interrupt.
    #[must_use]
    pub fn std_dev(self) -> CountsPerTick {
        let Self(x) = self;
        if !(x > 0.0) {
            return CountsPerTick(0.0);
        }
        let one: f32 = 1.0;
        let near = f32::from_bits((x.to_bits() >> 1) + (one.to_bits() >> 1));
        let mut root = 0.5 * (near + x / near);
        for _ in 0..100 {
            let next = 0.5 * (root + x / root);
            if !(next < root) {
                break;
            }
            root = next;
        }
        CountsPerTick(root)
    }
}

impl Confidence for FiniteDifference {
    fn variance(&self, _: &Count) -> Variance {
        Variance(1.0)
    }
}

impl<const N: usize, F: Fit> Confidence for Foaw<N, F> {
    fn variance(&self, state: &FoawState<N, F>) -> Variance {
        let window = state.window().max(1) as f32;
        Variance(1.0 / (window * window))
    }
}

impl<const S: usize, U: Input<S>> Confidence for Kalman<S, U> {
    fn variance(&self, state: &KalmanState<S>) -> Variance {
        Variance(self.covariance(state)[1][1])
    }
}

impl<const S: usize, const N: usize, U: Input<S>> Confidence for TableKalman<S, N, U> {
    fn variance(&self, state: &TableKalmanState<S>) -> Variance {
        Variance(self.velocity_variance(state))
    }
}

impl<const S: usize, U: Input<S>> Confidence for SteadyKalman<S, U> {
    fn variance(&self, _: &SteadyKalmanState<S>) -> Variance {
        Variance(self.velocity_variance())
    }
}

impl<E: Confidence> Confidence for LateCurrent<E> {
    fn variance(&self, state: &LateCurrentState<E::State>) -> Variance {
        self.0.variance(state.inner())
    }
}

impl<C, S, M, L> Confidence for Observer<C, S, M, L>
where
    C: CurrentSource,
    S: SlipSource,
    M: Correction,
    L: Adaptation,
{
    fn variance(&self, state: &ObserverState<C::State, S::State, M::State, L::State>) -> Variance {
        Variance(self.velocity_variance(state))
    }
}

#[cfg(test)]
mod tests {
    extern crate std;
    use super::Variance;

    #[test]
    fn std_dev_is_the_square_root() {
        for x in [1e-45, 1e-38, 1e-12, 0.25, 1.0, 2.0, 9.0, 1e6, f32::MAX] {
            let (root, exact) = (Variance(x).std_dev().0, x.sqrt());
            assert!(
                (root - exact).abs() <= 1.2e-7 * exact,
                "{x}: {root}, {exact}"
            );
        }
        for x in [0.0, -1.0, f32::NAN] {
            assert_eq!(Variance(x).std_dev().0, 0.0);
        }
    }
}
