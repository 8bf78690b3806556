//! A controller that rests where nothing can come of a tick.

use estimator_core::{CountsPerTick, Sample, VelocityEstimator};

use crate::controller::{Controller, ControllerState};
use crate::need::Senses;
use crate::scene::Scene;
use crate::tick::Action;

/// A [`Controller`] with a short path: where the sample is that of the tick before, and neither
/// state nor action changed then, the action is repeated. The bits are those of the full step.
///
/// Costs a copy and a comparison of the state at a tick that repeats its sample but has not
/// settled, so the longest tick is longer than the bare controller's; saves nearly all of a tick
/// at rest. FOAW and finite difference settle within their window, filters once their state has
/// decayed below the smallest number, a texture never.
///
/// ```
/// use estimator_core::*;
/// use haptic_control::*;
/// const RATE: Hertz = Hertz(10e3);
/// const RIG: Rig = preset!(Rig::new(&DualStage::DEFAULT, RATE, LoopPoles::DEFAULT));
/// const DETENTS: Detents = preset!(Detents::new(8e-3, 24));
///
/// let detents = Gated(Controller::new(DETENTS, FiniteDifference, FiniteDifference, &RIG));
/// let here = Sample::default();
/// let mut state = detents.start(&here);
/// let action = detents.step(&mut state, &here);
/// assert!(state.is_settled());
/// assert_eq!(detents.step(&mut state, &here), action); // in a few instructions
/// ```
pub struct Gated<S: Scene, L, H>(pub Controller<S, L, H>);

/// State of a [`Gated`] controller.
pub struct GatedState<S: Scene, L: VelocityEstimator, H: VelocityEstimator> {
    inner: ControllerState<S, L, H>,
    last: (Sample, Action),
    settled: bool,
}

impl<S: Scene, L: VelocityEstimator, H: VelocityEstimator> GatedState<S, L, H> {
    /// Whether the same sample once more will take the short path.
    #[must_use]
    pub fn is_settled(&self) -> bool {
        self.settled
    }
}

impl<S, L, H> Gated<S, L, H>
where
    S: Scene<Acceleration: Senses<H>>,
    L: VelocityEstimator<Output = CountsPerTick>,
    H: VelocityEstimator<Output = CountsPerTick>,
{
    /// State at rest at the first sample.
    pub fn start(&self, first: &Sample) -> GatedState<S, L, H> {
        GatedState {
            inner: self.0.start(first),
            last: (*first, Action::default()),
            settled: false,
        }
    }

    /// One tick.
    pub fn step(&self, state: &mut GatedState<S, L, H>, sample: &Sample) -> Action {
        let repeated = *sample == state.last.0;
        if repeated && state.settled {
            return state.last.1;
        }
        let before = repeated.then(|| state.inner.clone());
        let action = self.0.step(&mut state.inner, sample);
        state.settled =
            action == state.last.1 && before.is_some_and(|before| before == state.inner);
        state.last = (*sample, action);
        action
    }
}
