//! Finite difference.

use crate::estimator::VelocityEstimator;
use crate::sample::{Sample, Signals};
use crate::units::{Count, CountsPerTick};

/// Displacement over the last period: `v_k = y_k - y_{k-1}` (eq. 4, in counts per tick).
///
/// The delay is half a period. One count changes the velocity by `2 π rate / counts_per_rev`:
/// 1.53 rad/s for 1024 lines at 1 kHz. Exact for displacements within ±2^24 counts/tick.
///
/// ```
/// use estimator_core::{Count, CountsPerTick, FiniteDifference, Sample, VelocityEstimator};
/// let mut state = FiniteDifference.start(&Sample::new(Count(u32::MAX)));
/// let v = FiniteDifference.update(&mut state, &Sample::new(Count(1)));
/// assert_eq!(v, CountsPerTick(2.0));
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct FiniteDifference;

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
