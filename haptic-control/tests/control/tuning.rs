//! The list of scenes, and their parameters: set while scenes run, within bounds or not at all.

use estimator_core::{Count, Hertz, Pll, Sample, preset};
use haptic_control::{
    AnyScene, Detents, Friction, Radians, Refusal, SceneKind, Switchboard, Texture, Wall,
};

use crate::bench::{BOUNDS, DEVICE, HANDLE, RATE, RIG, SCENES};

/// Numbers and names are part of commands and recordings: they never change.
#[test]
fn scenes_keep_their_numbers_and_names() {
    let names: [&str; SceneKind::ALL.len()] = [
        "off",
        "free-air",
        "wall",
        "spring-damper",
        "viscous",
        "detents",
        "texture",
        "hold",
        "torque",
        "inertia",
        "excite",
        "friction",
    ];
    for (number, name) in names.into_iter().enumerate() {
        assert_eq!(SceneKind::ALL[number].name(), name);
    }
}

#[test]
fn scenes_have_consecutive_numbers_and_unique_names() {
    for (number, kind) in SceneKind::ALL.into_iter().enumerate() {
        assert_eq!(usize::from(kind.number()), number, "{kind}");
        assert_eq!(kind.facts().number, kind.number(), "{kind}");
        assert_eq!(SCENES[number].kind(), kind);
        assert_eq!(SceneKind::named(kind.name()), Some(kind));
        assert_eq!(kind.to_string(), kind.name());
    }
    assert_eq!(SceneKind::named("tarpit"), None);
}

/// As the types of the scenes say; the handle's estimator runs for the slip of the coupler, too.
#[test]
fn needs_agree_with_the_types() {
    let needs = |kind: SceneKind| {
        let needs = kind.facts().needs;
        [
            needs.velocity,
            needs.acceleration,
            needs.continuous,
            needs.transient,
            needs.free,
            needs.handle_estimator,
        ]
        .map(u8::from)
    };
    assert_eq!(needs(SceneKind::Off), [0, 0, 0, 0, 0, 0]);
    assert_eq!(needs(SceneKind::Detents), [0, 0, 0, 1, 0, 0]);
    assert_eq!(needs(SceneKind::FreeAir), [0, 0, 1, 1, 1, 1]);
    assert_eq!(needs(SceneKind::Wall), [1, 0, 1, 1, 0, 1]);
    assert_eq!(needs(SceneKind::Inertia), [0, 1, 1, 1, 0, 1]);
    let free = SceneKind::ALL
        .into_iter()
        .filter(|kind| kind.facts().needs.free);
    let without_spring = [SceneKind::FreeAir, SceneKind::Viscous, SceneKind::Friction];
    assert!(free.eq(without_spring));
}

/// Also where the small motor alone renders: a device whose signs nobody has verified must not run these.
#[test]
fn all_scenes_but_off_and_the_excitation_are_closed_loops() {
    let open = SceneKind::ALL
        .into_iter()
        .filter(|kind| !kind.is_closed_loop());
    assert!(open.eq([SceneKind::Off, SceneKind::Excite]));
}

/// The bounds of a scene's parameters, with their numbers.
fn ranges(scene: &AnyScene) -> impl Iterator<Item = (u8, [f32; 2])> {
    let parameters = scene.kind().facts().parameters;
    (0..).zip(parameters).map(|(number, parameter)| {
        let range = parameter.quantity.range(&BOUNDS);
        (number, [*range.start(), *range.end()])
    })
}

#[test]
fn setting_a_parameter_to_its_value_changes_nothing() {
    for scene in SCENES {
        let mut parameters = 0;
        for (number, [least, most]) in ranges(&scene) {
            let value = scene.value(number, RATE).unwrap();
            assert!(
                value >= least && value <= most,
                "{scene:?} {number}: {value}"
            );
            assert_eq!(scene.tuned(number, value, &BOUNDS), Ok(scene), "{number}");
            parameters = number + 1;
        }
        assert_eq!(scene.value(parameters, RATE), None, "{scene:?}");
    }
}

#[test]
fn every_parameter_is_set_by_its_name() {
    for scene in SCENES {
        let values = |scene: &AnyScene| -> Vec<f32> {
            (0..)
                .map_while(|number| scene.value(number, RATE))
                .collect()
        };
        for (number, [least, most]) in ranges(&scene) {
            let name = scene.kind().facts().parameters[usize::from(number)].name;
            assert_eq!(scene.kind().parameter(name), Some(number), "{name}");
            // Near the value that it has, because detents bound both of theirs together.
            let before = scene.value(number, RATE).unwrap();
            let value = match before {
                0.0 => 0.5 * most,
                before => (0.5 * before).max(least),
            };
            let tuned = scene.tuned(number, value, &BOUNDS).unwrap();
            let mut wanted = values(&scene);
            wanted[usize::from(number)] = value;
            assert_eq!(values(&tuned), wanted, "{scene:?} {name}");
            assert_ne!(tuned, scene, "{name}");
        }
    }
}

#[test]
fn every_parameter_is_refused_beyond_its_bounds() {
    for scene in SCENES {
        for (number, [least, most]) in ranges(&scene) {
            let beyond = 1e-6 * (most - least);
            for value in [least - beyond, most + beyond, -1e9, 1e9] {
                let tuned = scene.tuned(number, value, &BOUNDS);
                assert_eq!(
                    tuned,
                    Err(Refusal::OutOfBounds),
                    "{scene:?} {number} {value}"
                );
            }
        }
    }
}

