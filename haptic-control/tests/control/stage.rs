//! Both stages, the limits of currents, the scales and the device, by their formulas.

use estimator_core::{Amps, Counts, CountsPerTickSquared, Hertz};
use haptic_control::{
    Compensated, ContinuousStage, CoupledParts, CurrentLimits, DualStage, LoopPoles, NewtonMetres,
    RadPerS, Rig, Rst, RstDesign, TransientStage,
};

const RATE: Hertz = Hertz(1e3);
const DEVICE: DualStage = DualStage::DEFAULT;
/// Wide enough for everything but what is tested.
const WIDE: f32 = 1e3;
/// Half of the tracking error and of the drag.
const HALVES: CoupledParts = CoupledParts {
    tracking: 0.5,
    drag: 0.5,
};

fn following(followed: f64, parts: CoupledParts) -> Compensated {
    Compensated {
        parts,
        ..Compensated::following(RadPerS(followed as f32))
    }
}

fn design() -> RstDesign {
    RstDesign::new(&DEVICE, RATE, LoopPoles::DEFAULT).unwrap()
}

fn near(value: f32, wanted: f64, tolerance: f64) {
    let off = (f64::from(value) - wanted).abs();
    assert!(off <= tolerance, "{value} {wanted}");
}

/// The continuous stage's command to its loop and its feed-forward, against the loop alone.
#[test]
fn wanted_velocity_and_feed_forward_follow_from_the_wanted_torque() {
    let mut device = DEVICE;
    // No limit in the way.
    device.large.current_limit = 1e3;
    let stage = ContinuousStage::new(&device, &design(), WIDE);
    let rst = Rst::new(&design());
    let (mut state, mut looped) = (stage.start(RadPerS(0.0)), rst.start(RadPerS(0.0)));
    for k in 0..2000 {
        let phase = f64::from(k) / 150.0;
        let handle = 8.0 * phase.sin();
        let torque = 0.02 * (1.7 * phase).sin();
        let large = 15.0 * (0.6 * phase).sin();
        let ahead = handle + (2.3 * phase).sin();
        let driven = stage.update(
            &mut state,
            NewtonMetres(torque as f32),
            RadPerS(large as f32),
            RadPerS(handle as f32),
            &following(ahead, HALVES),
        );
        let wanted = ahead + torque / DEVICE.damping;
        let asked = rst.update(&mut looped, RadPerS(wanted as f32), RadPerS(large as f32));
        let direction = (f64::from(looped.filtered().0) / 0.15).clamp(-1.0, 1.0);
        let forward = DEVICE.large.coulomb_friction * direction - DEVICE.damping * handle;
        let applied = f64::from(asked) + forward / DEVICE.large.torque_constant;
        near(driven.current.get(), applied, 1e-3);
    }
}

#[test]
fn wanted_velocity_saturates_at_85_percent_of_the_monitors_limit() {
    let stage = ContinuousStage::new(&DEVICE, &design(), WIDE);
    let limit = 0.85 * 150.0;
    for sign in [1.0, -1.0] {
        for (handle, followed) in [(0.0, 0.0), (20.0, 20.0), (-20.0, -20.0), (5.0, 8.0)] {
            // What the followed velocity leaves of it, just below and far above.
            let most = (limit - sign * followed) * DEVICE.damping;
            let compensated = following(followed, HALVES);
            let settled = |torque: f64| {
                let mut state = stage.start(RadPerS(0.0));
                let torque = NewtonMetres((sign * torque) as f32);
                // The large motor is at the limit.
                let [large, handle] = [sign * limit, handle].map(|speed| RadPerS(speed as f32));
                let mut tick = || stage.update(&mut state, torque, large, handle, &compensated);
                (0..3000).map(|_| tick()).last().unwrap()
            };
            let lag: f64 = followed - handle;
            let drag = 0.5 * DEVICE.damping * lag.clamp(-0.5, 0.5);
            near(settled(10.0 * most).coupled.0, sign * most + drag, 1e-6);
            assert_eq!(settled(10.0 * most), settled(100.0 * most));
            assert_ne!(settled(0.99 * most), settled(most));
        }
    }
}

