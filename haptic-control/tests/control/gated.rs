//! The short path of a gated controller gives the bits of the full step.

use estimator_core::{
    Amps, Count, EndFit, FiniteDifference, Foaw, Hertz, Model, NoInput, Pll, Sample, SteadyKalman,
    SteadyKalmanTriple, VelocityEstimator, preset,
};
use haptic_control::{
    AnyScene, Controller, Detents, DualStage, FreeAir, Gated, Hold, LoopPoles, Off, Radians, Rig,
    Scene, Senses, SpringDamper, Switchboard, Texture, Viscous, Wall,
};

const RATE: Hertz = Hertz(10e3);
const RIG: Rig = preset!(Rig::new(&DualStage::DEFAULT, RATE, LoopPoles::DEFAULT));
const LARGE: Foaw<15, EndFit> = preset!(Foaw::new(15, 1));
const MODEL: Model<3, NoInput> = preset!(Model::triple_integrator(20_000, RATE, 4e3));
const HANDLE: SteadyKalmanTriple = preset!(SteadyKalman::new(&MODEL));

const OFF: Off = Off;
const FREE_AIR: FreeAir = FreeAir;
const WALL: Wall = preset!(Wall::new(Radians(0.1), 0.3, 1e-3));
const SPRING: SpringDamper = preset!(SpringDamper::new(Radians(0.0), 0.1, 1e-3));
const VISCOUS: Viscous = preset!(Viscous::new(2e-3));
const DETENTS: Detents = preset!(Detents::new(8e-3, 24));
const TEXTURE: Texture = preset!(Texture::new(6e-3, Hertz(200.0), RATE));
const HOLD: Hold = preset!(Hold::new(0.2, 1e-3));

/// A medley: still, slow, fast there and back, still again; both encoders.
fn motion(k: u32) -> Sample {
    let phase = k % 8000;
    let handle = match phase {
        0..1000 => 0,
        1000..3000 => (phase - 1000) / 40,
        3000..5000 => 50 + (phase - 3000) * 2,
        5000..7000 => 4050 - (phase - 5000) * 2,
        _ => 50,
    };
    Sample::new(Count((handle / 3).wrapping_sub(7)))
        .with_small(Count(handle.wrapping_sub(1000)))
        .with_current(Amps::new(0.1))
}

/// Runs a scene in a gated controller and in the switchboard, which has no short path.
fn same_with_and_without_short_path(
    scene: impl Scene<Acceleration: Senses<SteadyKalmanTriple>>,
    any: AnyScene,
    large: impl VelocityEstimator<Output = estimator_core::CountsPerTick> + Copy,
) -> bool {
    let alone = Gated(Controller::new(scene, large, HANDLE, &RIG));
    let board = Switchboard::new(large, HANDLE, RIG, RATE);
    let first = motion(0);
    let (mut one, mut other) = (alone.start(&first), board.start(&first));
    board.select(&mut other, any, &first);
    let mut settled = false;
    for k in 0..20_000 {
        let sample = motion(k);
        let (short, full) = (
            alone.step(&mut one, &sample),
            board.step(&mut other, &sample),
        );
        let bits = |x: f32| x.to_bits();
        assert_eq!(bits(short.torque.0), bits(full.torque.0), "tick {k}");
        assert_eq!(bits(short.large.0), bits(full.large.0), "tick {k}");
        assert_eq!(bits(short.handle.0), bits(full.handle.0), "tick {k}");
        // A texture begins with a current, which the switchboard fades in.
        if !matches!(any, AnyScene::Texture(_)) {
            assert_eq!(short.currents, full.currents, "tick {k}");
        }
        settled |= one.is_settled();
    }
    settled
}

#[test]
fn the_short_path_gives_the_same_bits() {
    assert!(same_with_and_without_short_path(
        OFF,
        AnyScene::Off(OFF),
        LARGE
    ));
    assert!(same_with_and_without_short_path(
        DETENTS,
        AnyScene::Detents(DETENTS),
        LARGE
    ));
    // A phase moves on at every tick: never settled, and not to be.
    assert!(!same_with_and_without_short_path(
        TEXTURE,
        AnyScene::Texture(TEXTURE),
        LARGE
    ));
    for large in [
        preset!(Pll::new(Hertz(300.0), RATE)),
        preset!(Pll::new(Hertz(30.0), RATE)),
    ] {
        same_with_and_without_short_path(FREE_AIR, AnyScene::FreeAir(FREE_AIR), large);
        same_with_and_without_short_path(WALL, AnyScene::Wall(WALL), large);
    }
    same_with_and_without_short_path(SPRING, AnyScene::SpringDamper(SPRING), LARGE);
    same_with_and_without_short_path(VISCOUS, AnyScene::Viscous(VISCOUS), FiniteDifference);
    same_with_and_without_short_path(HOLD, AnyScene::Hold(HOLD), LARGE);
}

#[test]
fn a_loop_at_rest_settles_in_the_end() {
    // Everything in it decays: once it is below the smallest number, nothing changes any more.
    let controller = Gated(Controller::new(
        VISCOUS,
        FiniteDifference,
        FiniteDifference,
        &RIG,
    ));
    let sample = Sample::default();
    let mut state = controller.start(&sample);
    for _ in 0..10 {
        controller.step(&mut state, &sample);
    }
    assert!(state.is_settled());
    // A count unsettles it at once.
    controller.step(&mut state, &sample.with_small(Count(1)));
    assert!(!state.is_settled());
}
