//! What the balance learns of friction and damping, and what it allows to change.

use super::{CONSTANT, DEVICE, EVEN, FRICTION, WINDOW_S, ZERO, found_s, rounding};

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

#[test]
fn damping_is_learned_and_forgotten() {
    let turn = |t: f64| 2.0 * EVEN * t;
    let slip = DEVICE.damping * 2.0 * EVEN / CONSTANT;
    let creep = |per_s: f64, seconds: f64| {
        let amps = |t: f64| slip * (1.0 + per_s * t) + FRICTION;
        found_s(10e3, seconds, turn, |_| 0.0, amps)
    };
    // The first windows leave 5 % and their friction and error, 0.1 A of 2.6 A. What is known widens by 1.5 % per
    // second, and the friction adds what the first windows allow.
    let found = creep(0.05, 20.0).expect("the coupler is not learned");
    let known = 1.05 * (1.0 + (FRICTION + ZERO + rounding()) / slip) - 1.0;
    let allowed = (1.65 / 0.8 * FRICTION + ZERO - FRICTION + rounding()) / slip;
    let expected = (known + allowed) / (0.05 - 0.015);
    let off = found / expected - 1.0;
    assert!(off.abs() < 0.08, "{found} s, {expected} s");
    // A coupler that becomes warm, by 30 % in 60 s and in 24 s.
    for seconds in [60.0, 24.0] {
        assert_eq!(creep(-0.3 / seconds, seconds), None, "{seconds}");
    }
}
