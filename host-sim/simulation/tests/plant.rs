//! Tests of the plant against closed forms, half the step, and the energy balance.

use simulation::device::Device;
use simulation::plant::{Grip, HandMotion, Plant, Pose, steps_per_tick};
use std::f64::consts::TAU;

const STEP_S: f64 = 10e-6;

fn smooth() -> Device {
    let mut device = Device::default().frictionless();
    device.large_ripple.torque = 0.0;
    device.small_ripple.torque = 0.0;
    device
}

fn spinning(omega: f64) -> Pose {
    Pose { angle: 0.0, omega }
}

/// Runs `steps` steps from now, all in one tick.
fn run(plant: &mut Plant, grip: &Grip, steps: u32, step_s: f64) {
    for k in 0..steps {
        plant.step(grip, f64::from(k) * step_s, 0.0);
    }
}

#[test]
fn free_decay_agrees_with_the_closed_form() {
    let device = smooth();
    let (b, jl, js) = (
        device.stages.damping,
        device.stages.large.inertia,
        device.stages.small.inertia,
    );
    let t = 0.02;
    let steps = (t / STEP_S).round() as u32;

    // Both free: slip decays with b (1/J_L + 1/J_S), momentum stays.
    let mut plant = Plant::new(&device, STEP_S);
    plant.place(spinning(20.0), spinning(-5.0));
    run(&mut plant, &Grip::Free, steps, STEP_S);
    let slip = 25.0 * (-b * (1.0 / jl + 1.0 / js) * t).exp();
    let mean = (20.0 * jl - 5.0 * js) / (jl + js);
    let large = mean + slip * js / (jl + js);
    let small = mean - slip * jl / (jl + js);
    assert!((plant.large().omega - large).abs() < 1e-5, "{plant:?}");
    assert!((plant.small().omega - small).abs() < 1e-5, "{plant:?}");

    // Clamped: the large motor alone, and the angle that it covers.
    let mut plant = Plant::new(&device, STEP_S);
    plant.place(spinning(20.0), spinning(3.0));
    run(&mut plant, &Grip::Clamped, steps, STEP_S);
    let left = (-b / jl * t).exp();
    assert!((plant.large().omega - 20.0 * left).abs() < 1e-5);
    assert!((plant.large().angle - 20.0 * jl / b * (1.0 - left)).abs() < 1e-7);
    assert_eq!(plant.small(), spinning(0.0));
}

#[test]
fn amplifier_is_an_exact_lag_and_saturates() {
    let device = Device::default();
    let mut plant = Plant::new(&device, STEP_S);
    plant.command(100.0, -100.0);
    assert_eq!(plant.commands(), (6.0, -1.5));
    run(&mut plant, &Grip::Clamped, 8, STEP_S);
    let reached = 1.0 - (-8.0 * STEP_S * TAU * device.stages.amplifier_bandwidth.0).exp();
    assert!((plant.currents().0 - 6.0 * reached).abs() < 1e-12);
    assert!((plant.currents().1 + 1.5 * reached).abs() < 1e-12);
}

#[test]
fn constant_current_settles_where_friction_and_coupler_balance_it() {
    let mut device = Device::default();
    device.large_ripple.torque = 0.0;
    device.large_ripple.friction = 0.0;
    for current in [-0.7, 0.2, 0.9_f64] {
        let mut plant = Plant::new(&device, STEP_S);
        plant.command(current, 0.0);
        run(&mut plant, &Grip::Clamped, 40_000, STEP_S);
        let torque = device.stages.large.torque_constant * current.abs();
        let settled = (torque - device.stages.large.coulomb_friction) / device.stages.damping;
        let expected = settled.copysign(current);
        assert!((plant.large().omega - expected).abs() < 1e-9, "{current} A");
        // What the clamp feels is the coupler's torque.
        let felt = plant.handle_torque(&Grip::Clamped, 0.0);
        assert!((felt - device.stages.damping * expected).abs() < 1e-12);
    }
}

