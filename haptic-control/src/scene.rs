//! Virtual environments: what torque the handle should feel, and what is needed to know that.

mod catalogue;
mod detents;
mod excite;
mod free_air;
mod hold;
mod impedance;
mod inertia;
mod off;
mod spring_damper;
mod texture;
mod torque;
mod viscous;
mod wall;

pub use catalogue::AnyScene;
pub use detents::Detents;
pub use excite::{Excite, ExciteState};
pub use free_air::FreeAir;
pub use hold::Hold;
pub use inertia::Inertia;
pub use off::Off;
pub use spring_damper::SpringDamper;
pub use texture::Texture;
pub use torque::Torque;
pub use viscous::Viscous;
pub use wall::Wall;

use crate::limits::Currents;
use crate::need::Need;
use crate::units::{NewtonMetres, RadPerS, RadPerS2, Radians};

/// What a scene may know of the handle. What it does not need is `()`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Handle<V, A = ()> {
    /// Angle from where the controller started.
    pub angle: Radians,
    /// Velocity.
    pub velocity: V,
    /// Acceleration.
    pub acceleration: A,
}

/// What a scene sees of the handle.
pub type Seen<S> = Handle<
    <<S as Scene>::Velocity as Need>::Of<RadPerS>,
    <<S as Scene>::Acceleration as Need>::Of<RadPerS2>,
>;

/// A virtual environment.
///
/// What it needs is in its types: with [`Skip`](estimator_core::Skip) there is neither state nor
/// code, and a velocity that was not asked for cannot be read.
pub trait Scene {
    /// Whether it reads the handle's velocity.
    type Velocity: Need;
    /// Whether it reads the handle's acceleration.
    type Acceleration: Need;
    /// Whether the large motor renders its torque.
    type Continuous: Need;
    /// Whether the small motor does.
    type Transient: Need;
    /// What it carries from tick to tick.
    type State: Clone + PartialEq;

    /// State when the handle is at `angle`.
    fn start(&self, angle: Radians) -> Self::State;

    /// One tick: the torque that the handle should feel.
    fn torque(&self, state: &mut Self::State, handle: &Seen<Self>) -> NewtonMetres
    where
        Self: Sized;

    /// Currents that the scene commands itself, past both stages, after [`Scene::torque`].
    ///
    /// Only an excitation does: it renders nothing.
    #[inline]
    fn open_loop(_: &Self::State) -> Option<Currents> {
        None
    }
}

/// Whether a stiffness, damping or amplitude is finite and at least zero.
const fn is_gain(gain: f32) -> bool {
    gain >= 0.0 && gain.is_finite()
}

/// `sin(π x)` for -1 <= x <= 1 from two parabolas, within 0.0011: no library, the same bits
/// everywhere.
pub(crate) fn sine(x: f32) -> f32 {
    let magnitude = if x < 0.0 { -x } else { x };
    let parabola = 4.0 * x * (1.0 - magnitude);
    let size = if parabola < 0.0 { -parabola } else { parabola };
    parabola * (0.775 + 0.225 * size)
}

#[cfg(test)]
mod tests {
    extern crate std;

    #[test]
    fn sine_is_within_its_bound() {
        for i in -1000..=1000_i16 {
            let x = f32::from(i) / 1000.0;
            let error = super::sine(x) - (core::f32::consts::PI * x).sin();
            assert!(error.abs() < 0.0011, "{x}: {error}");
        }
    }
}
