//! Scenes: the torque they want, the short path, and being swapped.

use estimator_core::{
    Amps, Count, EndFit, FiniteDifference, Foaw, Hertz, Model, NoInput, Pll, Sample, SteadyKalman,
    SteadyKalmanTriple, VelocityEstimator, preset,
};
use haptic_control::{
    AnyScene, Controller, DesignError, Detents, DualStage, FreeAir, Gated, Hold, LoopPoles, Off,
    Radians, Rig, Scene, Senses, SpringDamper, Switchboard, Texture, Viscous, Wall,
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

const ALL: [AnyScene; 8] = [
    AnyScene::Off(OFF),
    AnyScene::FreeAir(FREE_AIR),
    AnyScene::Wall(WALL),
    AnyScene::SpringDamper(SPRING),
    AnyScene::Viscous(VISCOUS),
    AnyScene::Detents(DETENTS),
    AnyScene::Texture(TEXTURE),
    AnyScene::Hold(HOLD),
];

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

/// What the handle feels at rest, `counts` from where it started.
fn torque_at(scene: impl Scene<Acceleration: Senses<SteadyKalmanTriple>>, counts: i32) -> f32 {
    let controller = Controller::new(scene, LARGE, HANDLE, &RIG);
    let start = Sample::default();
    let mut state = controller.start(&start);
    let there = start.with_small(Count(counts as u32));
    let mut torque = 0.0;
    for _ in 0..20_000 {
        torque = controller.step(&mut state, &there).torque.0;
    }
    torque
}

/// 1000 counts of the small encoder.
const ANGLE: f32 = 0.314_159_27;

#[test]
fn scenes_at_rest_want_what_their_formula_says() {
    let near =
        |torque: f32, wanted: f32| assert!((torque - wanted).abs() < 1e-6, "{torque} {wanted}");
    for sign in [1, -1] {
        let angle = sign as f32 * ANGLE;
        near(torque_at(OFF, 1000 * sign), 0.0);
        near(torque_at(FREE_AIR, 1000 * sign), 0.0);
        near(torque_at(VISCOUS, 1000 * sign), 0.0);
        near(torque_at(SPRING, 1000 * sign), -0.1 * angle);
        near(torque_at(HOLD, 1000 * sign), -0.2 * angle);
    }
    near(torque_at(WALL, 1000), -0.3 * (ANGLE - 0.1));
    near(torque_at(WALL, 318), 0.0);
    near(torque_at(WALL, -5000), 0.0);
}

#[test]
fn a_wall_never_pulls() {
    let controller = Controller::new(WALL, LARGE, HANDLE, &RIG);
    let mut state = controller.start(&motion(0));
    let mut deepest = 0.0_f32;
    for k in 1..16_000 {
        let torque = controller.step(&mut state, &motion(k)).torque.0;
        assert!(torque <= 0.0, "{k}: {torque}");
        deepest = deepest.min(torque);
    }
    assert!(deepest < -0.1, "it was pushed: {deepest}");
}

#[test]
fn detents_rest_at_every_nth_of_a_turn() {
    // 24 a turn of 20000 counts: 833.3 counts from one rest to the next.
    for turn in [-3.0, 0.0, 2.0, 40.0] {
        let at = |part: f64| {
            let counts = (20_000.0 * (turn + part / 24.0)).round() as i32;
            f64::from(torque_at(DETENTS, counts))
        };
        for detent in 0..24 {
            let detent = f64::from(detent);
            assert!(at(detent).abs() < 5e-5, "{turn} {detent}: {}", at(detent));
            // It pushes back to the rest from either side, most in the middle between.
            assert!((at(detent + 0.25) + 8e-3).abs() < 5e-5, "{turn} {detent}");
            assert!((at(detent - 0.25) - 8e-3).abs() < 5e-5, "{turn} {detent}");
        }
    }
}

#[test]
fn texture_has_its_frequency_and_amplitude() {
    let controller = Controller::new(TEXTURE, LARGE, HANDLE, &RIG);
    let sample = Sample::default();
    let mut state = controller.start(&sample);
    let torques: Vec<_> = (0..10_000)
        .map(|_| controller.step(&mut state, &sample).torque.0)
        .collect();
    let rises = torques
        .windows(2)
        .filter(|w| w[0] <= 0.0 && w[1] > 0.0)
        .count();
    assert!((199..=201).contains(&rises), "{rises} periods in a second");
    let largest = torques.iter().fold(0.0_f32, |a, t| a.max(t.abs()));
    // The samples nearest the peak are 3.6 degrees from it.
    assert!((largest - 6e-3 * 0.998).abs() < 1e-5, "{largest}");
}

#[test]
fn parameters_out_of_range_are_refused() {
    let scene = Some(DesignError::Scene);
    assert_eq!(Wall::new(Radians(f32::NAN), 0.3, 0.0).err(), scene);
    assert_eq!(Wall::new(Radians(0.0), -0.3, 0.0).err(), scene);
    assert_eq!(
        SpringDamper::new(Radians(0.0), 0.3, f32::INFINITY).err(),
        scene
    );
    assert_eq!(Viscous::new(-1e-3).err(), scene);
    assert_eq!(Hold::new(f32::NAN, 0.0).err(), scene);
    assert_eq!(Detents::new(1e-3, 0).err(), scene);
    assert_eq!(Texture::new(1e-3, Hertz(49.0), RATE).err(), scene);
    assert_eq!(Texture::new(1e-3, Hertz(300.0), Hertz(500.0)).err(), scene);
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
    assert!(same_with_and_without_short_path(OFF, ALL[0], LARGE));
    assert!(same_with_and_without_short_path(DETENTS, ALL[5], LARGE));
    // A phase moves on at every tick: never settled, and not to be.
    assert!(!same_with_and_without_short_path(TEXTURE, ALL[6], LARGE));
    for large in [
        preset!(Pll::new(Hertz(300.0), RATE)),
        preset!(Pll::new(Hertz(30.0), RATE)),
    ] {
        same_with_and_without_short_path(FREE_AIR, ALL[1], large);
        same_with_and_without_short_path(WALL, ALL[2], large);
    }
    same_with_and_without_short_path(SPRING, ALL[3], LARGE);
    same_with_and_without_short_path(VISCOUS, ALL[4], FiniteDifference);
    same_with_and_without_short_path(HOLD, ALL[7], LARGE);
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

#[test]
fn swapping_scenes_does_not_make_the_currents_jump() {
    let board = Switchboard::new(LARGE, HANDLE, RIG, RATE);
    // What a tick of the scenes themselves may do: the slew limits, 1200 and 600 A/s.
    let slew = [0.121, 0.061];
    let mut wanted = Vec::new();
    for from in ALL {
        for to in ALL {
            // In the wall, moving; the swap is at 4500.
            let mut state = board.start(&motion(2000));
            board.select(&mut state, from, &motion(2000));
            let mut before = board.step(&mut state, &motion(2000)).currents;
            for k in 2001..6000 {
                if k == 4500 {
                    board.select(&mut state, to, &motion(k - 1));
                }
                let now = board.step(&mut state, &motion(k)).currents;
                let steps = [
                    now.large.get() - before.large.get(),
                    now.small.get() - before.small.get(),
                ];
                if k == 4500 {
                    wanted.push(before.small.get());
                    assert!(
                        steps.iter().all(|s| s.abs() < 1e-6),
                        "{from:?} {to:?}: {steps:?}"
                    );
                }
                for (step, slew) in steps.iter().zip(slew) {
                    assert!(step.abs() <= slew, "{from:?} {to:?} at {k}: {step} A");
                }
                before = now;
            }
        }
    }
    // What the fade hides is there: at the swap, the scenes want currents far apart.
    let spread = wanted.iter().fold(f32::MIN, |a, i| a.max(*i))
        - wanted.iter().fold(f32::MAX, |a, i| a.min(*i));
    assert!(spread > 0.5, "{spread} A");
}

#[test]
fn after_a_swap_the_scene_is_as_if_it_had_been_on_all_along() {
    let board = Switchboard::new(LARGE, HANDLE, RIG, RATE);
    for from in ALL {
        let mut swapped = board.start(&motion(0));
        let mut always = board.start(&motion(0));
        board.select(&mut swapped, from, &motion(0));
        board.select(&mut always, ALL[5], &motion(0));
        for k in 0..3000 {
            board.step(&mut swapped, &motion(k));
            board.step(&mut always, &motion(k));
        }
        board.select(&mut swapped, ALL[5], &motion(2999));
        // Ten time constants of the fade later.
        let (mut one, mut other) = (None, None);
        for k in 3000..5000 {
            one = Some(board.step(&mut swapped, &motion(k)).currents);
            other = Some(board.step(&mut always, &motion(k)).currents);
        }
        let (one, other) = (one.unwrap(), other.unwrap());
        assert!(
            (one.small.get() - other.small.get()).abs() < 2e-4,
            "{from:?}"
        );
        assert!(
            (one.large.get() - other.large.get()).abs() < 2e-4,
            "{from:?}"
        );
    }
}