/// A page offers the whole range of a parameter. Detents bound both of theirs together: at their least one has its range.
#[test]
fn both_ends_of_a_range_are_accepted() {
    for scene in SCENES {
        for (number, ends) in ranges(&scene) {
            let mut calm = scene;
            if scene.kind() == SceneKind::Detents {
                for (other, [least, _]) in ranges(&scene) {
                    if other != number {
                        calm = calm.tuned(other, least, &BOUNDS).unwrap();
                    }
                }
            }
            for value in ends {
                let tuned = calm.tuned(number, value, &BOUNDS);
                assert!(tuned.is_ok(), "{calm:?} {number} {value}");
            }
        }
    }
}

#[test]
fn setting_a_parameter_changes_no_other() {
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
    let friction = |torque, damping| AnyScene::Friction(Friction::new(torque, damping).unwrap());
    assert_eq!(SCENES[11].tuned(0, 5e-3, &BOUNDS), Ok(friction(5e-3, 2e-3)));
    assert_eq!(SCENES[11].tuned(1, 1e-3, &BOUNDS), Ok(friction(4e-3, 1e-3)));
}

/// A frequency that no f32 has, so that its own value would set another one.
#[test]
fn amplitude_of_a_texture_leaves_its_frequency_to_the_last_bit() {
    let texture = |amplitude| {
        let hertz = Hertz(100.0 + std::f64::consts::PI);
        AnyScene::Texture(Texture::new(amplitude, hertz, RATE).unwrap())
    };
    assert_eq!(texture(1e-3).tuned(0, 2e-3, &BOUNDS), Ok(texture(2e-3)));
}

#[test]
fn parameters_beyond_the_device_are_refused() {
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
        (11, 0, 0.0401),
        (11, 1, 3.001e-3),
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
fn parameters_at_a_bound_are_accepted() {
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
        (11, 0, vec![0.0, 40e-3]),
        (11, 1, vec![0.0, 3e-3]),
    ] {
        for value in values {
            let tuned = SCENES[scene].tuned(parameter, value, &BOUNDS);
            let tuned = tuned.unwrap_or_else(|_| panic!("{scene} {parameter} {value}"));
            // Once more gives the same, and so does the way over another value.
            assert_eq!(tuned.tuned(parameter, value, &BOUNDS), Ok(tuned));
            assert_eq!(tuned.kind(), SCENES[scene].kind());
        }
    }
    // The amplitude of detents is a torque, too: with one detent a turn it ends there.
    let one = SCENES[5].tuned(1, 1.0, &BOUNDS).unwrap();
    assert!(one.tuned(0, 40e-3, &BOUNDS).is_ok());
    assert_eq!(one.tuned(0, 41e-3, &BOUNDS), Err(Refusal::OutOfBounds));
}

/// A host may send parameters in every tick. They are followed late by the time constant of the fade, 20 ms.
#[test]
fn parameters_that_change_in_every_tick_take_effect() {
    const PER_REV: u16 = 24;
    const TICKS_OF_FADE: f64 = 200.0;
    let board = Switchboard::new(HANDLE, HANDLE, RIG, RATE);
    let crest = Count((20_000.0 / (4.0 * f64::from(PER_REV))) as u32);
    let crest = Sample::default().with_coupled(crest);
    // Torque at the end of amplitudes that rise by `rise` a tick, N.m.
    let torque = |rise: f64| {
        let detents = |k: u32| {
            let amplitude = 2e-3 + rise * f64::from(k);
            AnyScene::Detents(Detents::new(amplitude as f32, PER_REV).unwrap())
        };
        let mut state = board.start(&Sample::default());
        board.select(&mut state, detents(0), &Sample::default());
        let mut action = board.step(&mut state, &crest);
        for k in 0..=4000 {
            board.retune(&mut state, detents(k));
            action = board.step(&mut state, &crest);
        }
        -f64::from(action.currents.small.get()) * DEVICE.small.torque_constant
    };
    let error = torque(0.0) / 2e-3 - 1.0;
    assert!(error.abs() < 1e-3, "{error}");
    let late = 4000.0 - (torque(1e-6) - 2e-3) / 1e-6;
    assert!((late - TICKS_OF_FADE).abs() < 5.0, "{late} ticks");
}

/// Numbers and names of parameters are part of commands: they never change.
#[test]
fn parameters_keep_their_numbers_and_names() {
    let names: [&str; SceneKind::ALL.len()] = [
        "",
        "",
        "position stiffness damping",
        "centre stiffness damping",
        "damping",
        "amplitude per-turn",
        "amplitude frequency",
        "stiffness damping",
        "torque",
        "inertia",
        "",
        "torque damping",
    ];
    for (kind, names) in SceneKind::ALL.into_iter().zip(names) {
        let known = kind
            .facts()
            .parameters
            .iter()
            .map(|parameter| parameter.name);
        assert_eq!(known.collect::<Vec<_>>().join(" "), names, "{kind}");
    }
}

#[test]
fn nan_is_refused_and_unknown_parameters_are_reported() {
    let mut parameters = 0;
    for scene in SCENES {
        for parameter in 0..=u8::MAX {
            let known = usize::from(parameter) < scene.kind().facts().parameters.len();
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
    assert!(parameters >= 15, "{parameters}");
}

#[test]
fn tuning_and_torque_set_points_do_not_jump() {
    const PLL: Pll = preset!(Pll::new(Hertz(100.0), RATE));
    let board = Switchboard::new(PLL, HANDLE, RIG, RATE);
    // 1000 counts are 0.31 rad, 0.21 rad into the wall. Everything begins at 400 counts.
    let (first, inside) = ([400, 1000].map(|at| Sample::default().with_coupled(Count(at)))).into();
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
