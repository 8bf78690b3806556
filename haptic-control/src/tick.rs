//! The one step that everybody calls, for any scene and any keeper of its state.

use estimator_core::{CountsPerTick, Sample, Scale, VelocityEstimator};

use crate::limits::Currents;
use crate::need::Need;
use crate::scene::{Handle, Scene};
use crate::stage::{ContinuousStage, ContinuousState, TransientStage, TransientState};
use crate::units::{NewtonMetres, RadPerS, Radians};

/// Whether the handle's velocity is estimated: for the scene, or for the slip.
pub(crate) type HandleNeed<S> = <<S as Scene>::Velocity as Need>::Or<<S as Scene>::Continuous>;

/// An estimator, its state and its scale.
pub(crate) struct Estimated<'a, E: VelocityEstimator> {
    pub(crate) estimator: &'a E,
    pub(crate) state: &'a mut E::State,
    pub(crate) scale: Scale,
}

impl<E: VelocityEstimator<Output = CountsPerTick>> Estimated<'_, E> {
    fn velocity(self, sample: &Sample) -> RadPerS {
        RadPerS(
            self.estimator
                .update(self.state, sample)
                .rad_per_s(&self.scale),
        )
    }
}

/// Everything that a continuous stage works with.
pub(crate) struct Continuous<'a, L: VelocityEstimator> {
    pub(crate) large: Estimated<'a, L>,
    pub(crate) stage: &'a ContinuousStage,
    pub(crate) state: &'a mut ContinuousState,
}

/// Everything that a transient stage works with.
pub(crate) struct Transient<'a> {
    pub(crate) stage: &'a TransientStage,
    pub(crate) state: &'a mut TransientState,
}

/// The parts that a scene needs; the others are `()`.
pub(crate) struct Parts<'a, S: Scene, L: VelocityEstimator, H: VelocityEstimator> {
    pub(crate) continuous: <S::Continuous as Need>::Of<Continuous<'a, L>>,
    pub(crate) handle: <HandleNeed<S> as Need>::Of<Estimated<'a, H>>,
    pub(crate) transient: <S::Transient as Need>::Of<Transient<'a>>,
}

/// What a tick came to.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Action {
    /// Currents to apply until the next tick.
    pub currents: Currents,
    /// Torque that the handle should feel.
    pub torque: NewtonMetres,
    /// Velocity of the large motor; zero where the scene does not need it.
    pub large: RadPerS,
    /// Velocity of the handle; zero where the scene does not need it.
    pub handle: RadPerS,
}

/// One tick of `scene`.
pub(crate) fn tick<S, L, H>(
    scene: &S,
    scene_state: &mut S::State,
    parts: Parts<'_, S, L, H>,
    angle: Radians,
    sample: &Sample,
) -> Action
where
    S: Scene,
    L: VelocityEstimator<Output = CountsPerTick>,
    H: VelocityEstimator<Output = CountsPerTick>,
{
    let velocity = HandleNeed::<S>::map(parts.handle, |handle| {
        // An estimator looks at the large encoder of its sample: show it the handle's there.
        handle.velocity(&Sample::new(sample.small))
    });
    let seen = Handle {
        angle,
        velocity: S::Velocity::narrow::<S::Continuous, _>(&velocity),
    };
    let torque = scene.torque(scene_state, &seen);
    let handle = HandleNeed::<S>::or(velocity, RadPerS(0.0));
    let mut action = Action {
        torque,
        handle,
        ..Action::default()
    };
    let coupled = S::Continuous::map(parts.continuous, |part| {
        action.large = part.large.velocity(sample);
        action.currents.large = part.stage.update(part.state, torque, action.large, handle);
        let slip = RadPerS(action.large.0 - handle.0);
        part.stage.coupled(part.state, torque, slip)
    });
    let coupled = S::Continuous::or(coupled, NewtonMetres(0.0));
    S::Transient::map(parts.transient, |part| {
        let missing = NewtonMetres(torque.0 - coupled.0);
        action.currents.small = part.stage.update(part.state, missing, handle);
    });
    action
}
