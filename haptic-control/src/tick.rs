//! The control step of any scene, which controller and switchboard share.

use estimator_core::{Sample, Scale, VelocityEstimator};

use crate::compensation::{Compensation, CompensationState};
use crate::limits::Currents;
use crate::need::{Need, Senses};
use crate::rig::AccelerationScale;
use crate::scene::{Handle, Scene};
use crate::stage::{ContinuousStage, ContinuousState, TransientStage, TransientState};
use crate::units::{NewtonMetres, RadPerS, RadPerS2, Radians};

/// The need for the large motor or for the handle's acceleration.
type ForOthers<S> = <<S as Scene>::Continuous as Need>::Or<<S as Scene>::Acceleration>;

/// Whether the handle's velocity is estimated: for the scene, for the slip of the coupler or with
/// the acceleration.
pub(crate) type HandleNeed<S> = <<S as Scene>::Velocity as Need>::Or<ForOthers<S>>;

/// An estimator, its state and its scale.
pub(crate) struct Estimated<'a, E: VelocityEstimator> {
    pub(crate) estimator: &'a E,
    pub(crate) state: &'a mut E::State,
    pub(crate) scale: Scale,
}

impl<E: VelocityEstimator> Estimated<'_, E> {
    fn velocity(&mut self, sample: &Sample) -> RadPerS {
        RadPerS(
            self.estimator
                .update(self.state, sample)
                .rad_per_s(&self.scale),
        )
    }
}

/// The continuous stage with the large motor's estimator, and what both motors compensate.
pub(crate) struct Continuous<'a, L: VelocityEstimator> {
    pub(crate) large: Estimated<'a, L>,
    pub(crate) compensation: &'a Compensation,
    pub(crate) compensated: &'a mut CompensationState,
    pub(crate) stage: &'a ContinuousStage,
    pub(crate) state: &'a mut ContinuousState,
}

/// The transient stage with its state.
pub(crate) struct Transient<'a> {
    pub(crate) stage: &'a TransientStage,
    pub(crate) state: &'a mut TransientState,
}

/// The parts that a scene needs. A part that it does not need is `()`.
pub(crate) struct Parts<'a, S: Scene, L: VelocityEstimator, H: VelocityEstimator> {
    pub(crate) continuous: <S::Continuous as Need>::Of<Continuous<'a, L>>,
    pub(crate) handle: <HandleNeed<S> as Need>::Of<Estimated<'a, H>>,
    pub(crate) acceleration: <S::Acceleration as Need>::Of<AccelerationScale>,
    pub(crate) transient: <S::Transient as Need>::Of<Transient<'a>>,
}

/// Result of a control tick.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Action {
    /// Currents to apply until the next tick.
    pub currents: Currents,
    /// Torque that the handle should feel.
    pub torque: NewtonMetres,
    /// Velocity of the large motor; zero if the scene does not need it.
    pub large_velocity: RadPerS,
    /// Velocity of the handle; zero if the scene does not need it.
    pub handle_velocity: RadPerS,
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
    S: Scene<Acceleration: Senses<H>>,
    L: VelocityEstimator,
    H: VelocityEstimator,
{
    let mut acceleration = S::Acceleration::make(RadPerS2::default);
    let velocity = HandleNeed::<S>::map(parts.handle, |mut handle| {
        // An estimator reads the field `count` of a sample: here the count of the handle's encoder.
        let velocity = handle.velocity(&Sample::new(sample.coupled));
        let sensed = S::Acceleration::acceleration(handle.estimator, handle.state);
        acceleration = S::Acceleration::zip(sensed, parts.acceleration, |a, scale| scale.of(a));
        velocity
    });
    let seen = Handle {
        angle,
        velocity: S::Velocity::narrow::<ForOthers<S>, _>(&velocity),
        acceleration,
    };
    let torque = scene.torque(scene_state, &seen);
    let handle = HandleNeed::<S>::or(velocity, RadPerS(0.0));
    let mut action = Action {
        torque,
        handle_velocity: handle,
        ..Action::default()
    };
    let less = S::Continuous::map(parts.continuous, |mut part| {
        let large = part.large.velocity(sample);
        let compensated = part.compensation.update(part.compensated, handle);
        let driven = part
            .stage
            .update(part.state, torque, large, handle, &compensated);
        action.large_velocity = large;
        action.currents.large = driven.current;
        driven.coupled.0 - compensated.friction.0
    });
    let asked = NewtonMetres(torque.0 - S::Continuous::or(less, 0.0));
    S::Transient::map(parts.transient, |part| {
        action.currents.small = part.stage.update(part.state, asked);
    });
    if let Some(currents) = S::open_loop(scene_state) {
        action.currents = currents;
    }
    action
}
