//! The image's scenes and the handle's estimator. Only this file, `large` and `config`
//! have `cfg`.

use estimator_core::{
    Confidence as _, Model, NoInput, SteadyKalman, SteadyKalmanTriple, Variance, VelocityEstimator,
    preset,
};
use haptic_control::{Bounds, LoopPoles, Rig, SceneKind};

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

/// Number of scenes.
pub const SCENES: u8 = SceneKind::ALL.len() as u8;
/// Number of the scene of the torque set-point.
pub const TORQUE_SCENE: u8 = SceneKind::Torque.number();

pub mod all;

macro_rules! image {
    ($($number:literal, $name:literal, $scene:ident, $facts:tt;)+) => {
        $(
            #[cfg(scene = $name)]
            use haptic_control::$scene as TheScene;
            #[cfg(scene = $name)]
            const THE_SCENE: TheScene = preset!(TheScene::usual(&DEVICE, RATE));
            /// Number of the one scene, which arming by itself puts on.
            #[cfg(scene = $name)]
            pub const FIRST: u8 = $number;
        )+
        #[cfg(all(one_scene, not(any($(scene = $name),+))))]
        compile_error!(concat!("SCENE must be the name of a scene:" $(, " ", $name)+));
    };
}
haptic_control::scenes!(image);

#[cfg(one_scene)]
mod one;
#[cfg(one_scene)]
pub use one::{Core, Settings, Tuned};

#[cfg(not(one_scene))]
pub use all::{Core, Settings, Tuned};
/// Number of the scene that arming by itself puts on: free-air.
#[cfg(not(one_scene))]
pub const FIRST: u8 = SceneKind::FreeAir.number();
