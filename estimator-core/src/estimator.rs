//! The interface of every estimator.

use crate::sample::{Sample, Signals};
use crate::units::CountsPerTickSquared;

/// A velocity estimator: immutable parameters, with the state apart.
///
/// The state is made from the first sample, so the first update has no jump and no state is ever
/// uninitialised. To reset an estimator, start it again. Any crate may implement this trait.
pub trait VelocityEstimator {
    /// State carried from tick to tick. If a tick leaves it equal, bit for bit but for the sign of
    /// zeros, the tick has no influence on later outputs.
    type State: Clone + PartialEq;
    /// Output of a tick: [`CountsPerTick`](crate::CountsPerTick), or `()` for [`Skip`].
    type Output: Copy;
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
    fn update(&self, state: &mut Self::State, sample: &Sample) -> Self::Output;
}

/// An estimator whose model has an acceleration.
pub trait AccelerationEstimator: VelocityEstimator {
    /// The acceleration at the instant of the latest update.
    fn acceleration(&self, state: &Self::State) -> CountsPerTickSquared;
}

/// An estimator without state, output and code, for a controller that needs no velocity.
///
/// ```
/// use estimator_core::{Count, Sample, Skip, VelocityEstimator};
/// let first = Sample::new(Count(7));
/// let mut state = Skip.start(&first);
/// assert_eq!(Skip.update(&mut state, &first), ());
/// assert_eq!(size_of_val(&state), 0);
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Skip;

impl VelocityEstimator for Skip {
    type State = ();
    type Output = ();
    const NEEDS: Signals = Signals::COUNT;

    fn start(&self, _: &Sample) {}

    fn update(&self, (): &mut (), _: &Sample) {}
}
