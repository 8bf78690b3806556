//! What the balance learns of friction and damping, and what it allows to change.

use super::{CONSTANT, DEVICE, EVEN, FRICTION, Shaft, WINDOW_S, ZERO, found_s, rounding};

#[test]
fn friction_of_a_direction_is_learned_from_its_windows() {
    // The current grows by so little per window that no window differs from the one before.
    let slope = 0.05;
    for sign in [1.0, -1.0] {
        let turn = |t: f64| sign * EVEN * t;
        let found = found_s(10e3, 4.0, turn, turn, |t| sign * (0.05 + slope * t));
        // What is learned at the begin is 40 % of the friction and the error, and widens by 10 % of the
        // friction per second; the window that differs has the error as well.
        let excess = |rounding: f64| (0.4 * FRICTION + rounding) / (slope - 0.1 * FRICTION);
        let at = found.expect("the friction has no end");
        let latest = excess(2.0 * rounding()) + 3.0 * WINDOW_S;
        assert!(at > excess(rounding()) && at < latest, "{at}, {latest}");
    }
}

#[test]
fn friction_that_grows_slower_than_its_range_widens_is_balanced() {
    // Without widening, what is allowed at the begin would be used up after half of the time.
    let seconds = 2.0 * (0.4 * FRICTION + 2.0 * rounding()) / (0.08 * FRICTION);
    for sign in [1.0, -1.0] {
        let turn = |t: f64| sign * EVEN * t;
        let amps = |t: f64| sign * (0.05 + 0.08 * FRICTION * t);
        assert_eq!(found_s(10e3, seconds, turn, turn, amps), None);
    }
}

/// In 0.2 s, so that no window differs from the one before: by 40 % of the described friction and the errors of what
/// is learned and of the window. In this time the range widens by 2 % of the friction.
#[test]
fn friction_that_is_learned_may_rise_and_fall_by_its_variation() {
    let limit = 0.4 * FRICTION + 2.0 * rounding();
    for sign in [1.0, -1.0] {
        for way in [1.0, -1.0] {
            let changes = |by: f64| {
                let turn = |t: f64| sign * EVEN * t;
                let amps = |t: f64| sign * (FRICTION + way * by * (5.0 * t - 2.5).clamp(0.0, 1.0));
                found_s(10e3, 1.0, turn, turn, amps)
            };
            assert_eq!(changes(limit - 3e-3), None, "{sign} {way}");
            let found = changes(limit + 0.05 * FRICTION + 3e-3);
            assert!(found.is_some_and(|at| at > 0.5), "{sign} {way}: {found:?}");
        }
    }
}

/// Both shafts turn backwards for 6.7 s of 20 s. In the 13.3 s between, the friction grows by 1.07 of the described
/// one, and what is known of it backwards widens by 1.33.
#[test]
fn friction_of_a_direction_is_forgotten_while_the_motor_turns_the_other_way() {
    for sign in [1.0, -1.0] {
        let shaft = Shaft(sign * 20.0, sign * -40.0, 0.05);
        let angle = |t: f64| shaft.angle(t);
        let amps = |t: f64| {
            let along = FRICTION * (0.1 + 0.08 * t);
            let inertia = DEVICE.large.inertia * shaft.acceleration(t) / CONSTANT;
            inertia + along * shaft.speed(t).signum()
        };
        assert_eq!(found_s(1e3, 23.0, angle, angle, amps), None, "{sign}");
    }
}

/// The coupler brings 2.6 A, which fall in 0.4 s. From the first windows its range begins 5 % below what is left of
/// the current by the largest friction; at the end the friction is the least.
#[test]
fn damping_that_is_learned_may_fall_by_its_variation() {
    let slip = DEVICE.damping * 2.0 * EVEN / CONSTANT;
    let current = slip + FRICTION;
    let known = 0.95 * (current - (1.65 / 0.8 * FRICTION + ZERO) - rounding());
    let limit = current + rounding() - (known - ZERO);
    for sign in [1.0, -1.0] {
        let falls = |by: f64| {
            let amps = |t: f64| sign * (current - by * (2.5 * (t - 0.5)).clamp(0.0, 1.0));
            found_s(10e3, 1.2, |t| sign * 2.0 * EVEN * t, |_| 0.0, amps)
        };
        assert_eq!(falls(limit - 5e-3), None, "{sign}");
        // In this time the range widens by less than 1 % of the slip.
        let found = falls(limit + 0.01 * slip);
        assert!(found.is_some_and(|at| at > 0.5), "{sign}: {found:?}");
    }
}

