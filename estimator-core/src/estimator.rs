//! The interface of every estimator.

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