#[test]
fn motor_does_not_move_below_its_friction() {
    let device = Device::default();
    // The ripple of friction takes 10 % at most, that of torque adds 1.5 %.
    let holds = 0.88 * device.stages.large.coulomb_friction / device.stages.large.torque_constant;
    let moves = 1.13 * device.stages.large.coulomb_friction / device.stages.large.torque_constant;
    for angle in [0.0, 1.0, 4.7] {
        let at = Pose { angle, omega: 0.0 };
        for current in [holds, -holds] {
            let mut plant = Plant::new(&device, STEP_S);
            plant.place(at, Pose::default());
            plant.command(current, 0.0);
            run(&mut plant, &Grip::Clamped, 20_000, STEP_S);
            assert_eq!(plant.large(), at);
        }
        let mut plant = Plant::new(&device, STEP_S);
        plant.place(at, Pose::default());
        plant.command(moves, 0.0);
        run(&mut plant, &Grip::Clamped, 20_000, STEP_S);
        assert!(plant.large().omega > 0.0);
    }
}

#[test]
fn friction_stops_a_free_shaft_at_the_closed_forms_time() {
    let mut device = Device::default();
    device.large_ripple.friction = 0.0;
    let (b, j, c) = (
        device.stages.damping,
        device.stages.large.inertia,
        device.stages.large.coulomb_friction,
    );
    let mut plant = Plant::new(&device, STEP_S);
    plant.place(spinning(5.0), Pose::default());
    // w = (w0 + c/b) exp(-b t / J) - c/b reaches 0 at J/b ln(1 + b w0 / c).
    let stop_s = j / b * (b * 5.0 / c).ln_1p();
    let stop_rad = j / b * (5.0 - c / b * (b * 5.0 / c).ln_1p());
    run(&mut plant, &Grip::Clamped, (stop_s / STEP_S) as u32, STEP_S);
    assert!(plant.large().omega > 0.0);
    run(&mut plant, &Grip::Clamped, 2, STEP_S);
    assert_eq!(plant.large().omega, 0.0);
    let angle = plant.large().angle;
    assert!((angle - stop_rad).abs() < 1e-8, "{angle} {stop_rad}");
    run(&mut plant, &Grip::Clamped, 1000, STEP_S);
    assert_eq!(plant.large().angle, angle);
}

#[test]
fn reversal_inside_a_step_agrees_with_the_closed_form() {
    let mut device = Device::default();
    device.large_ripple.friction = 0.0;
    device.large_ripple.torque = 0.0;
    let (b, j, c) = (
        device.stages.damping,
        device.stages.large.inertia,
        device.stages.large.coulomb_friction,
    );
    let mut plant = Plant::new(&device, STEP_S);
    plant.command(-0.5, 0.0);
    run(&mut plant, &Grip::Clamped, 500, STEP_S);
    let torque = device.stages.large.torque_constant * 0.5;
    for k in 0..50 {
        // Many starts, so that rest falls anywhere in a step.
        let start = 5.0 + f64::from(k) * 1e-3;
        plant.place(spinning(start), Pose::default());
        run(&mut plant, &Grip::Clamped, 1000, STEP_S);
        // J dw/dt = -torque - b w - c until rest, then -torque - b w + c.
        let before = (torque + c) / b;
        let rest_s = j / b * (start / before).ln_1p();
        let after = (torque - c) / b;
        let left = (-b / j * (0.01 - rest_s)).exp();
        let expected = -after * (1.0 - left);
        let omega = plant.large().omega;
        assert!((omega - expected).abs() < 2e-5, "{omega} {expected}");
    }
}