/// What is not learned for a minute widens to the ranges of the start, and not beyond them.
#[test]
fn ranges_do_not_widen_beyond_those_of_the_start() {
    let largest = 1.65 / 0.8 * FRICTION + ZERO + rounding();
    // The slip of a handle that comes to rest within half a second, A.
    let slip = DEVICE.damping * 2.0 * EVEN / CONSTANT;
    for sign in [1.0, -1.0] {
        // A motor that rests for a minute.
        for (by, is_found) in [(-2e-3, false), (2e-3, true)] {
            let amps = |t: f64| if t < 60.0 { 0.0 } else { sign * (largest + by) };
            let found = found_s(1e3, 61.0, |_| 0.0, |_| 0.0, amps);
            assert_eq!(found.is_some(), is_found, "{by}, {sign}: {found:?}");
        }
        // One that turns with the handle for a minute. Damping over torque constant is 0.6 / 1.2 to 1.4 / 0.8.
        for (damping, is_found) in [(0.35, true), (0.55, false), (1.65, false), (2.0, true)] {
            let turn = |t: f64| sign * 2.0 * EVEN * t;
            let slowed = |t: f64| (2.0 * (t - 60.0)).clamp(0.0, 1.0);
            let handle = |t: f64| {
                let rest = slowed(t);
                turn(t.min(60.5)) - sign * 2.0 * EVEN * 0.25 * rest * rest
            };
            let amps = |t: f64| sign * (FRICTION + damping * slip * slowed(t));
            let found = found_s(1e3, 61.0, turn, handle, amps);
            assert_eq!(found.is_some(), is_found, "{damping}, {sign}: {found:?}");
            assert!(found.is_none_or(|at| at > 60.0), "{damping}: {found:?}");
        }
    }
}

#[test]
fn window_is_compared_with_the_one_before_the_last() {
    // The coupler brings 2 A: its 5 % alone are more than the changes here.
    let turn = |t: f64| EVEN * t;
    let slip = DEVICE.damping * EVEN / CONSTANT + FRICTION;
    let step = |by: f64| {
        found_s(
            10e3,
            1.0,
            turn,
            |_| 0.0,
            |t| slip + if t < 0.3 { 0.0 } else { by },
        )
    };
    let limit = 0.4 * FRICTION + 2.0 * rounding();
    for sign in [1.0, -1.0] {
        assert_eq!(step(sign * (limit - 3e-3)), None);
        let at = step(sign * (limit + 3e-3)).expect("a step is not found");
        assert!(at > 0.3 && at < 0.3 + 5.0 * WINDOW_S, "{at}");
    }
}

/// The coupler brings 2.6 A, and the handle begins to turn, which takes 0.5 A off. These are known to 12 %, as
/// [`damping_is_learned_and_forgotten`] computes it; 12 % of the whole hide more than what the current is off by.
#[test]
fn change_of_the_slip_is_compared_with_the_learned_damping() {
    for sign in [1.0, -1.0] {
        let turn = |t: f64| sign * 2.0 * EVEN * t;
        let handle = |t: f64| sign * 25.0 * (t - 0.3).max(0.0);
        let found = |by: f64| {
            let amps = |t: f64| {
                let (turns, off) = if t < 0.3 { (0.0, 0.0) } else { (25.0, by) };
                let slip = DEVICE.damping * (2.0 * EVEN - turns) / CONSTANT;
                sign * (slip + FRICTION + off)
            };
            found_s(10e3, 1.0, turn, handle, amps)
        };
        assert_eq!(found(0.0), None, "{sign}");
        let limit = 0.4 * FRICTION + 2.0 * rounding() + 0.12 * 25.0 * DEVICE.damping / CONSTANT;
        let at = found(1.3 * limit).expect("the current is not found");
        assert!(at > 0.3 && at < 0.3 + 5.0 * WINDOW_S, "{sign}: {at}");
    }
}

#[test]
fn damping_is_learned_and_forgotten() {
    for sign in [1.0, -1.0] {
        damping_is_learned_and_forgotten_in(sign);
    }
}

/// With a slip of this sign.
fn damping_is_learned_and_forgotten_in(sign: f64) {
    let turn = |t: f64| sign * 2.0 * EVEN * t;
    let slip = DEVICE.damping * 2.0 * EVEN / CONSTANT;
    let creep = |per_s: f64, seconds: f64| {
        let amps = |t: f64| sign * (slip * (1.0 + per_s * t) + FRICTION);
        found_s(10e3, seconds, turn, |_| 0.0, amps)
    };
    // The first windows leave 5 % and their friction and error, 0.1 A of 2.6 A. What is known widens by 1.5 % per
    // second, and the friction adds what the first windows allow.
    let found = creep(0.05, 20.0).expect("the coupler is not learned");
    let known = 1.05 * (1.0 + (FRICTION + ZERO + rounding()) / slip) - 1.0;
    let allowed = (1.65 / 0.8 * FRICTION + ZERO - FRICTION + rounding()) / slip;
    let expected = (known + allowed) / (0.05 - 0.015);
    let off = found / expected - 1.0;
    assert!(off.abs() < 0.08, "{sign}: {found} s, {expected} s");
    // A coupler that becomes warm, by 30 % in 60 s and in 24 s.
    for seconds in [60.0, 24.0] {
        assert_eq!(creep(-0.3 / seconds, seconds), None, "{seconds}, {sign}");
    }
}