/// The three terms of the coupler's torque, against the tracking filter in f64, with a large motor that lags the
/// commanded velocity by less and by more than what is compensated.
#[test]
fn coupler_torque_is_that_of_command_tracking_error_and_drag() {
    let stage = ContinuousStage::new(&DEVICE, &design(), WIDE);
    let gain = 1.0 - (-std::f64::consts::TAU * 60.0 / RATE.0).exp();
    for parts in [[0.5, 0.0], [0.7, 1.0], [0.5, 0.25]] {
        let mut state = stage.start(RadPerS(0.0));
        let (mut expected, mut followed) = ([0.0; 2], [0.0; 2]);
        let mut largest: f64 = 0.0;
        for k in 0..400 {
            let torque = if k < 200 { 0.03 } else { -0.01 };
            let handle = 6.0 * (f64::from(k) / 30.0).sin();
            let large = f64::from(k) / 100.0;
            let [large_now, handle_now] = [large, handle].map(|speed| RadPerS(speed as f32));
            let part = |k: usize| parts[k] as f32;
            let shares = CoupledParts {
                tracking: part(0),
                drag: part(1),
            };
            let asked = NewtonMetres(torque as f32);
            let compensated = following(f64::from(handle_now.0), shares);
            let driven = stage.update(&mut state, asked, large_now, handle_now, &compensated);
            for (filter, input) in [(&mut expected, torque), (&mut followed, handle)] {
                filter[0] += gain * (input - filter[0]);
                filter[1] += gain * (filter[0] - filter[1]);
            }
            let tracking = DEVICE.damping * (large - followed[1]) - expected[1];
            let lag = followed[1] - handle;
            largest = largest.max(lag.abs());
            let drag = DEVICE.damping * lag.clamp(-0.5, 0.5);
            let wanted = expected[1] + parts[0] * tracking + parts[1] * drag;
            near(driven.coupled.0, wanted, 2e-8);
        }
        assert!(largest > 0.75, "{largest} rad/s");
    }
}

#[test]
fn small_current_is_that_of_the_torque() {
    let mut device = DEVICE;
    device.small.current_limit = 1e3;
    let stage = TransientStage::new(&device, WIDE);
    for torque in [0.0, 0.01, -0.02_f32] {
        let current = stage.update(&mut stage.start(), NewtonMetres(torque));
        let wanted = f64::from(torque) / DEVICE.small.torque_constant;
        near(current.get(), wanted, 1e-6);
    }
}

/// Torques against the friction at 1 kHz, where 28 rad/s^2 reach 0.056 rad/s in a tick and 1 ms.
#[test]
fn friction_is_fed_forward_in_the_direction_of_the_handle() {
    let rig = Rig::new(&DEVICE, RATE, LoopPoles::DEFAULT).unwrap();
    for (handle, part) in [
        (0.0, 0.0),
        (0.028, 0.5),
        (-0.056, -1.0),
        (0.12, 1.0),
        // (3 / 6)^4 = 1 / 16 of what is more than a half.
        (3.0, 1.0 - 0.5 / 16.0),
        (-6.0, -0.5),
        (50.0, 0.5),
    ] {
        for compensation in [rig.free, rig.sprung] {
            let mut state = compensation.start(RadPerS(handle));
            let now = compensation.update(&mut state, RadPerS(handle));
            let friction = f64::from(now.friction.0) / DEVICE.small.coulomb_friction;
            assert!((friction - part).abs() < 1e-5, "{handle}: {friction}");
        }
    }
}

