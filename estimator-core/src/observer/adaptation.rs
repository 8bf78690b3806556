//! Adaptation of an observer's parameters: none ([`Fixed`]) or [`Adaptive`](super::Adaptive).

use super::gain::Gain;
use super::innovation::Innovation;
use super::inputs::TickInput;
use super::motion::Motion;
use super::sensitivity::{Tick, Update};
use crate::memory::memory;
use crate::sealed::Sealed;

/// Relative parameter errors: estimated over nominal value, less one. 0.1 is 10 % above nominal.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ParameterErrors {
    /// Error of the damping per inertia, b / J.
    pub damping: f32,
    /// Error of the Coulomb friction per inertia; in the range [`Wide`](super::Wide) in parts of the
    /// friction that [`Range::friction`](super::Range::friction) returns.
    pub friction: f32,
    /// Error of the torque constant per inertia, Kt / J.
    pub torque_constant: f32,
}

impl ParameterErrors {
    /// Estimated over nominal damping of the coupling, if the torque constant has its nominal value.
    ///
    /// The inertia is known less well than the torque constant. It divides both parameters, so it
    /// cancels in their ratio.
    #[must_use]
    pub fn damping_ratio(&self) -> f32 {
        (1.0 + self.damping) / (1.0 + self.torque_constant)
    }
}

/// Change of position, velocity and disturbance by a change of the parameters.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StateChange {
    pub(super) position: f32,
    pub(super) velocity: f32,
    pub(super) disturbance: f32,
}

/// Adaptation of the model's parameters: [`Fixed`] or [`Adaptive`](super::Adaptive).
///
/// This trait is sealed: only types of this crate implement it.
pub trait Adaptation: Copy + Sealed {
    /// State of the adaptation, carried from tick to tick.
    type State: Clone + PartialEq;
    /// Sensitivity of the observer's state to the parameters.
    type Sensitivity;

    /// The state before the first update.
    fn start(&self) -> Self::State;

    /// The estimated relative parameter errors.
    fn parameter_errors(&self, state: &Self::State) -> ParameterErrors;

    /// Variance of the velocity that is due to the uncertainty of the parameters, (counts/tick)².
    fn velocity_variance(&self, state: &Self::State) -> f32;

    /// Acceleration by current and slip, with the lag of the displacement behind its mean.
    fn drive(
        &self,
        state: &Self::State,
        motion: &Motion,
        input: TickInput,
        coupled: f32,
        velocity: f32,
    ) -> TickInput;

    /// Coulomb friction at this velocity with its `correction`, counts/tick².
    fn friction(&self, state: &Self::State, motion: &Motion, correction: f32, velocity: f32)
    -> f32;

    /// The gain that replaces `gain`, if the model does not explain the innovation; `velocity` is the
    /// predicted velocity, `dense` whether every tick may have an innovation.
    fn unexplained(
        &self,
        state: &mut Self::State,
        innovation: &Innovation,
        gain: &Gain,
        velocity: f32,
        dense: bool,
    ) -> Option<Gain>;

    /// Propagates the sensitivity over a tick.
    fn propagate(&self, state: &Self::State, tick: &Tick<'_>) -> Self::Sensitivity;

    /// Stores the sensitivity after a tick without an innovation.
    fn store(&self, state: &mut Self::State, sensitivity: Self::Sensitivity);

    /// Updates the parameters by an innovation; returns the resulting change of the observer's
    /// state, if the parameters changed.
    fn update(
        &self,
        state: &mut Self::State,
        sensitivity: Self::Sensitivity,
        update: &Update<'_>,
    ) -> Option<StateChange>;
}

/// No adaptation: the parameters keep their nominal values.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[repr(C)]
pub struct Fixed;

memory!(Fixed {});

impl Sealed for Fixed {}

impl Adaptation for Fixed {
    type State = ();
    type Sensitivity = ();

    fn start(&self) {}

    fn parameter_errors(&self, (): &()) -> ParameterErrors {
        ParameterErrors::default()
    }

    fn velocity_variance(&self, (): &()) -> f32 {
        0.0
    }

    #[inline(always)]
    fn drive(&self, (): &(), motion: &Motion, input: TickInput, coupled: f32, _: f32) -> TickInput {
        TickInput {
            mean: input.mean + motion.coupling * coupled,
            lag: input.lag,
        }
    }

    #[inline(always)]
    fn friction(&self, (): &(), motion: &Motion, correction: f32, _: f32) -> f32 {
        motion.friction + correction
    }

    #[inline(always)]
    fn unexplained(&self, (): &mut (), _: &Innovation, _: &Gain, _: f32, _: bool) -> Option<Gain> {
        None
    }

    #[inline(always)]
    fn propagate(&self, (): &(), _: &Tick<'_>) {}

    #[inline(always)]
    fn store(&self, (): &mut (), (): ()) {}

    #[inline(always)]
    fn update(&self, (): &mut (), (): (), _: &Update<'_>) -> Option<StateChange> {
        None
    }
}
