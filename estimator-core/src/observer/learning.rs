//! What an observer learns of its parameters: nothing ([`Fixed`]), or
//! [`Learned`](super::Learned).

use super::correction::Innovation;
use super::dependence::{Lesson, Tick};
use super::design::Gain;
use super::inputs::Push;
use super::motion::Motion;

/// Relative deviations of the parameters from what was believed: 0.1 is 10 % more.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Deviations {
    /// Of damping per inertia, b / J.
    pub damping: f32,
    /// Of Coulomb friction per inertia.
    pub friction: f32,
    /// Of the torque constant per inertia, Kt / J.
    pub torque_constant: f32,
}

impl Deviations {
    /// The coupler's damping over what was believed, if the torque constant is as believed: the
    /// inertia, which is known worse and in both, cancels.
    #[must_use]
    pub fn damping_ratio(&self) -> f32 {
        (1.0 + self.damping) / (1.0 + self.torque_constant)
    }
}

/// Position, velocity and unknown torque, as a correction changes them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Shift {
    pub(super) position: f32,
    pub(super) velocity: f32,
    pub(super) load: f32,
}

/// What is learned, and how it enters the motion.
pub trait Learning: Copy {
    /// What is carried from tick to tick.
    type State: Clone + PartialEq;
    /// How the motor's state depends on what is learned.
    type Dependence;

    /// The state before anything was learned.
    fn start(&self) -> Self::State;

    /// What was learned so far.
    fn deviations(&self, state: &Self::State) -> Deviations;

    /// Variance of the velocity that comes of what is not known of the parameters.
    fn velocity_variance(&self, state: &Self::State) -> f32;

    /// Acceleration by current and slip, and how far the rotor is behind its current's mean.
    fn drive(
        &self,
        state: &Self::State,
        motion: &Motion,
        push: Push,
        handle: f32,
        velocity: f32,
    ) -> Push;

    /// Coulomb friction.
    fn friction(&self, state: &Self::State, motion: &Motion) -> f32;

    /// The gain to take instead of `gain` if an innovation shows that the observer started in
    /// motion; `velocity` is the predicted one.
    fn starting(
        &self,
        state: &mut Self::State,
        innovation: &Innovation,
        gain: &Gain,
        velocity: f32,
    ) -> Option<Gain>;

    /// Follows a tick: how its result depends on each parameter.
    fn follow(&self, state: &Self::State, tick: &Tick<'_>) -> Self::Dependence;

    /// Keeps what followed from a tick without an innovation.
    fn keep(&self, state: &mut Self::State, dependence: Self::Dependence);

    /// Learns from an innovation; what that changes in the motor's state, if anything.
    fn learn(
        &self,
        state: &mut Self::State,
        dependence: Self::Dependence,
        lesson: &Lesson<'_>,
    ) -> Option<Shift>;
}

/// The parameters are what they are believed to be.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Fixed;

impl Learning for Fixed {
    type State = ();
    type Dependence = ();

    fn start(&self) {}

    fn deviations(&self, (): &()) -> Deviations {
        Deviations::default()
    }

    fn velocity_variance(&self, (): &()) -> f32 {
        0.0
    }

    #[inline(always)]
    fn drive(&self, (): &(), motion: &Motion, push: Push, handle: f32, _: f32) -> Push {
        Push {
            mean: push.mean + motion.coupling * handle,
            behind: push.behind,
        }
    }

    #[inline(always)]
    fn friction(&self, (): &(), motion: &Motion) -> f32 {
        motion.friction
    }

    #[inline(always)]
    fn starting(&self, (): &mut (), _: &Innovation, _: &Gain, _: f32) -> Option<Gain> {
        None
    }

    #[inline(always)]
    fn follow(&self, (): &(), _: &Tick<'_>) {}

    #[inline(always)]
    fn keep(&self, (): &mut (), (): ()) {}

    #[inline(always)]
    fn learn(&self, (): &mut (), (): (), _: &Lesson<'_>) -> Option<Shift> {
        None
    }
}
