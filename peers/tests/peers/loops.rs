//! Tracking loops: step responses, dead band, limits.

use std::f64::consts::TAU;

use estimator_core::Hertz;
use peers::{Moteus, ODrive, VescFast, VescPll};

use crate::{assert_near, over, started};

/// Counts per tick of the steps: so many that the rounding to counts and the phase detector's floor are
/// below a thousandth.
const SPEED: i64 = 4000;

/// The response of `w^2 / (s + w)^2` to a unit step, after `k + 1` ticks of `wt` radians each.
fn critically_damped(wt: f64) -> impl Fn(usize) -> f64 {
    move |k| {
        let x = wt * (k + 1) as f64;
        1.0 - (1.0 + x) * (-x).exp()
    }
}

fn relative(velocities: Vec<f64>) -> Vec<f64> {
    let speed = SPEED as f64;
    velocities.into_iter().map(|v| v / speed).collect()
}

/// An Euler step of `h` radians moves a double pole by `h / 2` of itself, and the response by less.
fn tolerance(h: f64) -> f64 {
    0.5 * h + 1e-3
}

#[test]
fn moteus_has_the_step_response_of_its_double_pole() {
    // At 30 kHz a second, and far from the limit of an eighth of a revolution.
    let loop_ = Moteus::new(Moteus::CUTOFF, Moteus::RATE, 1 << 20);
    let wt = TAU * 400.0 / 2.48 / 30_000.0;
    let found = relative(over(&loop_, &started(SPEED, 600)));
    assert_near(&found, critically_damped(wt), tolerance(wt));
    assert!(found[599] > 0.999);
}

#[test]
fn cutoff_of_moteus_is_the_3_db_frequency() {
    // The frequency is that of the position: |2 w s + w^2| / |s + w|^2. A sine of 1e6 counts, by
    // correlation over whole periods once the start has decayed.
    let (cutoff, rate) = (Hertz(100.0), Hertz(100_000.0));
    let loop_ = Moteus::new(cutoff, rate, 1 << 31);
    let phase = |k: usize| TAU * cutoff.0 * k as f64 / rate.0;
    let counts: Vec<i64> = (0..=20_000)
        .map(|k| (1e6 * phase(k).sin()).round() as i64)
        .collect();
    let found = over(&loop_, &counts);
    // The velocity is that of the position through w^2 / (2 w s + w^2): to get the position's gain,
    // multiply by |1 + 2 s / w| = |1 + 2 j 2.48|.
    let late = 10_000..20_000;
    let sum = |f: &dyn Fn(f64) -> f64| -> f64 {
        let terms = late.clone().map(|k| found[k] * f(phase(k + 1)));
        2.0 * terms.sum::<f64>() / late.len() as f64
    };
    let amplitude = sum(&f64::sin).hypot(sum(&f64::cos)) / (1e6 * phase(1));
    let gain = amplitude * (1.0_f64).hypot(2.0 * 2.48);
    // 2.48 has three digits; the step is 0.0025 rad.
    assert!((gain - 0.5_f64.sqrt()).abs() < 3e-3, "{gain}");
}

#[test]
fn moteus_is_limited_to_an_eighth_of_a_revolution_per_tick() {
    let loop_ = Moteus::new(Moteus::CUTOFF, Moteus::RATE, 4096);
    let found = over(&loop_, &started(600, 2000));
    assert_eq!(found[1999], 512.0);
}

#[test]
fn odrive_has_the_step_response_of_its_double_pole() {
    // Ten times the project's rate, so that the response of the continuous loop is near.
    let rate = Hertz(10.0 * ODrive::RATE.0);
    let loop_ = ODrive::new(ODrive::BANDWIDTH_RAD_S, rate);
    let wt = 1000.0 / rate.0;
    let found = relative(over(&loop_, &started(SPEED, 1000)));
    assert_near(&found, critically_damped(wt), tolerance(wt));
    assert!(found[999] > 0.999);
}

#[test]
fn velocity_of_odrive_moves_in_steps_of_125_counts_per_second() {
    // ki T = 1e6 / 8000 at the defaults.
    let loop_ = ODrive::new(ODrive::BANDWIDTH_RAD_S, ODrive::RATE);
    let counts: Vec<i64> = (0..4000)
        .map(|k| (30.0 * (f64::from(k) * 2e-3).sin()).floor() as i64)
        .collect();
    let mut moves = 0;
    for v in over(&loop_, &counts) {
        let steps = v * 8000.0 / 125.0;
        assert!((steps - steps.round()).abs() < 1e-3, "{steps}");
        moves += i32::from(v != 0.0);
    }
    assert!(moves > 1000);
}