/// What is compensated at each tick of a motion with reversals, quick and slow ones, against the formulas in f64.
#[test]
fn compensation_follows_the_time_since_the_last_reversal() {
    for rate in [Hertz(1e3), Hertz(10e3), Hertz(11.6e3)] {
        let rig = Rig::new(&DEVICE, rate, LoopPoles::DEFAULT).unwrap();
        let period_ms = 1e3 / rate.0;
        let gain = 1.0 - (-std::f64::consts::TAU * 60.0 / rate.0 / 2.0).exp();
        let direction = 28.0 * (period_ms * 1e-3 + 1e-3);
        for (compensation, free, side) in [
            (rig.free, true, 1.0),
            (rig.sprung, false, 1.0),
            (rig.sprung, false, -1.0),
        ] {
            let mut state = compensation.start(RadPerS(0.0));
            // The first motion is no reversal.
            let (mut before, mut latest, mut since_ms) = (0.0, 0.0, 1e3_f64);
            let mut seen = [0; 3];
            for k in 0..(230.0 / period_ms) as u32 {
                let t_ms = f64::from(k) * period_ms;
                // Half periods of 5 ms, then of 40 ms, and a rest, in which the sign is that of before, and back.
                let handle = match t_ms {
                    ..50.0 => 3.0 * (t_ms / 5.0 * std::f64::consts::PI).sin(),
                    ..170.0 => 4.0 * ((t_ms - 50.0) / 40.0 * std::f64::consts::PI).cos(),
                    ..200.0 => 0.0,
                    _ => 2.0,
                };
                let handle = side * f64::from(handle as f32);
                before += gain * (handle - before);
                if handle * latest < 0.0 {
                    since_ms = 0.0;
                }
                if handle != 0.0 {
                    latest = handle;
                }
                let now = compensation.update(&mut state, RadPerS(handle as f32));
                let slow = 1.0 - (handle / 6.0).clamp(-1.0, 1.0).powi(4);
                let drag = ((since_ms - 10.0) / 8.0).clamp(0.0, 1.0);
                let whole = ((since_ms - 4.0) / 2.0).clamp(0.0, 1.0);
                let (lead, part) = if free {
                    (1.0, 1.0)
                } else {
                    (drag, (1.0 + whole) / 2.0)
                };
                near(now.followed.0, handle + lead * (handle - before), 2e-5);
                near(now.parts.drag, drag * slow, 1e-4);
                near(now.parts.tracking, 0.5 + 0.2 * drag * slow, 1e-4);
                let sat = (handle / direction).clamp(-1.0, 1.0);
                let friction = DEVICE.small.coulomb_friction * sat * (1.0 + slow) / 2.0 * part;
                near(now.friction.0, friction, 1e-7);
                for (seen, weight) in seen.iter_mut().zip([0.0, 0.5, 1.0]) {
                    *seen += i32::from((drag - weight).abs() < 0.2);
                }
                since_ms += period_ms;
            }
            assert!(seen.iter().all(|seen| *seen > 5), "{seen:?}");
        }
    }
}

/// A handle without a hand, with about the least friction and the largest torque constant, is driven up to
/// the velocity of the bound and not beyond it; with a little more than the described friction it rests.
#[test]
fn friction_that_is_fed_forward_drives_a_handle_at_most_at_6_rad_per_s() {
    let rig = Rig::new(&DEVICE, Hertz(10e3), LoopPoles::DEFAULT).unwrap();
    let settled = |friction: f64, constant: f64, from: f64| {
        let mut speed = from;
        for _ in 0..200_000 {
            let mut state = rig.free.start(RadPerS(0.0));
            let ahead = rig.free.update(&mut state, RadPerS(speed as f32));
            let push = constant * f64::from(ahead.friction.0);
            let held = friction * DEVICE.small.coulomb_friction;
            let change = 1e-4 / DEVICE.small.inertia;
            // Friction takes velocity away, and at most all of it.
            let moved = speed + change * push;
            speed = (moved.abs() - change * held).max(0.0).copysign(moved);
        }
        speed
    };
    for from in [0.2, 3.0, 20.0] {
        let fastest = settled(0.62, 1.2, from);
        assert!((5.5..6.0).contains(&fastest), "{from}: {fastest}");
        let slower = settled(0.9, 1.0, from);
        assert!((3.5..4.5).contains(&slower), "{from}: {slower}");
        assert!(settled(1.01, 1.0, from) < 0.01, "{from}");
    }
}

