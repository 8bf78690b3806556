//! Scenes by their numbers, of the image of all scenes.
#![cfg(not(one_scene))]

use drivers::{Command, encode};
use estimator_core::ParameterErrors;
use firmware_app::config::EDGES;
use firmware_app::large::Learnable as _;
use firmware_app::scene::SCENES;
use haptic_control::{Mode, Request, Stop};

use crate::bench::{Bench, messages, ticks};

/// A set-point beyond what the small motor renders, 1.5 A at 27.5 mN.m/A, is refused.
#[test]
fn torque_ends_with_the_small_motor() {
    for (torque, renders) in [(0.0412, true), (0.0413, false)] {
        let taken = messages(&[encode(Command::Torque(torque))]);
        assert_eq!(!taken.is_empty(), renders, "{torque}");
    }
}

/// Position, stiffness and damping of the wall.
#[test]
fn parameters_end_at_their_bounds() {
    for (parameter, bound) in [(0, 6.3), (1, 0.35), (2, 5e-3)] {
        for (value, is_taken) in [(bound, true), (1.001 * bound, false)] {
            let tune = Command::Tune {
                scene: 2,
                parameter,
                value,
            };
            let taken = !messages(&[encode(tune)]).is_empty();
            assert_eq!(taken, is_taken, "{parameter}: {value}");
        }
    }
}

/// Turns the handle to an angle at a constant velocity, rad/s.
fn turn(bench: &mut Bench, to: f64, velocity: f64) {
    let step = velocity / 1e4;
    while (to - bench.handle) * step > 0.0 {
        bench.handle += step;
        bench.request(Request::KeepAlive);
    }
}

/// Turns the handle to an angle and keeps it there until its velocity is zero.
fn rest(bench: &mut Bench, at: f64) {
    turn(bench, at, if at < bench.handle { -2.0 } else { 2.0 });
    bench.run(ticks(0.1));
}

fn send(bench: &mut Bench, command: Command) {
    for message in messages(&[encode(command)]) {
        let request = bench.control.accept(Some(message)).expect("a request");
        bench.request(request);
    }
}

fn near(is: f64, should: f64, within: f64) {
    assert!((is - should).abs() <= within, "{is} is not {should}");
}

/// Turns the handle by a rad in scene hold, where the small motor has its largest current, and counts
/// the ticks until the device stops.
fn ticks_to_overload(bench: &mut Bench) -> u32 {
    let to = bench.handle + 1.0;
    turn(bench, to, 10.0);
    let mut held = 0;
    while bench.state().0 == Mode::Running {
        bench.run(1);
        held += 1;
        assert!(held < ticks(4.0), "twice the time from the cold");
    }
    assert_eq!(bench.state(), (Mode::Safe, Stop::Overload));
    held
}

#[test]
fn arming_does_not_cool_the_windings() {
    let mut bench = Bench::start(7);
    let cold = ticks_to_overload(&mut bench);
    for _ in 0..2 {
        bench.request(Request::Disarm);
        // A winding that is too hot refuses arming, in every tick.
        assert_eq!(bench.request(Request::Arm), None);
        assert_eq!(bench.state(), (Mode::Safe, Stop::Overload));
        bench.wait(ticks(0.1));
        assert!(bench.request(Request::Arm).is_some());
        bench.request(Request::Select(7));
        bench.run(ticks(0.1));
        // A quarter of a second without current cools a winding of 14 s by two hundredths.
        let warm = ticks_to_overload(&mut bench);
        assert!(warm < cold / 10, "{warm} of {cold} ticks");
    }
}

/// The large motor turns by its current and the coupler's pull, and the handle's encoder says where the coupler
/// pulls it.
#[test]
fn handle_that_counts_backwards_does_not_balance_the_torques() {
    for (backwards, end) in [
        (false, (Mode::Running, Stop::None)),
        (true, (Mode::Safe, Stop::TorqueBalance)),
    ] {
        let mut bench = Bench::start(1);
        bench.backwards = backwards;
        for _ in 0..3 {
            turn(&mut bench, 2.0, 8.0);
            turn(&mut bench, -2.0, -8.0);
        }
        assert_eq!(bench.state(), end, "{backwards}");
    }
}

// A count of the handle is 0.3 mrad, so 0.3 N.m/rad make 0.1 mN.m of it.

