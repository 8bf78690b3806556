//! Finite difference.

use crate::confidence::{Confidence, Variance};
use crate::estimator::{VaryingPeriod, VelocityEstimator};
use crate::interval::limited_period;
use crate::memory::memory;
use crate::sample::{Sample, Signals};
use crate::units::{Count, CountsPerTick};

/// Displacement over the last period: `v_k = y_k - y_{k-1}` (eq. 4, in counts per tick).
///
/// The delay is half a period. One count changes the velocity by `2 π rate / counts_per_rev`:
/// 1.53 rad/s for 1024 lines at 1 kHz. Exact for displacements within ±2^24 counts/tick. Over another
/// interval of h periods the velocity is the displacement over h, and its variance 1 / h².
///
/// ```
/// use estimator_core::{Count, CountsPerTick, FiniteDifference, Sample, VelocityEstimator};
/// let mut state = FiniteDifference.start(&Sample::new(Count(u32::MAX)));
/// let v = FiniteDifference.update(&mut state, &Sample::new(Count(1)));
/// assert_eq!(v, CountsPerTick(2.0));
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[repr(C)]
pub struct FiniteDifference;

memory!(FiniteDifference {});

impl VelocityEstimator for FiniteDifference {
    type State = Count;
    const NEEDS: Signals = Signals::COUNT;

    fn start(&self, first: &Sample) -> Count {
        first.count
    }

    #[inline(always)]
    fn update(&self, previous: &mut Count, sample: &Sample) -> CountsPerTick {
        let step = sample.count - *previous;
        *previous = sample.count;
        CountsPerTick(step.to_f32())
    }
}

impl VaryingPeriod for FiniteDifference {
    #[inline(always)]
    fn update_over(&self, previous: &mut Count, sample: &Sample, period: f32) -> CountsPerTick {
        let CountsPerTick(displacement) = self.update(previous, sample);
        CountsPerTick(displacement / limited_period(period))
    }

    fn variance_over(&self, state: &Count, period: f32) -> Variance {
        let period = limited_period(period);
        Variance(self.variance(state).0 / (period * period))
    }
}