#[test]
fn currents_are_limited_in_size_and_slew() {
    for (rate, slews) in [(1e3, [1.2, 0.6]), (10e3, [0.12, 0.06])] {
        let rig = Rig::new(&DEVICE, Hertz(rate), LoopPoles::DEFAULT).unwrap();
        for sign in [1.0, -1.0] {
            let mut large = rig.continuous.start(RadPerS(0.0));
            let mut small = rig.transient.start();
            let (mut rise, mut most) = ([0.0_f32; 2], [0.0_f32; 2]);
            let mut before = [0.0; 2];
            for _ in 0..2000 {
                // A large motor that runs the wrong way.
                let (push, wrong) = (NewtonMetres(sign), RadPerS(-sign * 1e4));
                let still = RadPerS(0.0);
                let now = [
                    rig.continuous
                        .update(
                            &mut large,
                            push,
                            wrong,
                            still,
                            &Compensated::following(still),
                        )
                        .current
                        .get(),
                    rig.transient.update(&mut small, push).get(),
                ];
                for i in 0..2 {
                    rise[i] = rise[i].max((now[i] - before[i]).abs());
                    most[i] = most[i].max(sign * now[i]);
                }
                before = now;
            }
            assert_eq!(most, [6.0, 1.5]);
            for (rise, slew) in rise.iter().zip(slews) {
                near(*rise, slew, 1e-5);
            }
        }
    }
}

#[test]
fn values_within_the_limits_are_unchanged_and_others_are_limited() {
    let limits = CurrentLimits {
        largest: Amps::new(2.0),
        slew: 0.5,
    };
    for (wanted, before, applied) in [
        (0.3, 0.0, 0.3),
        (0.5, 0.0, 0.5),
        (0.75, 0.0, 0.5),
        (-0.75, 0.0, -0.5),
        (1.0, 1.25, 1.0),
        (0.0, 1.25, 0.75),
        (9.0, 1.75, 2.0),
        (-9.0, -1.75, -2.0),
        (2.0, 2.0, 2.0),
        (-2.0, -2.0, -2.0),
        (f32::INFINITY, 1.0, 0.0),
        (f32::NEG_INFINITY, 1.0, 0.0),
        (f32::NAN, 1.0, 0.0),
        // What flowed before may be beyond the limit.
        (9.0, 5.0, 2.0),
    ] {
        let found = limits.applied(wanted, Amps::new(before));
        assert_eq!(found.get(), applied, "{wanted} {before}");
    }
}

#[test]
fn scales_are_those_of_the_encoders() {
    for rate in [1e3, 10e3] {
        let rig = Rig::new(&DEVICE, Hertz(rate), LoopPoles::DEFAULT).unwrap();
        let turn = std::f64::consts::TAU;
        near(rig.angle_scale.of(Counts(20_000)).0, turn, 1e-6);
        near(rig.angle_scale.of(Counts(-5000)).0, -turn / 4.0, 1e-6);
        near(
            rig.large_scale.rad_per_s_per_count_per_tick,
            turn / 4096.0 * rate,
            1e-5,
        );
        near(
            rig.handle_scale.rad_per_s_per_count_per_tick,
            turn / 20_000.0 * rate,
            1e-6,
        );
        let acceleration = rig.acceleration_scale.of(CountsPerTickSquared(0.5)).0;
        let wanted = 0.5 * turn / 20_000.0 * rate * rate;
        near(acceleration, wanted, 1e-6 * wanted);
    }
}
