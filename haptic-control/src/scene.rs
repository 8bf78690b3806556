//! Virtual environments: the torque on the handle, and the quantities that are needed to compute
//! it.
//!
//! This file lists the scenes. Each has a module, an export and a row of
//! [`scenes!`](crate::scenes!).

mod catalogue;
mod detents;
mod environment;
mod excite;
mod free_air;
mod friction;
mod hold;
mod impedance;
mod inertia;
mod off;
mod sine;
mod spring_damper;
mod texture;
mod torque;
mod viscous;
mod wall;

pub use catalogue::{AnyScene, Needs, Role, SceneFacts, SceneKind, SimulatedHand};
pub use detents::Detents;
pub use environment::{Handle, HandleFor, Scene};
pub use excite::{Excite, ExciteState};
pub use free_air::FreeAir;
pub use friction::Friction;
pub use hold::Hold;
pub use inertia::Inertia;
pub use off::Off;
pub use spring_damper::SpringDamper;
pub use texture::Texture;
pub use torque::Torque;
pub use viscous::Viscous;
pub use wall::Wall;

/// Calls the macro `$each` with the catalogue of scenes, one row per scene.
///
/// A row is `number, "name", Type, { facts };`. The number selects the scene in commands and never
/// changes. [`SceneKind`] and [`AnyScene`] are made from the facts; other lists of scenes need
/// number, name and type alone:
///
/// ```
/// macro_rules! names {
///     ($($number:literal, $name:literal, $scene:ident, $facts:tt;)+) => {
///         [$($name),+]
///     };
/// }
/// assert_eq!(haptic_control::scenes!(names)[2], "wall");
/// ```
///
/// [`SceneKind`]: crate::SceneKind
/// [`AnyScene`]: crate::AnyScene
#[macro_export]
macro_rules! scenes {
    ($each:ident) => {
        $each! {
            0, "off", Off, {
                summary: "no current in either motor",
                torque: "none",
                role: Environment,
                hand: FreeMotion,
                usual: |_device, _rate| Ok(Off)
            };
            1, "free-air", FreeAir, {
                summary: "no torque on the handle; the large motor follows it",
                torque: "0",
                role: Environment,
                hand: FreeMotion,
                usual: |_device, _rate| Ok(FreeAir)
            };
            2, "wall", Wall, {
                summary: "a spring and a damper beyond an angle, which never pull",
                torque: "`-K (θ - θw) - B ω` for θ > θw, at most 0",
                role: Environment,
                hand: WallPress,
                usual: |_device, _rate| Wall::new(Radians(0.1), 0.30, 0.0)
            };
            3, "spring-damper", SpringDamper, {
                summary: "a spring and a damper to an angle",
                torque: "`-K (θ - θ0) - B ω`",
                role: Environment,
                hand: FreeMotion,
                usual: |_device, _rate| SpringDamper::new(Radians(0.0), 0.10, 0.5e-3)
            };
            4, "viscous", Viscous, {
                summary: "viscous friction",
                torque: "`-B ω`",
                role: Environment,
                hand: FreeMotion,
                usual: |_device, _rate| Viscous::new(2e-3)
            };
            5, "detents", Detents, {
                summary: "rest positions at equal angles",
                torque: "`-A sin(n θ)`",
                role: Environment,
                hand: FreeMotion,
                usual: |_device, _rate| Detents::new(8e-3, 24)
            };
            6, "texture", Texture, {
                summary: "a vibration of 50 to 300 Hz",
                torque: "`A sin(2π f t)`",
                role: Environment,
                hand: FreeMotion,
                usual: |_device, rate| Texture::new(6e-3, Hertz(150.0), rate)
            };
            7, "hold", Hold, {
                summary: "a spring and a damper to the angle at which the scene began",
                torque: "`-K (θ - θ_start) - B ω`",
                role: Environment,
                hand: HoldStill,
                usual: |_device, _rate| Hold::new(0.20, 1e-3)
            };
            8, "torque", Torque, {
                summary: "the torque of the latest set-point command",
                torque: "the set-point",
                role: SetPoint,
                hand: FreeMotion,
                usual: |_device, _rate| Torque::new(0.0)
            };
            9, "inertia", Inertia, {
                summary: "an inertia, at most half of the handle's own, added or taken away",
                torque: "`-M α`",
                role: Environment,
                hand: FreeMotion,
                usual: |device, _rate| {
                    let own = device.small.inertia as f32;
                    Inertia::new(-0.4 * own, own)
                }
            };
            10, "excite", Excite, {
                summary: "a fixed pattern of currents, open loop, to identify the device",
                torque: "none",
                role: Excitation,
                hand: FreeMotion,
                usual: |device, rate| Excite::new(device, rate)
            };
            11, "friction", Friction, {
                summary: "Coulomb friction, viscous around zero velocity",
                torque: "`-max(-T, min(B ω, T))`",
                role: Environment,
                hand: FreeMotion,
                usual: |_device, _rate| Friction::new(4e-3, 2e-3)
            };
        }
    };
}
