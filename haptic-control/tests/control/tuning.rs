//! The list of scenes, and their parameters: set while scenes run, within bounds or not at all.

use estimator_core::{
    Count, Hertz, Model, NoInput, Pll, Sample, SteadyKalman, SteadyKalmanTriple, preset,
};
use haptic_control::{
    AnyScene, Bounds, Detents, DualStage, LoopPoles, Radians, Refusal, Rig, Switchboard, Texture,
    Wall,
};

const RATE: Hertz = Hertz(10e3);
const BOUNDS: Bounds = Bounds {
    stiffness: 0.5,
    damping: 3e-3,
    angle: 6.0,
    torque: 40e-3,
    inertia: 5e-6,
    rate: RATE,
};

const SCENES: [AnyScene; AnyScene::NAMES.len()] =
    preset!(AnyScene::usual(&DualStage::DEFAULT, RATE));

#[test]
fn every_scene_is_at_its_number_and_has_a_name_of_its_own() {
    for (number, scene) in SCENES.iter().enumerate() {
        assert_eq!(usize::from(scene.number()), number, "{scene:?}");
        let name = AnyScene::NAMES[number];
        let same = AnyScene::NAMES.iter().filter(|other| **other == name);
        assert_eq!(same.count(), 1, "{name}");
    }
    // As the documents have them.
    let telemetry = include_str!("../../../docs/telemetry.md");
    let list = AnyScene::NAMES.join(", ");
    assert!(telemetry.contains(&format!("byte 0: {list} from 0")));
}

#[test]
fn a_parameter_set_is_that_parameter_and_no_other() {
    let wall = |position, stiffness, damping| {
        AnyScene::Wall(Wall::new(Radians(position), stiffness, damping).unwrap())
    };
    for (parameter, value, wanted) in [
        (0, -1.5, wall(-1.5, 0.30, 0.0)),
        (1, 0.5, wall(0.1, 0.5, 0.0)),
        (2, 3e-3, wall(0.1, 0.30, 3e-3)),
    ] {
        assert_eq!(SCENES[2].tuned(parameter, value, &BOUNDS), Ok(wanted));
    }
    let detents = |amplitude, per_rev| AnyScene::Detents(Detents::new(amplitude, per_rev).unwrap());
    assert_eq!(SCENES[5].tuned(0, 2e-3, &BOUNDS), Ok(detents(2e-3, 24)));
    assert_eq!(SCENES[5].tuned(1, 60.0, &BOUNDS), Ok(detents(8e-3, 60)));
    let texture = |a, f| AnyScene::Texture(Texture::new(a, Hertz(f), RATE).unwrap());
    assert_eq!(SCENES[6].tuned(0, 1e-3, &BOUNDS), Ok(texture(1e-3, 150.0)));
    assert_eq!(SCENES[6].tuned(1, 200.0, &BOUNDS), Ok(texture(6e-3, 200.0)));
}

#[test]
fn what_the_device_cannot_render_is_refused() {
    let gain = [-1e-9, 1e9];
    for (scene, parameter, just_above) in [
        (2, 0, 6.001),
        (2, 1, 0.501),
        (2, 2, 3.001e-3),
        (3, 0, 6.001),
        (3, 1, 0.501),
        (3, 2, 3.001e-3),
        (4, 0, 3.001e-3),
        // 24 a turn of 0.5 N.m/rad.
        (5, 0, 0.0209),
        (5, 1, 63.0),
        (5, 1, 24.5),
        (6, 0, 0.0401),
        (6, 1, 301.0),
        (7, 0, 0.501),
        (7, 1, 3.001e-3),
        (8, 0, 0.0401),
        // More than half of the handle's own.
        (9, 0, 2.6e-6),
    ] {
        let signed = matches!((scene, parameter), (2 | 3 | 8 | 9, 0));
        let low = if signed { -just_above } else { gain[0] };
        for value in [just_above, low, gain[1]] {
            let tuned = SCENES[scene].tuned(parameter, value, &BOUNDS);
            assert_eq!(
                tuned,
                Err(Refusal::OutOfBounds),
                "{scene} {parameter} {value}"
            );
        }
    }
}

#[test]
fn what_is_at_a_bound_is_taken() {
    for (scene, parameter, values) in [
        (2, 0, vec![6.0, -6.0]),
        (2, 1, vec![0.0, 0.5]),
        (2, 2, vec![0.0, 3e-3]),
        (3, 0, vec![6.0, -6.0]),
        (3, 1, vec![0.0, 0.5]),
        (3, 2, vec![0.0, 3e-3]),
        (4, 0, vec![0.0, 3e-3]),
        // 24 a turn of 0.5 N.m/rad, and 0.5 N.m/rad of 8 mN.m each.
        (5, 0, vec![0.0, 0.0208]),
        (5, 1, vec![1.0, 62.0]),
        (6, 0, vec![0.0, 40e-3]),
        (6, 1, vec![50.0, 300.0]),
        (7, 0, vec![0.0, 0.5]),
        (7, 1, vec![0.0, 3e-3]),
        (8, 0, vec![40e-3, -40e-3, 0.0]),
        (9, 0, vec![2.5e-6, -2.5e-6, 0.0]),
    ] {
        for value in values {
            let tuned = SCENES[scene].tuned(parameter, value, &BOUNDS);
            let tuned = tuned.unwrap_or_else(|_| panic!("{scene} {parameter} {value}"));
            // Once more gives the same, and so does the way over another value.
            assert_eq!(tuned.tuned(parameter, value, &BOUNDS), Ok(tuned));
            assert_eq!(tuned.number(), SCENES[scene].number());
        }
    }
    // The amplitude of detents is a torque, too: with one detent a turn it ends there.
    let one = SCENES[5].tuned(1, 1.0, &BOUNDS).unwrap();
    assert!(one.tuned(0, 40e-3, &BOUNDS).is_ok());
    assert_eq!(one.tuned(0, 41e-3, &BOUNDS), Err(Refusal::OutOfBounds));
}

