//! A wrapper that delays the current by one tick.

use crate::estimator::VelocityEstimator;
use crate::sample::{Sample, Signals};
use crate::units::{Amps, CountsPerTick};

/// An estimator that receives the current one tick late.
///
/// Eqs. 15 and 16 of the paper differ by one tick in the effect of a current. Eq. 16 is correct and is
/// that of [`Model::motor`](crate::Model::motor); with this wrapper it becomes eq. 15, for
/// comparison.
///
/// ```
/// use estimator_core::*;
/// const MOTOR: KalmanMotor = preset!(Kalman::new(&preset!(Model::motor(
///     &MotorModel::DCX35L, Hertz(1000.0), 0.1
/// ))));
/// const LITERAL: LateCurrent<KalmanMotor> = LateCurrent(MOTOR);
/// let first = Sample::new(Count(0));
/// let driven = first.with_current(Amps::new(1.0));
/// assert!(MOTOR.update(&mut MOTOR.start(&first), &driven).0 > 0.0);
/// assert_eq!(LITERAL.update(&mut LITERAL.start(&first), &driven).0, 0.0); // not yet
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LateCurrent<E>(pub E);

/// State of a [`LateCurrent`]: the delayed current and the inner state.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LateCurrentState<S> {
    withheld: Amps,
    inner: S,
}

impl<S> LateCurrentState<S> {
    pub(crate) const fn inner(&self) -> &S {
        &self.inner
    }
}

impl<E: VelocityEstimator> VelocityEstimator for LateCurrent<E> {
    type State = LateCurrentState<E::State>;
    const NEEDS: Signals = E::NEEDS;

    fn start(&self, first: &Sample) -> Self::State {
        LateCurrentState {
            withheld: first.current,
            inner: self.0.start(first),
        }
    }

    #[inline(always)]
    fn update(&self, state: &mut Self::State, sample: &Sample) -> CountsPerTick {
        let late = sample.with_current(state.withheld);
        state.withheld = sample.current;
        self.0.update(&mut state.inner, &late)
    }
}
