//! The scale of the current limits at run time.

use estimator_core::{Amps, SteadyKalmanTriple};
use haptic_control::{
    AnyScene, Compensated, Controller, CurrentScale, Currents, NewtonMetres, RadPerS, Scene,
    SceneKind, Senses, Switchboard, scenes,
};

use crate::bench::{DEVICE, HANDLE, LARGE, RATE, RIG, motion, usual};

/// The part of the currents.
const PART: f32 = 0.1;

fn part() -> CurrentScale {
    CurrentScale::new(PART).expect("a part")
}

/// Whether the currents are within this part of the device's limits, but for rounding.
fn are_within(currents: Currents, part: f32) -> bool {
    let within = |current: f32, limit: f64| current.abs() <= limit as f32 * part * 1.000_001;
    within(currents.large.get(), DEVICE.large.current_limit)
        && within(currents.small.get(), DEVICE.small.current_limit)
}

/// The largest currents in a run, after a restart if `restarts`.
fn largest_of_switchboard(
    scene: AnyScene,
    scale: Option<CurrentScale>,
    restarts: bool,
) -> [f32; 2] {
    let board = Switchboard::new(LARGE, HANDLE, RIG, RATE);
    let mut state = board.start(&motion(0));
    if let Some(scale) = scale {
        board.scale(&mut state, scale);
    }
    if restarts {
        board.restart(&mut state, &motion(0));
    }
    board.select(&mut state, scene, &motion(0));
    let mut largest = [0.0_f32; 2];
    for k in 0..20_000 {
        let Currents { large, small } = board.step(&mut state, &motion(k)).currents;
        largest = [
            largest[0].max(large.get().abs()),
            largest[1].max(small.get().abs()),
        ];
        let part = if scale.is_some() { PART } else { 1.0 };
        assert!(
            are_within(Currents { large, small }, part),
            "{} {k}",
            scene.kind()
        );
    }
    largest
}

#[test]
fn no_scene_of_the_switchboard_exceeds_the_part() {
    let mut limited = [0; 2];
    for kind in SceneKind::ALL {
        let scene = usual(kind);
        let whole = largest_of_switchboard(scene, None, false);
        for restarts in [false, true] {
            let largest = largest_of_switchboard(scene, Some(part()), restarts);
            for i in 0..2 {
                limited[i] += u32::from(largest[i] < 0.999 * whole[i]);
            }
        }
    }
    // Currents of both motors are above the part in some scenes.
    assert!(limited.iter().all(|scenes| *scenes > 2), "{limited:?}");
}

fn is_scaled_alone<S>(kind: SceneKind, scene: S)
where
    S: Scene<Acceleration: Senses<SteadyKalmanTriple>> + Copy,
{
    let alone = Controller::new(scene, LARGE, HANDLE, &RIG);
    for restarts in [false, true] {
        let mut state = alone.start(&motion(0));
        alone.scale(&mut state, part());
        if restarts {
            alone.restart(&mut state, &motion(0));
        }
        for k in 0..20_000 {
            let currents = alone.step(&mut state, &motion(k)).currents;
            // The user of an open loop limits its currents.
            let currents = if kind.is_closed_loop() {
                currents
            } else {
                part().within(&DEVICE, currents)
            };
            assert!(are_within(currents, PART), "{kind} {k}");
        }
    }
}

#[test]
fn no_controller_of_one_scene_exceeds_the_part() {
    macro_rules! check {
        ($($number:literal, $name:literal, $scene:ident, $facts:tt;)+) => {
            $(is_scaled_alone(SceneKind::$scene, haptic_control::$scene::usual(&DEVICE, RATE).unwrap());)+
        };
    }
    scenes!(check);
}

/// The loop is given the scaled current, so that time at the limit does not change its state.
#[test]
fn time_at_the_scaled_limit_does_not_wind_up() {
    let held = RadPerS(0.0);
    for (scale, largest) in [
        (part(), f64::from(PART) * DEVICE.large.current_limit),
        (bounded(CurrentScale::FULL), BOUNDS[0].into()),
    ] {
        does_not_wind_up(held, scale, largest);
    }
}

