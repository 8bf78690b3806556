//! What estimators believe of their own error.

use crate::estimator::VelocityEstimator;
use crate::finite_difference::FiniteDifference;
use crate::foaw::{Fit, Foaw, FoawState};
use crate::kalman::{Kalman, KalmanState};
use crate::late_current::{LateCurrent, LateCurrentState};
use crate::model::Input;
use crate::observer::{Correction, CurrentSource, Learning, Observer, ObserverState, SlipSource};
use crate::steady_kalman::{SteadyKalman, SteadyKalmanState};
use crate::table_kalman::{TableKalman, TableKalmanState};
use crate::units::{Count, CountsPerTick};

/// An estimator that says how far off its latest velocity may be.
///
/// | estimator | variance, (counts a tick)² |
/// |---|---|
/// | finite difference | 1: one count a tick |
/// | FOAW | 1 / n²: one count over the window of n intervals |
/// | Kalman | P_11 of the covariance it runs with |
/// | Kalman, table | P_11 after as many ticks, computed at compile time |
/// | Kalman, steady | P_11 of the limit, computed at compile time |
/// | observer | that of the filter corrected every n ticks before its correction, n ticks after the last |
/// | handover | the larger of the two while both run |
///
/// It is what the model says, no more: a motor with friction that the model lacks errs by more
/// than its filter believes. `host-sim compare` counts how often the truth lies within two standard
/// deviations.
///
/// ```
/// use estimator_core::*;
/// const FOAW: Foaw<16, EndFit> = preset!(Foaw::new(16, 1));
/// let mut state = FOAW.start(&Sample::new(Count(0)));
/// for tick in 1..=20 {
///     FOAW.update(&mut state, &Sample::new(Count(tick)));
/// }
/// // A full window: a sixteenth of a count a tick.
/// assert_eq!(FOAW.variance(&state).deviation(), CountsPerTick(0.0625));
/// ```
pub trait Confidence: VelocityEstimator {
    /// Variance of the latest velocity.
    fn variance(&self, state: &Self::State) -> Variance;
}

/// Variance of a velocity, (counts a tick)².
#[derive(Clone, Copy, Debug, Default, PartialEq, PartialOrd)]
pub struct Variance(pub f32);

impl Variance {
    /// The standard deviation, to the last digit; 0 unless the variance is positive.
    ///
    /// Newton's iteration from above, which falls until it is there: f32 and no library. Takes up
    /// to 80 divisions, so it is for whoever has time.
    #[must_use]
    pub fn deviation(self) -> CountsPerTick {
        let Self(x) = self;
        if !(x > 0.0) {
            return CountsPerTick(0.0);
        }
        let mut root = if x > 1.0 { x } else { 1.0 };
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
    fn variance(&self, state: &FoawState<N>) -> Variance {
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
    L: Learning,
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
    fn the_root_is_the_librarys() {
        for x in [1e-45, 1e-38, 1e-12, 0.25, 1.0, 2.0, 9.0, 1e6, f32::MAX] {
            let (root, exact) = (Variance(x).deviation().0, x.sqrt());
            assert!(
                (root - exact).abs() <= 1.2e-7 * exact,
                "{x}: {root}, {exact}"
            );
        }
        for x in [0.0, -1.0, f32::NAN] {
            assert_eq!(Variance(x).deviation().0, 0.0);
        }
    }
}
