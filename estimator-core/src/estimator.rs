//! What every estimator is.

use crate::sample::{Sample, Signals};
use crate::units::CountsPerTickSquared;

/// A velocity estimator: immutable parameters, with the state apart.
///
/// The state begins with a sample, so an estimator can neither difference against memory that was
/// never written nor jump at the first tick; to reset, start again.
pub trait VelocityEstimator {
    /// What is carried from tick to tick. A tick that leaves it equal, bit for bit but for signs
    /// of zero, changes nothing to come.
    type State: Clone + PartialEq;
    /// What a tick yields: [`CountsPerTick`](crate::CountsPerTick), or `()` where no velocity is
    /// wanted.
    type Output: Copy;
    /// Which parts of a sample, besides the large count, it reads.
    const NEEDS: Signals;

    /// The state at rest at the first sample.
    fn start(&self, first: &Sample) -> Self::State;

    /// Begins again at rest at this sample. What was chosen from outside, as by a [`Handover`]'s
    /// [`select`](crate::HandoverState::select), stays.
    ///
    /// [`Handover`]: crate::Handover
    fn restart(&self, state: &mut Self::State, first: &Sample) {
        *state = self.start(first);
    }

    /// One tick: take the next sample, return the velocity at its instant.
    fn update(&self, state: &mut Self::State, sample: &Sample) -> Self::Output;
}

/// An estimator whose model has an acceleration too.
pub trait AccelerationEstimator: VelocityEstimator {
    /// The acceleration at the instant of the latest update.
    fn acceleration(&self, state: &Self::State) -> CountsPerTickSquared;
}

/// The estimator of whoever needs no velocity: no state, no output, no code.
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
