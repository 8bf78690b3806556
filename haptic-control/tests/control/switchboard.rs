//! The switchboard: scenes swapped while the handle moves.

mod choice;

use estimator_core::{Count, Sample, SteadyKalmanTriple, preset};
use haptic_control::{
    Action, AnyScene, Controller, Currents, Hold, Role, Scene, SceneKind, Senses, Switchboard,
    SwitchboardState, Torque, Viscous, scenes,
};

use crate::bench::{DEVICE, HANDLE, LARGE, Large, RATE, RIG, SCENES, motion, usual};

type Board = Switchboard<Large, SteadyKalmanTriple>;
type State = SwitchboardState<Large, SteadyKalmanTriple>;

fn board() -> Board {
    Switchboard::new(LARGE, HANDLE, RIG, RATE)
}

/// Whether the scene commands currents directly, past the slew limits.
fn steps(scene: &AnyScene) -> bool {
    scene.kind().facts().role == Role::Excitation
}

/// Runs a scene in a controller of its own and in the switchboard.
fn same_bits_alone_and_in_the_switchboard<S>(kind: SceneKind, scene: S)
where
    S: Scene<Acceleration: Senses<SteadyKalmanTriple>> + Into<AnyScene> + Copy,
{
    let alone = Controller::new(scene, LARGE, HANDLE, &RIG);
    let board = board();
    let first = motion(0);
    let (mut one, mut other) = (alone.start(&first), board.start(&first));
    board.select(&mut other, scene.into(), &first);
    // The switchboard fades in the current with which a vibration or an excitation begins.
    let fades = scene.vibration().0 > 0.0 || steps(&scene.into());
    for k in 0..20_000 {
        let sample = motion(k);
        let (one, other) = (
            alone.step(&mut one, &sample),
            board.step(&mut other, &sample),
        );
        let bits = |action: &Action| {
            [
                action.torque.0,
                action.large_velocity.0,
                action.handle_velocity.0,
            ]
            .map(f32::to_bits)
        };
        assert_eq!(bits(&one), bits(&other), "{kind} at {k}");
        if !fades {
            assert_eq!(one.currents, other.currents, "{kind} at {k}");
        }
    }
}

#[test]
fn every_scene_has_the_same_bits_alone_and_in_the_switchboard() {
    macro_rules! check {
        ($($number:literal, $name:literal, $scene:ident, $facts:tt;)+) => {
            $(same_bits_alone_and_in_the_switchboard(
                SceneKind::$scene,
                haptic_control::$scene::usual(&DEVICE, RATE).unwrap(),
            );)+
        };
    }
    scenes!(check);
}

