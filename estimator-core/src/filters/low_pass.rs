//! First-order low-pass over another estimator.

use crate::design::DesignError;
use crate::estimator::{VaryingPeriod, VelocityEstimator};
use crate::interval::{limited_period, lost};
use crate::memory::{Memory, memory};
use crate::sample::{Sample, Signals};
use crate::units::{CountsPerTick, Hertz};

use super::pole::pole;

/// First-order low-pass over the velocity of another estimator:
/// `v_k = v_{k-1} + α (u_k - v_{k-1})`, `α = 1 - exp(-2 π cut-off / rate)`.
///
/// The filter acts on the velocity, so a wrap of the counter has no effect. Its pole is that of the
/// continuous filter; the delay at low frequency is `(1 - α) / α` periods.
/// Valid for a cut-off from 1e-6 to 1/2 of the rate. Over another interval of h periods
/// `α = 1 - exp(-2 π h cut-off / rate)`, to 5e-7 relative.
///
/// ```
/// use estimator_core::{Count, FiniteDifference, Hertz, LowPass, Sample, VelocityEstimator, preset};
/// const FILTER: LowPass<FiniteDifference> =
///     preset!(LowPass::new(FiniteDifference, Hertz(100.0), Hertz(1000.0)));
/// let mut state = FILTER.start(&Sample::new(Count(0)));
/// let v = FILTER.update(&mut state, &Sample::new(Count(1)));
/// assert_eq!(v.0, 0.466_511_92); // 1 - exp(-0.2 π)
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(C)]
pub struct LowPass<E> {
    inner: E,
    alpha: f32,
    /// 2 π cut-off / rate.
    decay: f32,
}

memory!([E: Memory] LowPass<E> { inner, alpha, decay });

impl<E: Copy> LowPass<E> {
    /// A low-pass with `cutoff` over `inner`, updated at `rate`.
    ///
    /// # Errors
    /// [`DesignError::RATE`], [`DesignError::CUTOFF`].
    pub const fn new(inner: E, cutoff: Hertz, rate: Hertz) -> Result<Self, DesignError> {
        match pole(cutoff, rate, DesignError::CUTOFF) {
            Ok(pole) => Ok(Self {
                inner,
                alpha: (1.0 - pole) as f32,
                decay: (2.0 * core::f64::consts::PI * cutoff.0 / rate.0) as f32,
            }),
            Err(error) => Err(error),
        }
    }
}

/// State of a [`LowPass`]: the filtered velocity and the inner state.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LowPassState<S> {
    velocity: f32,
    inner: S,
}

impl<E> VelocityEstimator for LowPass<E>
where
    E: VelocityEstimator,
{
    type State = LowPassState<E::State>;
    const NEEDS: Signals = E::NEEDS;

    fn start(&self, first: &Sample) -> Self::State {
        LowPassState {
            velocity: 0.0,
            inner: self.inner.start(first),
        }
    }

    #[inline(always)]
    fn update(&self, state: &mut Self::State, sample: &Sample) -> CountsPerTick {
        let CountsPerTick(velocity) = self.inner.update(&mut state.inner, sample);
        state.velocity += self.alpha * (velocity - state.velocity);
        CountsPerTick(state.velocity)
    }
}

impl<E> VaryingPeriod for LowPass<E>
where
    E: VaryingPeriod,
{
    fn update_over(&self, state: &mut Self::State, sample: &Sample, period: f32) -> CountsPerTick {
        if period == 1.0 {
            return self.update(state, sample);
        }
        let CountsPerTick(velocity) = self.inner.update_over(&mut state.inner, sample, period);
        let alpha = lost(self.decay * limited_period(period));
        state.velocity += alpha * (velocity - state.velocity);
        CountsPerTick(state.velocity)
    }
}
