//! Eq. 15 taken literally.

use crate::estimator::VelocityEstimator;
use crate::sample::{Sample, Signals};
use crate::units::Amps;

/// Shows another estimator the current one tick late.
///
/// Eqs. 15 and 16 of the paper differ by one sample in when a current acts. Eq. 16 is right and
/// is what [`Model::motor`](crate::Model::motor) does; this wrapper makes it eq. 15, literally,
/// for comparison.
///
/// ```
/// use estimator_core::*;
/// const MOTOR: KalmanMotor = preset!(Kalman::new(&preset!(Model::motor(
///     &Device::DCX35L, Hertz(1000.0), 0.1
/// ))));
/// const LITERAL: LateCurrent<KalmanMotor> = LateCurrent(MOTOR);
/// let first = Sample::new(Count(0));
/// let pushed = first.with_current(Amps::new(1.0));
/// assert!(MOTOR.update(&mut MOTOR.start(&first), &pushed).0 > 0.0);
/// assert_eq!(LITERAL.update(&mut LITERAL.start(&first), &pushed).0, 0.0); // not yet
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LateCurrent<E>(pub E);

/// State of a [`LateCurrent`]: the current withheld and the inner state.
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
    type Output = E::Output;
    const NEEDS: Signals = E::NEEDS;

    fn start(&self, first: &Sample) -> Self::State {
        LateCurrentState {
            withheld: first.current,
            inner: self.0.start(first),
        }
    }

    #[inline(always)]
    fn update(&self, state: &mut Self::State, sample: &Sample) -> E::Output {
        let late = sample.with_current(state.withheld);
        state.withheld = sample.current;
        self.0.update(&mut state.inner, &late)
    }
}