#[test]
fn parameters_have_the_names_of_the_documents() {
    let telemetry = include_str!("../../../docs/telemetry.md");
    let numbered = |scene: usize| {
        let names = SCENES[scene].parameters();
        (names.len(), names.join(" "))
    };
    assert_eq!(numbered(2), (3, "position stiffness damping".to_owned()));
    assert_eq!(numbered(3), (3, "centre stiffness damping".to_owned()));
    assert_eq!(numbered(4), (1, "damping".to_owned()));
    assert_eq!(numbered(5), (2, "amplitude per-turn".to_owned()));
    assert_eq!(numbered(6), (2, "amplitude frequency".to_owned()));
    assert_eq!(numbered(7), (2, "stiffness damping".to_owned()));
    assert_eq!(numbered(8), (1, "torque".to_owned()));
    assert_eq!(numbered(9), (1, "inertia".to_owned()));
    for scene in [0, 1, 10] {
        assert_eq!(numbered(scene).0, 0);
    }
    for row in [
        "| 4 viscous | 0 damping |",
        "| 8 torque | 0 torque,",
        "| 9 inertia | 0 inertia,",
        "| 7 hold | 0 stiffness, 1 damping |",
    ] {
        assert!(telemetry.contains(row), "{row}");
    }
}

#[test]
fn every_parameter_refuses_what_is_no_number_and_others_are_unknown() {
    let mut parameters = 0;
    for scene in SCENES {
        for parameter in 0..=u8::MAX {
            let known = usize::from(parameter) < scene.parameters().len();
            parameters += usize::from(known);
            let wanted = match known {
                true => Refusal::NotFinite,
                false => Refusal::Unknown,
            };
            for value in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
                assert_eq!(scene.tuned(parameter, value, &BOUNDS), Err(wanted));
            }
        }
    }
    assert_eq!(parameters, 15);
}

#[test]
fn tuning_and_torque_set_points_do_not_jump() {
    const RIG: Rig = preset!(Rig::new(&DualStage::DEFAULT, RATE, LoopPoles::DEFAULT));
    const PLL: Pll = preset!(Pll::new(Hertz(100.0), RATE));
    const MODEL: Model<3, NoInput> = preset!(Model::triple_integrator(20_000, RATE, 4e3));
    const HANDLE: SteadyKalmanTriple = preset!(SteadyKalman::new(&MODEL));
    let board = Switchboard::new(PLL, HANDLE, RIG, RATE);
    // 1000 counts are 0.31 rad, 0.21 rad into the wall. Everything begins at 400 counts.
    let (first, inside) = ([400, 1000].map(|at| Sample::default().with_small(Count(at)))).into();
    const ANGLE: f32 = 0.314_159_27;
    for (scene, parameter, value, wanted) in [
        (2, 1, 0.1, -0.1 * (ANGLE - 0.1)),
        (2, 0, 0.2, -0.3 * (ANGLE - 0.2)),
        (3, 1, 0.0, 0.0),
        (3, 0, 0.3, -0.1 * (ANGLE - 0.3)),
        // A hold keeps where it began.
        (7, 0, 0.1, -0.1 * 0.6 * ANGLE),
        (7, 1, 0.0, -0.2 * 0.6 * ANGLE),
        (8, 0, 0.03, 0.03),
    ] {
        let mut state = board.start(&Sample::default());
        board.select(&mut state, SCENES[scene], &first);
        let mut before = board.step(&mut state, &first);
        for _ in 0..3000 {
            before = board.step(&mut state, &inside);
        }
        let tuned = SCENES[scene].tuned(parameter, value, &BOUNDS).unwrap();
        board.retune(&mut state, tuned);
        // Not taken: another scene than the one that is on.
        board.retune(&mut state, SCENES[4]);
        let first = board.step(&mut state, &inside);
        let jump = first.currents.small.get() - before.currents.small.get();
        assert!(jump.abs() < 1e-6, "{scene}: {jump} A");
        let mut last = first;
        for _ in 0..3000 {
            last = board.step(&mut state, &inside);
        }
        let off = (last.torque.0 - wanted).abs();
        assert!(off < 1e-5, "{scene} {parameter}: {last:?} {wanted}");
    }
}