#[test]
fn swapping_scenes_does_not_make_the_currents_jump() {
    let board = board();
    // What a tick of the scenes themselves may do, the slew limits of 1200 and 600 A/s, and a 200th
    // of what fades: at most the excitation's currents.
    let slew = [0.12 + 0.9 / 200.0, 0.06 + 0.3 / 200.0];
    let mut wanted = Vec::new();
    for from in SCENES {
        for to in SCENES {
            // In the wall, moving; the swap is at 4500.
            let mut state = board.start(&motion(2000));
            board.select(&mut state, from, &motion(2000));
            let mut before = board.step(&mut state, &motion(2000)).currents;
            for k in 2001..6000 {
                if k == 4500 {
                    board.select(&mut state, to, &motion(k - 1));
                }
                let now = board.step(&mut state, &motion(k)).currents;
                let moved = [
                    now.large.get() - before.large.get(),
                    now.small.get() - before.small.get(),
                ];
                if k == 4500 {
                    wanted.push(before.small.get());
                    assert!(
                        moved.iter().all(|s| s.abs() < 1e-6),
                        "{from:?} {to:?}: {moved:?}"
                    );
                }
                let checked = !steps(if k < 4500 { &from } else { &to });
                for (step, slew) in moved.iter().zip(slew).filter(|_| checked) {
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
fn scene_after_a_change_equals_one_that_was_always_active() {
    let board = board();
    for from in SCENES {
        let mut swapped = board.start(&motion(0));
        let mut always = board.start(&motion(0));
        board.select(&mut swapped, from, &motion(0));
        board.select(&mut always, usual(SceneKind::Detents), &motion(0));
        for k in 0..3000 {
            board.step(&mut swapped, &motion(k));
            board.step(&mut always, &motion(k));
        }
        board.select(&mut swapped, usual(SceneKind::Detents), &motion(2999));
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

/// Counts of a handle that moved on by 100 counts a tick while it was off.
fn far(k: u32) -> Sample {
    Sample::new(Count(k.wrapping_mul(7))).with_coupled(Count(k.wrapping_mul(100)))
}

/// The first actions of `scene` after ticks of one without a velocity, in which both encoders move.
fn after_idle(scene: AnyScene, idle: SceneKind, before: Option<AnyScene>) -> Vec<Action> {
    let board = board();
    let mut state = board.start(&far(0));
    for k in 0..4000 {
        if k == 500 {
            board.select(&mut state, before.unwrap_or(usual(idle)), &far(k));
        }
        if k == 1000 {
            board.select(&mut state, usual(idle), &far(k));
        }
        board.step(&mut state, &far(k));
    }
    board.select(&mut state, scene, &far(3999));
    (4000..4050)
        .map(|k| board.step(&mut state, &far(k)))
        .collect()
}

#[test]
fn estimator_that_was_not_needed_starts_at_rest() {
    // The same whatever ran before, also when the currents of the change fade, and no velocity from the counts
    // of a second.
    for scene in [
        usual(SceneKind::FreeAir),
        usual(SceneKind::SpringDamper),
        usual(SceneKind::Viscous),
        usual(SceneKind::Inertia),
    ] {
        // No part runs in off, and the small motor alone in detents.
        for idle in [SceneKind::Off, SceneKind::Detents] {
            starts_at_rest(scene, idle);
        }
    }
}

fn starts_at_rest(scene: AnyScene, idle: SceneKind) {
    let fresh = after_idle(scene, idle, None);
    for before in [
        None,
        Some(usual(SceneKind::FreeAir)),
        Some(usual(SceneKind::SpringDamper)),
        Some(usual(SceneKind::Inertia)),
    ] {
        let name = format!("{scene:?} after {idle:?} after {before:?}");
        let actions = after_idle(scene, idle, before);
        // Less than 2e-6 A are left of what an earlier change added.
        for (action, other) in actions.iter().zip(&fresh) {
            let [found, fresh] = [action, other].map(|action| action.currents.large.get());
            assert!((found - fresh).abs() < 1e-5, "{name}: {found} {fresh} A");
        }
        let first = &actions[0];
        let velocities = (first.large_velocity.0, first.handle_velocity.0);
        assert_eq!(velocities, (0.0, 0.0), "{name}");
        // What the currents fade by is over.
        let large = first.currents.large.get();
        assert!(large.abs() < 1e-4, "{name}: {large} A");
    }
}

#[test]
fn estimator_that_both_scenes_need_continues() {
    let board = board();
    let (mut swapped, mut kept) = (board.start(&far(0)), board.start(&far(0)));
    for state in [&mut swapped, &mut kept] {
        board.select(state, usual(SceneKind::Viscous), &far(0));
    }
    for k in 0..1000 {
        if k == 500 {
            board.select(&mut swapped, usual(SceneKind::SpringDamper), &far(499));
        }
        let (one, other) = (
            board.step(&mut swapped, &far(k)),
            board.step(&mut kept, &far(k)),
        );
        assert_eq!(
            (one.large_velocity, one.handle_velocity),
            (other.large_velocity, other.handle_velocity),
            "{k}"
        );
        assert!(k < 100 || one.handle_velocity.0 > 100.0);
    }
}

/// A handle that turned at a constant velocity before a scene without a spring: nothing is anticipated.
#[test]
fn a_scene_without_a_spring_continues_the_velocity() {
    let (board, even) = (board(), |k: u32| {
        Sample::new(Count(k)).with_coupled(Count(5 * k))
    });
    let mut state = board.start(&even(0));
    board.select(
        &mut state,
        AnyScene::from(Torque::new(0.0).unwrap()),
        &even(0),
    );
    let currents: Vec<f32> = (0..5000)
        .map(|k| {
            if k == 4000 {
                board.select(&mut state, usual(SceneKind::FreeAir), &even(k - 1));
            }
            board.step(&mut state, &even(k)).currents.large.get()
        })
        .collect();
    // The regulator integrates its error at a constant rate, before the change as after it.
    let slope = (currents[3999] - currents[2999]) / 1000.0;
    for (k, current) in (0_u16..).zip(&currents[3999..]) {
        let wanted = currents[3999] + slope * f32::from(k);
        assert!((current - wanted).abs() < 0.01, "{k}: {current} {wanted} A");
    }
}

#[test]
fn restart_equals_a_start_and_unneeded_estimates_are_absent() {
    let board = board();
    for scene in SCENES {
        let mut restarted = board.start(&far(0));
        assert!(!restarted.estimates_large());
        board.select(&mut restarted, scene, &far(0));
        for k in 0..300 {
            board.step(&mut restarted, &far(k));
        }
        let rendered = scene.kind().facts().needs.continuous;
        assert_eq!(restarted.estimates_large(), rendered, "{scene:?}");
        board.restart(&mut restarted, &far(300));
        assert!(!restarted.estimates_large());
        let mut fresh = board.start(&far(300));
        // Off, and then as if nothing had been before.
        for state in [&mut restarted, &mut fresh] {
            assert_eq!(board.step(state, &far(300)).currents, Currents::default());
            board.select(state, scene, &far(300));
        }
        for k in 301..600 {
            let actions = [&mut restarted, &mut fresh].map(|state| board.step(state, &far(k)));
            assert_eq!(actions[0], actions[1], "{scene:?} {k}");
        }
    }
}

fn at(angle: i32) -> Sample {
    Sample::default().with_coupled(Count(angle as u32))
}

fn run(board: &Board, state: &mut State, sample: &Sample, ticks: u32) -> Action {
    (0..ticks).fold(Action::default(), |_, _| board.step(state, sample))
}

#[test]
fn hold_position_is_that_of_the_selection() {
    let board = board();
    const HOLD: Hold = preset!(Hold::new(0.2, 0.0));
    const ANGLE: f32 = 0.314_159_27;
    for began in [1000, -3000] {
        let mut state = board.start(&at(0));
        board.select(&mut state, AnyScene::Hold(HOLD), &at(began));
        let torque = run(&board, &mut state, &at(began), 5000).torque.0;
        assert_eq!(torque, 0.0, "{began}");
        for moved in [1000, -1000] {
            let torque = run(&board, &mut state, &at(began + moved), 20_000).torque.0;
            let wanted = -0.2 * ANGLE * moved.signum() as f32;
            assert!((torque - wanted).abs() < 1e-5, "{began} {moved}: {torque}");
        }
        // Tuned, it holds the same place.
        const STIFFER: Hold = preset!(Hold::new(0.3, 0.0));
        board.retune(&mut state, AnyScene::Hold(STIFFER));
        let torque = run(&board, &mut state, &at(began + 1000), 20_000).torque.0;
        assert!((torque + 0.3 * ANGLE).abs() < 1e-5, "{began}: {torque}");
    }
}

#[test]
fn swaps_of_saturated_scenes_stay_within_the_limits() {
    let board = board();
    let torque = |torque| AnyScene::Torque(Torque::new(torque).unwrap());
    let mut state = board.start(&at(0));
    let mut largest = [0.0_f32; 2];
    for k in 0..20_000 {
        // A scene that starts anew wants its whole current while the one before still fades.
        match k % 1000 {
            0 => board.select(
                &mut state,
                torque(if k < 10_000 { 1.0 } else { -1.0 }),
                &at(0),
            ),
            999 => board.select(&mut state, usual(SceneKind::Off), &at(0)),
            _ => {}
        }
        let Currents { large, small } = board.step(&mut state, &at(0)).currents;
        for (largest, now) in largest.iter_mut().zip([large, small]) {
            *largest = largest.max(now.get().abs());
        }
    }
    let limits = [DEVICE.large.current_limit, DEVICE.small.current_limit];
    assert_eq!(largest.map(f64::from), limits);
}

#[test]
fn jump_of_a_change_decays_with_20_ms() {
    // Off is no current at all: what is left is the difference.
    let board = board();
    let mut state = board.start(&at(0));
    board.select(&mut state, usual(SceneKind::Hold), &at(0));
    let before = run(&board, &mut state, &at(500), 3000).currents;
    assert!(before.small.get() < -0.1 && before.large.get() < -0.1);
    board.select(&mut state, usual(SceneKind::Off), &at(500));
    for k in 0..1000 {
        let now = board.step(&mut state, &at(500)).currents;
        // A backward difference of the exponential, half a tick late at most.
        let part = (-f64::from(k) / 200.0).exp();
        for (now, before) in [(now.large, before.large), (now.small, before.small)] {
            let wanted = part * f64::from(before.get());
            assert!((f64::from(now.get()) - wanted).abs() < 2e-3 * f64::from(before.get().abs()));
        }
    }
}

/// As of a device that is stopped: the next scene begins without a current.
#[test]
fn withheld_currents_fade_into_no_scene() {
    let board = board();
    let mut state = board.start(&at(0));
    board.select(&mut state, usual(SceneKind::Hold), &at(0));
    let before = run(&board, &mut state, &at(500), 3000).currents;
    assert!(before.small.get() < -0.1 && state.applied() == before);
    state.withhold();
    assert_eq!(state.applied(), Currents::default());
    board.select(&mut state, usual(SceneKind::Off), &at(500));
    let after = board.step(&mut state, &at(500)).currents;
    // What was still being faded in at the selection is less than 1 uA by now.
    assert!(
        [after.large, after.small]
            .iter()
            .all(|current| current.get().abs() < 1e-6)
    );
}

#[test]
fn parameters_of_another_scene_are_refused() {
    let board = board();
    let stiff = AnyScene::Viscous(Viscous::new(5e-3).unwrap());
    let mut state = board.start(&at(0));
    board.select(&mut state, usual(SceneKind::Wall), &at(0));
    let mut same = state.clone();
    board.retune(&mut state, stiff);
    for k in 0..2000 {
        let actions = [&mut state, &mut same].map(|state| board.step(state, &at(k)));
        assert_eq!(actions[0], actions[1], "{k}");
    }
}