#[test]
fn torques_of_scenes_1_to_7_and_9_agree_with_the_host_simulation() {
    let mut wall = Bench::start(2);
    rest(&mut wall, 0.15);
    near(wall.torque_mnm(), -300.0 * 0.05, 0.2);
    let mut spring = Bench::start(3);
    rest(&mut spring, 0.15);
    near(spring.torque_mnm(), -100.0 * 0.15, 0.1);
    let mut viscous = Bench::start(4);
    turn(&mut viscous, 0.4, 4.0);
    near(viscous.torque_mnm(), -2.0 * 4.0, 0.2);
    let mut hold = Bench::start(7);
    rest(&mut hold, 0.05);
    near(hold.torque_mnm(), -200.0 * 0.05, 0.2);
    for (scene, amplitude) in [(1, 0.0), (5, 8.0), (6, 6.0)] {
        let mut bench = Bench::start(scene);
        let mut largest = 0.0_f64;
        for _ in 0..4000 {
            bench.handle += 3e-4;
            bench.request(Request::KeepAlive);
            largest = largest.max(bench.torque_mnm().abs());
        }
        near(largest, amplitude, 0.01 * amplitude);
    }
    // A negative inertia pushes with the acceleration: 2e-6 kg.m2 by 500 rad/s2 are 1 mN.m.
    let mut inertia = Bench::start(9);
    let mut mean = 0.0;
    for k in 0..400 {
        inertia.handle = 250.0 * (f64::from(k) * 1e-4).powi(2);
        inertia.request(Request::KeepAlive);
        if k >= 300 {
            mean += inertia.torque_mnm() / 100.0;
        }
    }
    near(mean, 1.0, 0.1);
}

#[test]
fn free_air_estimates_and_off_does_not() {
    let mut off = Bench::start(0);
    turn(&mut off, 0.1, 4.0);
    assert_eq!(off.state().0, Mode::Armed);
    assert_eq!(off.control.applied().large.get(), 0.0);
    assert_eq!(
        (
            off.record().action.handle_velocity.0,
            off.record().estimation.number
        ),
        (0.0, None)
    );
    let mut air = Bench::start(1);
    turn(&mut air, 0.1, 4.0);
    near(air.record().action.handle_velocity.0.into(), 4.0, 0.4);
    assert_ne!(air.control.applied().large.get(), 0.0);
    assert!(air.record().estimation.variance.0 > 0.0);
}

#[test]
fn unknown_scene_number_changes_nothing() {
    let mut bench = Bench::start(3);
    rest(&mut bench, 0.15);
    bench.request(Request::Select(SCENES));
    bench.run(ticks(0.05));
    near(bench.torque_mnm(), -100.0 * 0.15, 0.1);
}

#[test]
fn set_point_acts_only_while_its_scene_is_on() {
    let mut bench = Bench::new();
    send(&mut bench, Command::Torque(0.003));
    bench.request(Request::Select(8));
    bench.request(Request::Arm);
    bench.run(ticks(0.05));
    assert_eq!(bench.torque_mnm(), 0.0);
    send(&mut bench, Command::Torque(0.003));
    bench.run(ticks(0.05));
    near(bench.torque_mnm(), 3.0, 1e-6);
    // Off and on again it begins at zero.
    bench.request(Request::Select(0));
    bench.run(ticks(0.05));
    bench.request(Request::Select(8));
    bench.run(ticks(0.05));
    assert_eq!(bench.torque_mnm(), 0.0);
}

#[test]
fn parameters_act_on_the_active_scene_and_persist_over_disarm() {
    let mut bench = Bench::start(3);
    rest(&mut bench, 0.1);
    let stiffness = |scene, value| Command::Tune {
        scene,
        parameter: 1,
        value,
    };
    // Another scene's parameter leaves this one as it is.
    send(&mut bench, stiffness(2, 0.2));
    bench.run(ticks(0.05));
    near(bench.torque_mnm(), -100.0 * 0.1, 0.1);
    send(&mut bench, stiffness(3, 0.05));
    bench.run(ticks(0.05));
    near(bench.torque_mnm(), -50.0 * 0.1, 0.1);
    bench.request(Request::Disarm);
    bench.handle = 0.0;
    bench.request(Request::Select(3));
    bench.request(Request::Arm);
    bench.run(ticks(0.05));
    rest(&mut bench, 0.2);
    near(bench.torque_mnm(), -50.0 * 0.2, 0.3);
    bench.request(Request::Select(2));
    bench.run(ticks(0.05));
    near(bench.torque_mnm(), -200.0 * 0.1, 0.3);
}

#[test]
fn selected_estimator_persists_over_restarts() {
    let number = |bench: &Bench| bench.record().estimation.number;
    let mut bench = Bench::start(1);
    if number(&bench) != Some(0) || messages(&[encode(Command::Estimator(1))]).is_empty() {
        return;
    }
    send(&mut bench, Command::Estimator(1));
    assert_eq!(number(&bench), None);
    bench.run(400);
    assert_eq!(number(&bench), Some(1));
    bench.request(Request::Disarm);
    bench.request(Request::Select(1));
    bench.request(Request::Arm);
    bench.run(ticks(0.05));
    assert_eq!(number(&bench), Some(1));
}

#[test]
fn record_has_the_learned_parameters() {
    // A wall lets the coupler slip.
    let mut bench = Bench::start(2);
    for to in [0.2, 0.25, 0.2, 0.3].into_iter().cycle().take(40) {
        rest(&mut bench, to);
    }
    assert_eq!(bench.state().0, Mode::Running);
    // Nothing by an estimator that does not learn.
    let learned = bench.record().learned.deviations();
    assert_eq!(learned.is_some(), cfg!(feature = "large-adaptive"));
    // An image with edge capture learns nothing here, because no edge is stamped.
    assert_eq!(
        learned == Some(ParameterErrors::default()),
        learned.is_some() && EDGES
    );
}