/// The coupler of a handle that turns backward at constant speed stops the motor and drives it back.
#[test]
fn reversal_inside_a_step_follows_the_slip_of_the_handle() {
    let mut device = Device::default();
    device.large_ripple.friction = 0.0;
    device.small_ripple.friction = 0.0;
    device.stages.small.coulomb_friction = 0.0;
    // A handle that the coupler does not slow down.
    device.stages.small.inertia = 1e3;
    let (b, j, c) = (
        device.stages.damping,
        device.stages.large.inertia,
        device.stages.large.coulomb_friction,
    );
    let handle = -20.0;
    let torque = -b * handle;
    assert!(torque > 2.0 * c, "the coupler drives the motor");
    for k in 0..50 {
        let mut plant = Plant::new(&device, STEP_S);
        let start = 5.0 + f64::from(k) * 1e-3;
        plant.place(spinning(start), spinning(handle));
        run(&mut plant, &Grip::Free, 1000, STEP_S);
        // J dw/dt = -torque - b w - c until rest, then -torque - b w + c.
        let rest_s = j / b * (b * start / (torque + c)).ln_1p();
        let left = (-b / j * (0.01 - rest_s)).exp();
        let expected = -(torque - c) / b * (1.0 - left);
        let omega = plant.large().omega;
        assert!((omega - expected).abs() < 2e-5, "{omega} {expected}");
    }
}

/// Final poses of a run of both shafts under a moving hand and alternating currents.
fn moving_run(device: &Device, step_s: f64, shrink: u32) -> [f64; 4] {
    let mut plant = Plant::new(device, step_s);
    plant.place(spinning(30.0), spinning(4.0));
    let tick_s = 1e-3;
    let pose = |t: f64| Pose {
        angle: 4.0 * t + 0.02 * (60.0 * t).sin(),
        omega: 4.0 + 1.2 * (60.0 * t).cos(),
    };
    for k in 0..100 {
        let t = f64::from(k) * tick_s;
        let grip = Grip::Hand(HandMotion::between(pose(t), pose(t + tick_s), tick_s));
        plant.command(1.0 + 0.4 * (f64::from(k) * 0.7).sin(), 0.05);
        run(&mut plant, &grip, 100 * shrink, step_s);
    }
    let (large, small) = (plant.large(), plant.small());
    [large.angle, large.omega, small.angle, small.omega]
}

#[test]
fn integration_is_of_second_order_without_sticking() {
    // With friction and all ripple: second order has to survive them.
    let device = Device::default();
    let runs = [1, 2, 4].map(|shrink| moving_run(&device, STEP_S / f64::from(shrink), shrink));
    let [whole, half, quarter] = runs;
    for ((whole, half), quarter) in whole.into_iter().zip(half).zip(quarter) {
        let (coarse, fine) = ((whole - half).abs(), (half - quarter).abs());
        assert!(coarse < 2e-6, "{coarse:e}");
        assert!(coarse > 3.0 * fine, "{coarse:e}, {fine:e}");
        assert!(coarse < 5.0 * fine, "{coarse:e}, {fine:e}");
    }
}

#[test]
fn energy_never_grows_without_input() {
    let device = Device::default();
    assert_eq!(device.hand.stiffness_nm_per_rad, 0.5);
    for friction in [true, false] {
        let device = if friction { device.clone() } else { smooth() };
        for grip in [
            Grip::Clamped,
            Grip::Free,
            Grip::Hand(HandMotion::still(0.3)),
        ] {
            let mut plant = Plant::new(&device, STEP_S);
            plant.place(spinning(-40.0), spinning(25.0));
            let energy = |plant: &Plant| {
                let stretch = match grip {
                    Grip::Hand(_) => plant.small().angle - 0.3,
                    _ => 0.0,
                };
                plant.kinetic_energy() + 0.25 * stretch * stretch
            };
            if grip == Grip::Clamped {
                plant.step(&grip, 0.0, 0.0);
            }
            let first = energy(&plant);
            let mut last = first;
            for _ in 0..60_000 {
                plant.step(&grip, 0.0, 0.0);
                let now = energy(&plant);
                assert!(
                    now <= last * (1.0 + 1e-9) + 1e-20,
                    "{grip:?}: {last:e} to {now:e}"
                );
                last = now;
            }
            if friction || grip != Grip::Free {
                assert!(last < 1e-3 * first, "{grip:?}: {last:e} of {first:e}");
            }
        }
    }
}

