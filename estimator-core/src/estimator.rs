//! The interface of every estimator.

use crate::confidence::{Confidence, Variance};
use crate::sample::{Sample, Signals};
use crate::units::{CountsPerTick, CountsPerTickSquared};

/// A velocity estimator: immutable parameters, with the state apart.
///
/// The state is made from the first sample, so the first update has no jump and no state is ever
/// uninitialised. To reset an estimator, start it again. Any crate may implement this trait.
pub trait VelocityEstimator {
    /// State carried from tick to tick. If a tick leaves it equal, bit for bit but for the sign of
    /// zeros, the tick has no influence on later outputs.
    type State: Clone + PartialEq;
    /// The parts of a sample that the estimator reads besides the count.
    const NEEDS: Signals;

    /// The state at rest at the first sample.
    fn start(&self, first: &Sample) -> Self::State;

    /// Sets the state to rest at this sample. A choice made from outside stays, as that of
    /// [`HandoverState::select`](crate::HandoverState::select).
    fn restart(&self, state: &mut Self::State, first: &Sample) {
        *state = self.start(first);
    }

    /// Processes the sample of one tick and returns the velocity at the instant of that sample.
    fn update(&self, state: &mut Self::State, sample: &Sample) -> CountsPerTick;

    /// [`update`](Self::update), bit for bit, for a function of which the parameters are arguments, as in C.
    /// It takes fewer instructions there, and more code.
    #[inline(always)]
    fn update_of_memory(&self, state: &mut Self::State, sample: &Sample) -> CountsPerTick {
        self.update(state, sample)
    }
}

/// An estimator that also takes samples at uneven times.
///
/// [`update`](VelocityEstimator::update) assumes that one control period lies between two samples.
/// `update_over` takes the interval itself. Both may be mixed.
///
/// ```
/// use estimator_core::{Count, FiniteDifference, Sample, VaryingPeriod, VelocityEstimator};
/// let mut state = FiniteDifference.start(&Sample::new(Count(0)));
/// // A sample that comes a quarter of a period late.
/// let v = FiniteDifference.update_over(&mut state, &Sample::new(Count(5)), 1.25);
/// assert_eq!(v.0, 4.0); // counts per control period
/// ```
pub trait VaryingPeriod: VelocityEstimator {
    /// Processes a sample that comes `period` control periods after the one before, and returns the
    /// velocity at the instant of that sample, in counts per control period.
    ///
    /// A period of 1 gives the result of [`update`](VelocityEstimator::update), bit for bit. Valid from
    /// 1/1024 to 2^20 periods: a shorter one, or NaN, is taken as 1/1024, a longer one as 2^20. The
    /// number of instructions grows with the logarithm of the period at most.
    fn update_over(&self, state: &mut Self::State, sample: &Sample, period: f32) -> CountsPerTick;

    /// Variance of the velocity of the latest `update_over`, which had this `period`.
    fn variance_over(&self, state: &Self::State, period: f32) -> Variance
    where
        Self: Confidence,
    {
        let _ = period;
        self.variance(state)
    }
}

/// An estimator whose model has an acceleration.
pub trait AccelerationEstimator: VelocityEstimator {
    /// The acceleration at the instant of the latest update.
    fn acceleration(&self, state: &Self::State) -> CountsPerTickSquared;
}

/// The empty part: it takes the place of a part that a program does not need. It has neither state
/// nor code, and no velocity can be read from it.
///
/// ```
/// assert_eq!(size_of::<estimator_core::Skip>(), 0);
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Skip;
