//! The image's scenes and the handle's estimator. Only this file, `large` and `config`
//! have `cfg`.

use estimator_core::{
    Confidence as _, Hertz, Model, NoInput, SteadyKalman, SteadyKalmanTriple, Variance,
    VelocityEstimator, preset,
};
use haptic_control::{
    Bounds, Detents, Excite, FreeAir, Hold, Inertia, LoopPoles, Off, Radians, Rig, SpringDamper,
    Texture, Torque, Viscous, Wall,
};

use crate::config::{DEVICE, RATE};
use crate::large::{LARGE, Large, LargeEstimator as _};

/// Scales, friction and loop of the device at the control rate.
pub const RIG: Rig = preset!(Rig::new(&DEVICE, RATE, LoopPoles::DEFAULT));

/// What the large motor's estimator says of itself after a tick.
#[derive(Clone, Copy)]
pub struct Estimation {
    /// Variance of its velocity; 0 where the scene needs none.
    pub variance: Variance,
    /// Its number; `None` while one takes over, and where the scene needs none.
    pub number: Option<u8>,
}

impl Estimation {
    /// Of an estimator that did not run.
    pub const NONE: Self = Self {
        variance: Variance(0.0),
        number: None,
    };

    fn of(state: &<Large as VelocityEstimator>::State) -> Self {
        Self {
            variance: LARGE.variance(state),
            number: Large::in_charge(state),
        }
    }
}

/// The handle's estimator.
pub type Handle = SteadyKalmanTriple;
const HANDLE_MODEL: Model<3, NoInput> = preset!(Model::triple_integrator(
    DEVICE.small.counts_per_rev,
    RATE,
    4e3
));
/// The parameters of [`Handle`].
pub const HANDLE: Handle = preset!(SteadyKalman::new(&HANDLE_MODEL));

/// What commands may set: stiffness and damping stay inside the passive region that
/// `host-sim zwidth` finds for these estimators (docs/telemetry.md), torque inside what the small
/// motor makes.
pub const BOUNDS: Bounds = Bounds {
    stiffness: 0.35,
    damping: 5e-3,
    angle: 6.3,
    torque: (DEVICE.small.torque_constant * DEVICE.small.current_limit) as f32,
    inertia: DEVICE.small.inertia as f32,
    rate: RATE,
};

/// Scenes by number: off, free-air, wall, spring-damper, viscous, detents, texture, hold, torque, inertia,
/// excite.
pub const SCENES: u8 = 11;
/// The scene of the torque set-point.
pub const TORQUE_SCENE: u8 = 8;

/// Scenes with their parameters, those of the host simulation.
mod preset {
    #![allow(dead_code, reason = "an image of one scene uses one")]
    use super::*;

    pub(super) const OFF: Off = Off;
    pub(super) const FREE_AIR: FreeAir = FreeAir;
    pub(super) const WALL: Wall = preset!(Wall::new(Radians(0.1), 0.30, 0.0));
    pub(super) const SPRING: SpringDamper = preset!(SpringDamper::new(Radians(0.0), 0.10, 0.5e-3));
    pub(super) const VISCOUS: Viscous = preset!(Viscous::new(2e-3));
    pub(super) const DETENTS: Detents = preset!(Detents::new(8e-3, 24));
    pub(super) const TEXTURE: Texture = preset!(Texture::new(6e-3, Hertz(150.0), RATE));
    pub(super) const HOLD: Hold = preset!(Hold::new(0.20, 1e-3));
    pub(super) const TORQUE: Torque = preset!(Torque::new(0.0));
    pub(super) const INERTIA: Inertia = preset!(Inertia::new(-2e-6, DEVICE.small.inertia as f32));
    pub(super) const EXCITE: Excite = preset!(Excite::new(&DEVICE, RATE));
}

macro_rules! image {
    ($($feature:literal, $number:literal, $scene:ident, $preset:ident;)+) => {
        $(
            #[cfg(feature = $feature)]
            use {$scene as TheScene, preset::$preset as THE_SCENE};
            /// Number of the one scene, which arming by itself puts on.
            #[cfg(feature = $feature)]
            pub const FIRST: u8 = $number;
        )+
        #[cfg(any($(feature = $feature),+))]
        mod one;
        #[cfg(any($(feature = $feature),+))]
        pub use one::{Core, Settings, Tuned};

        #[cfg(not(any($(feature = $feature),+)))]
        mod all;
        #[cfg(not(any($(feature = $feature),+)))]
        pub use all::{Core, Settings, Tuned};
        /// Number of the scene that arming by itself puts on: free-air.
        #[cfg(not(any($(feature = $feature),+)))]
        pub const FIRST: u8 = 1;
    };
}

image! {
    "scene-off", 0, Off, OFF;
    "scene-free-air", 1, FreeAir, FREE_AIR;
    "scene-wall", 2, Wall, WALL;
    "scene-spring-damper", 3, SpringDamper, SPRING;
    "scene-viscous", 4, Viscous, VISCOUS;
    "scene-detents", 5, Detents, DETENTS;
    "scene-texture", 6, Texture, TEXTURE;
    "scene-hold", 7, Hold, HOLD;
    "scene-torque", 8, Torque, TORQUE;
    "scene-inertia", 9, Inertia, INERTIA;
    "scene-excite", 10, Excite, EXCITE;
}
