//! Algorithms with edges: constant velocity, acceleration, rest, reversal.

use estimator_core::Hertz;
use peers::{Dvrk, SimpleFocEncoder};

use crate::{CLOCK, assert_near, run, stamped};

const SLOW: Hertz = Hertz(1000.0);
const FAST: Hertz = Hertz(32_000.0);

#[test]
fn dvrk_is_exact_at_constant_velocity() {
    // Below and above a count per tick, both ways.
    for speed in [0.0137, -0.21, 0.93, 2.7, -3.3] {
        let samples = stamped(|t| 0.4 + speed * t, 4000, FAST);
        for estimator in [Dvrk::measured(FAST, CLOCK), Dvrk::predicted(FAST, CLOCK)] {
            let found = run(&estimator, samples.iter().copied());
            // A tick of the clock, 12 ns, at either end of the four edges; several edges in a tick are
            // spaced evenly between stamped ones. The prediction amplifies the difference of two
            // quarters.
            let clock = speed.abs() * FAST.0 / CLOCK.0;
            let most = speed.abs() * (20.0 * clock + 1e-4);
            assert_near(&found[3000..], |_| speed, most);
        }
    }
}

#[test]
fn dvrk_predicts_a_constant_acceleration_and_lags_without_the_prediction() {
    // Position 0.4 + a t^2 / 2 from rest: the velocity now is a t, and that of the last four edges is
    // the velocity at the middle of the time that they took.
    let a = 2e-5;
    let samples = stamped(|t| 0.4 + 0.5 * a * t * t, 6000, FAST);
    let lagging = run(&Dvrk::measured(FAST, CLOCK), samples.iter().copied());
    let predicted = run(&Dvrk::predicted(FAST, CLOCK), samples.iter().copied());
    for k in 4000..6000 {
        let truth = a * (k + 1) as f64;
        // Four edges took 4 / v ticks, of which the middle is 2 / v to 3 / v ago.
        let lag = a * 2.5 / truth;
        assert!((lagging[k] - (truth - lag)).abs() < 0.6 * a / truth + 2e-4 * truth);
        assert!((predicted[k] - truth).abs() < 0.15 * lag, "{k}");
    }
}

#[test]
fn dvrk_is_zero_until_four_edges_have_one_direction() {
    // A triangle: up for 400 ticks, then down, a count in ten ticks.
    let position = |t: f64| 0.5 + 0.1 * if t < 400.0 { t } else { 800.0 - t };
    let samples = stamped(position, 500, FAST);
    let found = run(&Dvrk::measured(FAST, CLOCK), samples.into_iter());
    // Edges at 395, and back at 405, 415, 425, 435.
    assert_near(&found[300..404], |_| 0.1, 1e-4);
    assert!(found[405..434].iter().all(|v| *v == 0.0), "{found:?}");
    assert_near(&found[436..], |_| -0.1, 1e-4);
}

#[test]
fn prediction_of_dvrk_is_below_a_count_in_the_time_without_an_edge() {
    let position = |t: f64| 0.5 + 0.1 * t.min(200.0);
    let samples = stamped(position, 2000, FAST);
    let found = run(&Dvrk::predicted(FAST, CLOCK), samples.into_iter());
    // The last edge is at tick 195.
    let bound = |k: usize| 1.0 / ((k + 1) as f64 - 195.0);
    for (k, v) in found.iter().enumerate().skip(206) {
        assert!((v / bound(k) - 1.0).abs() < 1e-4, "{k}: {v}");
    }
}

#[test]
fn simplefoc_encoder_is_exact_at_constant_velocity() {
    for speed in [0.0173, 0.31, -0.73, 3.4] {
        let encoder = SimpleFocEncoder::new(0.0, SLOW, CLOCK);
        let samples = stamped(|t| 0.4 + speed * t, 2000, SLOW);
        let found = run(&encoder, samples.into_iter());
        // Two stamps of 1 us, over at least half a tick of 1 ms, or over 1 / speed.
        assert_near(&found[1000..], |_| speed, speed.abs() * 4e-3);
    }
}

#[test]
fn simplefoc_encoder_is_zero_a_tenth_of_a_second_after_the_last_edge() {
    let position = |t: f64| 0.5 + 0.1 * t.min(200.0);
    let samples = stamped(position, 400, SLOW);
    let found = run(
        &SimpleFocEncoder::new(0.0, SLOW, CLOCK),
        samples.into_iter(),
    );
    // The last edge is at 195 ms.
    assert_near(&found[199..294], |_| 0.1, 1e-3);
    assert!(found[296..].iter().all(|v| *v == 0.0));
}

#[test]
fn dvrk_is_zero_where_four_edges_take_longer_than_the_counter() {
    // 26 bits at 49.152 MHz are 1.365 s: 43 690 ticks of 32 kHz.
    for (ticks, moves) in [(43_000.0, true), (44_400.0, false)] {
        let speed = 4.0 / ticks;
        let samples = stamped(|t| 0.5 + speed * t, 90_000, FAST);
        let found = run(&Dvrk::measured(FAST, CLOCK), samples.into_iter());
        let last = found[89_999];
        assert!((last - if moves { speed } else { 0.0 }).abs() < 1e-3 * speed);
    }
}

#[test]
fn dvrk_predicts_nothing_where_a_quarter_is_shorter_than_its_threshold() {
    // 2000 ticks of 49.152 MHz are 1.302 ticks of 32 kHz. Accelerating through 1 / 1.302 = 0.768
    // counts per tick: three edges of the four and the time since the newest stay well below.
    let a = 1e-4;
    let samples = stamped(|t| 0.4 + 0.5 * a * t * t, 9000, FAST);
    let lagging = run(&Dvrk::measured(FAST, CLOCK), samples.iter().copied());
    let predicted = run(&Dvrk::predicted(FAST, CLOCK), samples.iter().copied());
    let differ = |k: &usize| lagging[*k] != predicted[*k];
    assert!((4000..7600).filter(differ).count() > 3000);
    assert_eq!((7800..9000).find(differ), None);
}