#[test]
fn torque_on_the_hand_is_the_balance_of_the_small_shaft() {
    let mut device = smooth();
    device.hand.damping_nms_per_rad = 4e-3;
    let mut plant = Plant::new(&device, STEP_S);
    plant.place(spinning(12.0), spinning(2.0));
    plant.command(0.6, 0.3);
    let grip = Grip::Hand(HandMotion::still(0.05));
    run(&mut plant, &grip, 500, STEP_S);
    // Kt i + b slip - J dw/dt, the derivative from one step each way.
    let before = plant.clone();
    plant.step(&grip, 0.0, 0.0);
    let at = plant.clone();
    plant.step(&grip, 0.0, 0.0);
    let slope = (plant.small().omega - before.small().omega) / (2.0 * STEP_S);
    let balance = device.stages.small.torque_constant * at.currents().1
        + device.stages.damping * (at.large().omega - at.small().omega)
        - device.stages.small.inertia * slope;
    let felt = at.handle_torque(&grip, 0.0);
    assert!(felt.abs() > 1e-3);
    assert!(
        (felt - balance).abs() < 1e-6 * felt.abs().max(1e-2),
        "{felt} {balance}"
    );
}

#[test]
fn torques_on_the_handle_have_their_causes_and_add_up() {
    let device = Device::default();
    let small = &device.stages.small;
    let moving = Pose {
        angle: 1.1,
        omega: -2.0,
    };
    let hand = Grip::Hand(HandMotion::still(0.9));
    for (start, grip) in [
        (moving, hand),
        (moving, Grip::Free),
        // At rest the hand, 10 mrad away, pushes with more and with less than the friction.
        (Pose::default(), Grip::Hand(HandMotion::still(0.010))),
        (Pose::default(), Grip::Hand(HandMotion::still(0.001))),
        (spinning(0.0), Grip::Clamped),
    ] {
        let mut plant = Plant::new(&device, STEP_S);
        plant.place(spinning(0.1), start);
        plant.command(0.0, 2e-3);
        // The amplifier settles in 80 us, during which the shafts hardly move.
        run(&mut plant, &Grip::Clamped, 400, STEP_S);
        plant.place(spinning(0.1), start);
        let at = plant.handle_torques(&grip, 0.0);
        let sum = at.motor + at.ripple + at.coupler + at.friction + at.inertia;
        assert!((sum - at.felt).abs() < 1e-15, "{grip:?}: {at:?}");
        assert_eq!(at.felt, plant.handle_torque(&grip, 0.0));
        assert!((at.motor - 27.5e-3 * 2e-3).abs() < 1e-12);
        let ripple = 0.015 * (26.0 * start.angle).sin() * at.motor;
        assert!((at.ripple - ripple).abs() < 1e-9 * at.motor, "{at:?}");
        assert_eq!(at.coupler, 0.96e-3 * (0.1 - start.omega));
        let limit = 0.8e-3 * (1.0 + 0.1 * start.angle.sin());

        plant.step(&grip, 0.0, 0.0);
        let mean_inertia = -small.inertia * (plant.small().omega - start.omega) / STEP_S;
        // The acceleration changes within the step: by the hand's damping, 3 mN.m.s/rad, as a share of
        // 10 us over 50 g.cm2 / 3 mN.m.s/rad at most.
        assert!(
            (at.inertia - mean_inertia).abs() <= 0.01 * at.inertia.abs(),
            "{grip:?}: {at:?} {mean_inertia}"
        );
        match (grip, start.omega == 0.0) {
            (Grip::Clamped, _) => assert_eq!([at.friction, at.inertia], [0.0; 2]),
            (_, false) => assert!((at.friction - limit).abs() < 1e-12, "{at:?}"),
            _ if at.inertia != 0.0 => assert!((at.friction + limit).abs() < 1e-12, "{at:?}"),
            _ => assert!(at.friction.abs() < limit && plant.small().omega == 0.0),
        }
    }
}

#[test]
fn step_divides_every_tick() {
    for rate in [100.0, 1000.0, 7777.7, 10_000.0, 11_600.0, 100_000.0] {
        let steps = f64::from(steps_per_tick(1.0 / rate));
        let step = 1.0 / rate / steps;
        assert!(step <= STEP_S * 1.000_001, "{rate} Hz: {step} s");
        assert!(steps == 1.0 || 1.0 / rate / (steps - 1.0) > STEP_S * 0.999_999);
    }
}