#[test]
fn odrive_is_exactly_at_rest_after_a_stop() {
    // A step of the velocity that f32 rounds: without the dead band a sum of steps is not zero.
    let loop_ = ODrive::new(777.0, ODrive::RATE);
    let mut counts = started(300, 400);
    counts.extend([120_000; 1200]);
    let found = over(&loop_, &counts);
    assert!(found[300] > 299.0);
    assert!(
        found[1200..].iter().all(|v| *v == 0.0),
        "{:?}",
        &found[1200..1210]
    );
}

#[test]
fn phase_detector_of_odrive_is_the_floor_on_both_sides() {
    // By hand, in steps of the velocity, with kp T = 1/4 and a step of 1/64. Up by a count the loop is
    // at -1, -0.734, -0.453, -0.156 and 0.156 of the new count: four steps. Down it is at 1 and 0.734:
    // one step, until it drifts below 0.
    let loop_ = ODrive::new(ODrive::BANDWIDTH_RAD_S, ODrive::RATE);
    let steps = |counts: &[i64]| -> Vec<f64> {
        let found = over(&loop_, counts);
        found.iter().map(|v| v * 64.0).collect()
    };
    assert_eq!(steps(&[0, 1, 1, 1, 1, 1]), [1.0, 2.0, 3.0, 4.0, 4.0]);
    assert_eq!(steps(&[0, -1, -1, -1, -1]), [-1.0; 4]);
}

#[test]
fn vesc_loop_has_the_step_response_of_its_two_poles() {
    // s^2 + kp s + ki at the defaults; an electrical turn that no step reaches.
    let loop_ = VescPll::new(VescPll::KP, VescPll::KI, VescPll::RATE, 1e6);
    let root = (VescPll::KP * VescPll::KP - 4.0 * VescPll::KI).sqrt();
    let [slow, fast] = [root, -root].map(|root| 0.5 * (root - VescPll::KP));
    let response = |k: usize| {
        let t = (k + 1) as f64 / VescPll::RATE.0;
        1.0 + (fast * (slow * t).exp() - slow * (fast * t).exp()) / (slow - fast)
    };
    let found = relative(over(&loop_, &started(SPEED, 12_500)));
    // The fast pole has 0.16 rad a tick, but only ki / (kp fast), 0.8 %, of the response.
    assert_near(&found, response, 2e-3);
    // A time constant of 66 ms.
    let at = (0.0664 * 12_500.0) as usize;
    assert!((found[at] - (1.0 - (-1.0_f64).exp())).abs() < 0.01);
}

#[test]
fn vesc_loop_stays_within_three_times_the_fast_speed() {
    let (pll, fast) = (
        VescPll::new(VescPll::KP, VescPll::KI, VescPll::RATE, 1e6),
        VescFast::new(VescFast::SHARE, 1e6),
    );
    let mut counts = started(100, 12_500);
    let last = 100 * 12_500;
    counts.extend([last; 2000]);
    let (slow, fast) = (over(&pll, &counts), over(&fast, &counts));
    let mut reached = 0;
    for (slow, fast) in slow.iter().zip(&fast) {
        // The product by 3 is rounded to f32.
        let most = 3.0 * fast.abs() * (1.0 + f64::from(f32::EPSILON));
        assert!(slow.abs() <= most, "{slow} {fast}");
        reached += i32::from(slow.abs() > 0.999 * most && most > 0.0);
    }
    assert!(reached > 100, "the limit acts after the stop");
}

#[test]
fn error_of_vesc_is_the_nearest_in_an_electrical_turn() {
    // 60 counts of 100 ahead are 40 behind.
    let first = |count: i64| {
        let loop_ = VescPll::new(VescPll::KP, VescPll::KI, VescPll::RATE, 100.0);
        over(&loop_, &[0, count])[0] * VescPll::RATE.0 * VescPll::RATE.0 / VescPll::KI
    };
    for (count, error) in [(40, 40.0), (60, -40.0), (-60, 40.0), (-40, -40.0)] {
        assert!((first(count) - error).abs() < 1e-4, "{count}");
    }
}
