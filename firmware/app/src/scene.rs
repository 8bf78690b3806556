//! The scenes of the image and the estimator of the handle.

use estimator_core::{
    Confidence as _, Imm, Model, NoInput, SteadyKalman, SteadyKalmanTriple, Variance,
    VelocityEstimator, preset,
};
use haptic_control::{Bounds, LoopPoles, Rig, SceneKind};

use crate::config::{DEVICE, RATE};
use crate::large::{LARGE, Large, LargeEstimator as _};

/// Scales, friction and loop of the device at the control rate.
pub const RIG: Rig = preset!(Rig::new(&DEVICE, RATE, LoopPoles::DEFAULT));

/// Confidence and number of the large motor's estimator after a tick.
#[derive(Clone, Copy)]
pub struct Estimation {
    /// Variance of the velocity; 0 if the scene needs no velocity.
    pub variance: Variance,
    /// Number of the estimator; `None` during a handover and if the scene needs no velocity.
    pub number: Option<u8>,
}

impl Estimation {
    /// Of a tick without an estimator.
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

/// A steady-state Kalman filter for the handle.
pub type Filter = SteadyKalmanTriple;
const HANDLE_MODEL: Model<3, NoInput> = preset!(Model::triple_integrator(
    DEVICE.small.counts_per_rev,
    RATE,
    tuned::image("handle", "kalman-triple-steady", RATE, "jerk")
));
/// The parameters of [`Filter`].
pub const FILTER: Filter = preset!(SteadyKalman::new(&HANDLE_MODEL));

/// A self-tuning bank of filters for the handle, which has no parameters.
pub type Bank = Imm;
/// The design of [`Bank`].
pub const BANK: Bank = preset!(Imm::new(RATE));

#[cfg(feature = "handle-imm")]
pub use self::{BANK as HANDLE, Bank as Handle};
#[cfg(not(feature = "handle-imm"))]
pub use self::{FILTER as HANDLE, Filter as Handle};

/// Bounds of parameters that commands set. Stiffness and damping are inside the passive region that
/// `host-sim zwidth` finds for these estimators (docs/telemetry.md). Torque is at most that of the small
/// motor.
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

/// Whether the image has the scene of a number. Every image has off.
#[must_use]
pub const fn has(scene: u8) -> bool {
    if cfg!(one_scene) {
        scene == SceneKind::Off.number() || scene == FIRST
    } else {
        scene < SCENES
    }
}

pub mod all;

macro_rules! image {
    ($($number:literal, $name:literal, $scene:ident, $facts:tt;)+) => {
        $(
            #[cfg(scene = $name)]
            use haptic_control::$scene as TheScene;
            #[cfg(scene = $name)]
            const THE_SCENE: TheScene = preset!(TheScene::usual(&DEVICE, RATE));
            /// Number of the one scene, which an image that arms without a command selects.
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
pub use one::{Core, Parameters, Tuned};

#[cfg(not(one_scene))]
pub use all::{Core, Parameters, Tuned};
/// Number of the scene that an image that arms without a command selects: free-air.
#[cfg(not(one_scene))]
pub const FIRST: u8 = SceneKind::FreeAir.number();
