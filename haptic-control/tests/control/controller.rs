//! The controller of one scene: its states, copied, compared and started again.

use std::f64::consts::TAU;

use estimator_core::{
    Count, FiniteDifference, Handover, Hertz, Sample, Side, SteadyKalmanTriple, VelocityEstimator,
    preset,
};
use haptic_control::{
    Controller, ControllerState, Detents, FreeAir, Hold, Inertia, NewtonMetres, Off, RadPerS,
    Scene, Senses, Texture, Torque, Viscous,
};

use crate::bench::{DEVICE, HANDLE, LARGE, Large, RATE, RIG};

type Of<S> = Controller<S, Large, SteadyKalmanTriple>;
type StateOf<S> = ControllerState<S, Large, SteadyKalmanTriple>;

fn sample(k: u32) -> Sample {
    Sample::new(Count(k / 3)).with_coupled(Count(k * k / 50))
}

/// Runs over ticks of a motion.
fn run<S>(controller: &Of<S>, state: &mut StateOf<S>, ticks: std::ops::Range<u32>)
where
    S: Scene<Acceleration: Senses<SteadyKalmanTriple>>,
{
    for k in ticks {
        controller.step(state, &sample(k));
    }
}

fn a_restart_is_a_start_and_copies_are_equal_until_they_move_apart<S>(scene: S)
where
    S: Scene<Acceleration: Senses<SteadyKalmanTriple>> + Copy,
{
    let controller = Controller::new(scene, LARGE, HANDLE, &RIG);
    let mut state = controller.start(&sample(0));
    run(&controller, &mut state, 0..300);
    let mut copy = state.clone();
    assert!(copy == state);
    run(&controller, &mut copy, 300..310);
    run(&controller, &mut state, 300..310);
    assert!(copy == state);

    controller.restart(&mut state, &sample(310));
    let mut fresh = controller.start(&sample(310));
    assert!(state == fresh);
    for k in 310..600 {
        let actions = [&mut state, &mut fresh].map(|state| controller.step(state, &sample(k)));
        assert_eq!(actions[0], actions[1], "{k}");
    }
}

#[test]
fn restarted_and_copied_states_are_equal_in_every_scene() {
    use a_restart_is_a_start_and_copies_are_equal_until_they_move_apart as check;
    macro_rules! check_all {
        ($($number:literal, $name:literal, $scene:ident, $facts:tt;)+) => {
            $(check(haptic_control::$scene::usual(&DEVICE, RATE).unwrap());)+
        };
    }
    haptic_control::scenes!(check_all);
}

/// Which of two states' parts is looked at: a part that differs alone makes them differ.
#[test]
fn states_with_one_different_part_are_different() {
    let start = |controller: &Of<Viscous>, at: u32| controller.start(&sample(at));
    let viscous = Controller::new(Viscous::new(2e-3).unwrap(), LARGE, HANDLE, &RIG);
    let (origin, other) = (Sample::default(), Sample::default().with_coupled(Count(1)));
    // The origin, in a scene that has nothing else.
    let off = Controller::new(Off, LARGE, HANDLE, &RIG);
    assert!(off.start(&origin) != off.start(&other));
    // The large motor's estimator: the same handle.
    let large = Sample::new(Count(1));
    assert!(viscous.start(&origin) != viscous.start(&large));
    assert!(start(&viscous, 0) == start(&viscous, 0));
    // The handle's estimator, in a scene without a large motor: as many ticks, another motion.
    let mut states = [viscous.start(&origin), viscous.start(&origin)];
    viscous.step(&mut states[0], &other);
    viscous.step(&mut states[1], &origin);
    assert!(states[0] != states[1]);
    // The transient stage: the current before differs.
    let detents = Controller::new(Detents::new(8e-3, 24).unwrap(), LARGE, HANDLE, &RIG);
    let mut states = [detents.start(&origin), detents.start(&origin)];
    detents.step(&mut states[0], &other);
    detents.step(&mut states[1], &origin);
    assert!(states[0] != states[1]);
    // The scene's own state.
    let texture = Texture::new(0.0, Hertz(150.0), RATE).unwrap();
    let texture = Controller::new(texture, LARGE, HANDLE, &RIG);
    let mut states = [texture.start(&origin), texture.start(&origin)];
    texture.step(&mut states[0], &origin);
    assert!(states[0] != states[1]);
}

type Both = Handover<FiniteDifference, Large>;
const BOTH: Both = preset!(Handover::new(FiniteDifference, LARGE, 10, 10));

#[test]
fn large_estimator_runs_if_the_scene_needs_it() {
    let here = Sample::default();
    let viscous = Controller::new(Viscous::new(2e-3).unwrap(), BOTH, HANDLE, &RIG);
    let mut state = viscous.start(&here);
    type State = <Both as VelocityEstimator>::State;
    let in_charge = |state: Option<&State>| state.and_then(State::in_charge);
    assert_eq!(in_charge(state.large()), Some(Side::First));
    state.large_mut().unwrap().select(Side::Second);
    for _ in 0..50 {
        viscous.step(&mut state, &here);
    }
    assert_eq!(in_charge(state.large()), Some(Side::Second));
    // The choice outlasts a restart.
    viscous.restart(&mut state, &here);
    assert_eq!(in_charge(state.large()), Some(Side::Second));

    let detents = Controller::new(Detents::new(8e-3, 24).unwrap(), BOTH, HANDLE, &RIG);
    let mut state = detents.start(&here);
    assert!(state.large().is_none() && state.large_mut().is_none());
}