fn does_not_wind_up(held: RadPerS, scale: CurrentScale, largest: f64) {
    let turned = |saturated: u32| -> Vec<f32> {
        let stage = &RIG.continuous;
        let following = Compensated::following(held);
        let mut state = stage.start(held);
        stage.scale(&mut state, scale);
        let mut current = |torque| {
            stage
                .update(&mut state, NewtonMetres(torque), held, held, &following)
                .current
                .get()
        };
        for _ in 0..saturated {
            current(0.1);
        }
        (0..2000).map(|_| current(-0.1)).collect()
    };
    let [short, long] = [3000, 60_000].map(turned);
    for (tick, (short, long)) in short.iter().zip(&long).enumerate() {
        assert!((short - long).abs() < 1e-3, "{tick}: {short} A, {long} A");
    }
    let last = f64::from(*long.last().expect("ticks"));
    assert!((last + largest).abs() < 1e-6);
}

/// Bounds below the scaled limits, A.
const BOUNDS: [f32; 2] = [0.35, 0.08];

fn bounded(scale: CurrentScale) -> CurrentScale {
    let [large, small] = BOUNDS.map(Amps::new);
    scale.bounded(Currents { large, small })
}

#[test]
fn smaller_one_of_bound_and_scaled_limit_counts() {
    let limits = [DEVICE.large.current_limit, DEVICE.small.current_limit].map(|it| it as f32);
    let of = |scale: CurrentScale| [scale.large(limits[0]), scale.small(limits[1])];
    assert_eq!(of(bounded(CurrentScale::FULL)), BOUNDS);
    let hundredth = CurrentScale::new(0.01).expect("a part");
    assert_eq!(of(bounded(hundredth)), limits.map(|limit| 0.01 * limit));
    assert_eq!(of(bounded(CurrentScale::NONE)), [0.0; 2]);
    assert_eq!(of(CurrentScale::FULL), limits);
    for wrong in [-1.0, f32::NAN] {
        let [large, small] = [Amps::new(wrong); 2];
        let none = CurrentScale::FULL.bounded(Currents { large, small });
        assert_eq!(of(none), [0.0; 2], "{wrong}");
    }
}

#[test]
fn no_scene_of_the_switchboard_exceeds_the_bounds() {
    let mut reached = [0; 2];
    for kind in SceneKind::ALL {
        let board = Switchboard::new(LARGE, HANDLE, RIG, RATE);
        let mut state = board.start(&motion(0));
        board.scale(&mut state, bounded(CurrentScale::FULL));
        board.select(&mut state, usual(kind), &motion(0));
        for k in 0..20_000 {
            let Currents { large, small } = board.step(&mut state, &motion(k)).currents;
            for (i, current) in [large, small].into_iter().enumerate() {
                let current = current.get().abs();
                assert!(current <= BOUNDS[i], "{kind} {k}");
                reached[i] += u32::from(current == BOUNDS[i]);
            }
        }
    }
    assert!(reached.iter().all(|ticks| *ticks > 0), "{reached:?}");
}

#[test]
fn scale_of_zero_leaves_no_current() {
    let scene = usual(SceneKind::Hold);
    let board = Switchboard::new(LARGE, HANDLE, RIG, RATE);
    let mut state = board.start(&motion(0));
    board.scale(&mut state, CurrentScale::NONE);
    board.select(&mut state, scene, &motion(0));
    for k in 0..2000 {
        assert_eq!(
            board.step(&mut state, &motion(k)).currents,
            Currents::default()
        );
    }
}

#[test]
fn currents_of_an_open_loop_are_limited_on_both_sides() {
    let whole = [DEVICE.large.current_limit, DEVICE.small.current_limit];
    for sign in [1.0, -1.0] {
        let [large, small] = whole.map(|limit| Amps::new(sign * limit as f32));
        let limited = part().within(&DEVICE, Currents { large, small });
        for (current, limit) in [limited.large, limited.small].into_iter().zip(whole) {
            let expected = sign * PART * limit as f32;
            assert!(
                (current.get() - expected).abs() < 1e-6,
                "{current:?} {expected}"
            );
        }
        let small_enough = Currents {
            large: Amps::new(sign * 0.1),
            small: Amps::new(sign * 0.01),
        };
        assert_eq!(part().within(&DEVICE, small_enough), small_enough);
    }
}
