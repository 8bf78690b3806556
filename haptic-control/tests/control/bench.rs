//! The default device with estimators and scenes, and a motion, for the tests of this program.

use estimator_core::{
    Amps, Count, EndFit, Foaw, Hertz, Model, NoInput, Sample, SteadyKalman, SteadyKalmanTriple,
    preset,
};
use haptic_control::{AnyScene, Bounds, DualStage, LoopPoles, Rig, SceneKind};

pub(crate) const RATE: Hertz = Hertz(10e3);
pub(crate) const DEVICE: DualStage = DualStage::DEFAULT;
pub(crate) const RIG: Rig = preset!(Rig::new(&DEVICE, RATE, LoopPoles::DEFAULT));

pub(crate) type Large = Foaw<15, EndFit>;
pub(crate) const LARGE: Large = preset!(Foaw::new(15, 1));
const MODEL: Model<3, NoInput> = preset!(Model::triple_integrator(20_000, RATE, 4e3));
pub(crate) const HANDLE: SteadyKalmanTriple = preset!(SteadyKalman::new(&MODEL));

/// Every scene with its usual parameters, at its number.
pub(crate) const SCENES: [AnyScene; SceneKind::ALL.len()] = preset!(AnyScene::usual(&DEVICE, RATE));

pub(crate) const BOUNDS: Bounds = Bounds {
    stiffness: 0.5,
    damping: 3e-3,
    angle: 6.0,
    torque: 40e-3,
    inertia: 5e-6,
    rate: RATE,
};

/// The scene of this kind, with its usual parameters.
pub(crate) fn usual(kind: SceneKind) -> AnyScene {
    SCENES[usize::from(kind.number())]
}

/// A handle that rests, moves slowly, moves fast to and fro, and rests again. The large motor moves
/// a third as many counts.
pub(crate) fn motion(k: u32) -> Sample {
    let phase = k % 8000;
    let handle = match phase {
        0..1000 => 0,
        1000..3000 => (phase - 1000) / 40,
        3000..5000 => 50 + (phase - 3000) * 2,
        5000..7000 => 4050 - (phase - 5000) * 2,
        _ => 50,
    };
    Sample::new(Count((handle / 3).wrapping_sub(7)))
        .with_coupled(Count(handle.wrapping_sub(1000)))
        .with_current(Amps::new(0.1))
}
