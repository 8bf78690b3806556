use crate::limits::Currents;
use crate::need::Need;
use crate::units::{NewtonMetres, RadPerS, RadPerS2, Radians};

/// The handle's motion as a scene reads it. A quantity that the scene does not need is `()`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Handle<V, A = ()> {
    /// Angle from the position at which the controller started.
    pub angle: Radians,
    /// Velocity.
    pub velocity: V,
    /// Acceleration.
    pub acceleration: A,
}

/// The handle's motion with the quantities that the scene `S` reads.
pub type HandleFor<S> = Handle<
    <<S as Scene>::Velocity as Need>::Of<RadPerS>,
    <<S as Scene>::Acceleration as Need>::Of<RadPerS2>,
>;

/// A virtual environment.
///
/// The associated types state the parts that the scene needs, see [`Need`]. A part that is not
/// needed has neither state nor code. The scene cannot read a quantity that is not among its needs.
pub trait Scene {
    /// Whether the scene reads the handle's velocity.
    type Velocity: Need;
    /// Whether the scene reads the handle's acceleration.
    type Acceleration: Need;
    /// Whether the large motor renders the scene's torque.
    type Continuous: Need;
    /// Whether the small motor renders the scene's torque.
    type Transient: Need;
    /// State that the scene keeps from tick to tick.
    type State: Clone + PartialEq;

    /// Whether the handle moves freely: the scene has no spring, and both motors render it. The controller
    /// [compensates](crate::Compensation) more then.
    const FREE: bool = false;

    /// State when the handle is at `angle`.
    fn start(&self, angle: Radians) -> Self::State;

    /// One tick: the torque that the handle should feel.
    fn torque(&self, state: &mut Self::State, handle: &HandleFor<Self>) -> NewtonMetres
    where
        Self: Sized;

    /// Currents that the scene commands directly, without both stages, after [`Scene::torque`].
    /// Only an excitation commands currents; it renders no torque.
    #[inline]
    fn open_loop(_: &Self::State) -> Option<Currents> {
        None
    }

    /// Amplitude of the torque with which the scene by itself vibrates a moving handle; simulations
    /// do not count this vibration as an instability.
    fn vibration(&self) -> NewtonMetres {
        NewtonMetres(0.0)
    }
}

/// Whether a stiffness, damping or amplitude is finite and at least zero.
pub(super) const fn is_gain(gain: f32) -> bool {
    gain >= 0.0 && gain.is_finite()
}
