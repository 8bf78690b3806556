//! Closed loops that tests change.

use catalogue::estimators::Kind;
use catalogue::parameters::Parameters;
use experiments::closed_loop::{FeedbackEncoder, Loop, estimator, usual};
use haptic_control::{AnyScene, LoopPoles, SceneKind};
use simulation::device::Device;

/// A run of `scene` on a device that the controller knows, with the hand of the scene. `large` and `handle` are names of
/// estimators.
pub(crate) fn on(
    device: &Device,
    scene: AnyScene,
    rate_hz: f64,
    [large, handle]: [&str; 2],
) -> Loop {
    let on = |name, counts| {
        let kind = Kind::named(name).unwrap();
        estimator(kind, device, counts, rate_hz, &Parameters::default()).unwrap()
    };
    Loop {
        large: on(large, device.stages.large.counts_per_rev),
        handle: on(handle, device.stages.small.counts_per_rev),
        hand: scene.kind().facts().hand.into(),
        scene,
        device: device.clone(),
        assumed: device.stages,
        rate_hz,
        seed: 1,
        encoder: FeedbackEncoder::Own,
        poles: LoopPoles::DEFAULT,
        late_ticks: 0,
        offsets_a: [0.0; 2],
    }
}

/// A run of a scene with its usual parameters on the default device.
pub(crate) fn on_default(scene: SceneKind, rate_hz: f64, estimators: [&str; 2]) -> Loop {
    let device = Device::default();
    let scene = usual(scene, &device.stages, rate_hz).unwrap();
    on(&device, scene, rate_hz, estimators)
}