#[test]
fn retuned_parameters_act_at_the_next_tick_and_the_state_goes_on() {
    let mut controller = Controller::new(Hold::new(0.2, 0.0).unwrap(), LARGE, HANDLE, &RIG);
    let mut state = controller.start(&Sample::default());
    let there = Sample::default().with_coupled(Count(1000));
    let before = controller.step(&mut state, &there).torque.0;
    controller.retune(Hold::new(0.1, 0.0).unwrap());
    let after = controller.step(&mut state, &there).torque.0;
    assert!((after / before - 0.5).abs() < 1e-6 && before < -0.06);
}

/// A scene of no torque, rendered by both stages as their formulas say.
fn rendered_without_torque<S>(scene: S, free: bool)
where
    S: Scene<Acceleration: Senses<FiniteDifference>>,
{
    let controller = Controller::new(scene, FiniteDifference, FiniteDifference, &RIG);
    let mut state = controller.start(&Sample::default());
    let still = RadPerS(0.0);
    let (mut large, mut small) = (RIG.continuous.start(still), RIG.transient.start());
    let compensation = if free { RIG.free } else { RIG.sprung };
    let mut compensated = compensation.start(still);
    for k in 0..500 {
        let action = controller.step(&mut state, &sample(k));
        let [motor, handle] = [action.large_velocity, action.handle_velocity];
        let ahead = compensation.update(&mut compensated, handle);
        let none = NewtonMetres(0.0);
        let driven = RIG
            .continuous
            .update(&mut large, none, motor, handle, &ahead);
        assert_eq!(action.currents.large, driven.current, "{k}");
        let asked = NewtonMetres(0.0 - (driven.coupled.0 - ahead.friction.0));
        let current = RIG.transient.update(&mut small, asked);
        assert_eq!(action.currents.small, current, "{k}");
    }
}

#[test]
fn more_is_compensated_in_scenes_without_a_spring() {
    rendered_without_torque(FreeAir, true);
    rendered_without_torque(Torque::new(0.0).unwrap(), false);
}

/// In free air at a constant velocity the small motor takes the torque of a large motor that does not follow
/// off, in part, and feeds its friction forward.
#[test]
fn slip_is_the_large_motors_velocity_minus_the_handles() {
    let free = Controller::new(FreeAir, FiniteDifference, FiniteDifference, &RIG);
    for (large, handle) in [(1, 3), (1, -3), (-2, 10), (0, 5), (2, 0)] {
        let at = |k: i32| {
            Sample::new(Count((large * k) as u32)).with_coupled(Count((handle * k) as u32))
        };
        let mut state = free.start(&at(0));
        let action = (1..3000).fold(free.step(&mut state, &at(0)), |_, k| {
            free.step(&mut state, &at(k))
        });
        let turn = std::f64::consts::TAU * RATE.0;
        let speeds = [
            f64::from(large) / 4096.0 * turn,
            f64::from(handle) / 20_000.0 * turn,
        ];
        assert!((f64::from(action.large_velocity.0) - speeds[0]).abs() < 1e-4);
        assert!((f64::from(action.handle_velocity.0) - speeds[1]).abs() < 1e-4);
        let driven = (speeds[1] / 6.0).clamp(-1.0, 1.0).powi(4);
        let direction = (speeds[1] / 0.05).clamp(-1.0, 1.0);
        let friction = DEVICE.small.coulomb_friction * direction * (1.0 - driven / 2.0);
        // The handle never turned back. The large motor is commanded its velocity: all is tracking error.
        let part = 0.5 + 0.2 * (1.0 - driven);
        let torque = friction - part * DEVICE.damping * (speeds[0] - speeds[1]);
        let wanted = torque / DEVICE.small.torque_constant;
        let small = f64::from(action.currents.small.get());
        assert!(
            (small - wanted).abs() < 1e-5,
            "{large} {handle}: {small} {wanted}"
        );
    }
}

/// Half of the handle's own inertia is added at 200 rad/s².
#[test]
fn inertia_renders_the_acceleration_of_the_handle() {
    const ADDED: f64 = 2.5e-6;
    const ACCELERATION: f64 = 200.0;
    let scene = Inertia::new(ADDED as f32, 5e-6).unwrap();
    let controller = Controller::new(scene, LARGE, HANDLE, &RIG);
    let mut state = controller.start(&Sample::default());
    let torques = (0..5000).map(|k| {
        let t = f64::from(k) / RATE.0;
        let counts = 0.5 * ACCELERATION * t * t * f64::from(DEVICE.small.counts_per_rev) / TAU;
        let sample = Sample::default().with_coupled(Count(counts as u32));
        f64::from(controller.step(&mut state, &sample).torque.0)
    });
    // The mean of the last tenth of a second.
    let torque = torques.skip(4000).sum::<f64>() / 1000.0;
    let expected = -ADDED * ACCELERATION;
    assert!(
        (torque / expected - 1.0).abs() < 0.01,
        "{torque} {expected}"
    );
}
