//! Low-passes: step responses and a frequency response.

use std::f64::consts::TAU;

use estimator_core::Hertz;
use peers::{OpenFfBoard, SimpleFocSensor, VescFast};

use crate::{assert_near, over, started};

#[test]
fn fast_speed_of_vesc_is_a_first_order_step() {
    let filter = VescFast::new(VescFast::SHARE, 1e6);
    let found = over(&filter, &started(100, 2000));
    let step = |k: usize| 100.0 * (1.0 - 0.99_f64.powi(k as i32 + 1));
    // Rounding of f32, summed over the memory of 100 ticks.
    assert_near(&found, step, 100.0 * 100.0 * f64::from(f32::EPSILON));
}

#[test]
fn fast_speed_of_vesc_limits_a_difference_to_a_sixth_of_a_turn() {
    let filter = VescFast::new(1.0, 600.0);
    assert_eq!(over(&filter, &[0, 150, 400, 100]), [100.0, 100.0, -100.0]);
}

#[test]
fn low_pass_of_simplefoc_is_a_first_order_step() {
    let rate = Hertz(10_000.0);
    let filter = SimpleFocSensor::new(SimpleFocSensor::FILTER_TIME_S, rate);
    let found = over(&filter, &started(7, 1000));
    // The backward Euler form of 1 / (1 + s Tf): off by at most half a tick of the slope.
    let step = |k: usize| 7.0 * (1.0 - (-((k + 1) as f64) / (rate.0 * 5e-3)).exp());
    assert_near(&found, step, 7.0 * 0.5 / (rate.0 * 5e-3) + 1e-4);
}

#[test]
fn slow_simplefoc_sensor_holds_the_velocity_of_the_last_change_for_ever() {
    // A count every ten ticks, then rest. Without the filter: a tenth of a count per tick, before
    // and after.
    let sensor = SimpleFocSensor::new(0.0, Hertz(1000.0));
    let mut counts: Vec<i64> = (0..100).map(|k| k / 10).collect();
    counts.extend([10; 5000]);
    let found = over(&sensor, &counts);
    let tenth = f64::from(0.1_f32);
    assert!(found[19..].iter().all(|v| *v == tenth), "{found:?}");
}

/// Amplitude and phase of the response to a velocity `sin(2 π f t)`, from the difference of counts.
fn response(filter: &OpenFfBoard, frequency: f64, rate: f64) -> (f64, f64) {
    // 1e6 counts per tick at the peak: rounding is negligible. Whole periods, after the start.
    let phase = |k: usize| TAU * frequency * k as f64 / rate;
    let mut total = 0.0;
    let mut counts = vec![0];
    for k in 1..=20_000 {
        total += 1e6 * phase(k).sin();
        counts.push(total.round() as i64);
    }
    let found = over(filter, &counts);
    let late = 10_000..20_000;
    let sum = |f: &dyn Fn(f64) -> f64| -> f64 {
        let terms = late.clone().map(|k| found[k] * f(phase(k + 1)));
        2e-6 * terms.sum::<f64>() / late.len() as f64
    };
    let (sine, cosine) = (sum(&f64::sin), sum(&f64::cos));
    (sine.hypot(cosine), cosine.atan2(sine))
}

#[test]
fn biquad_of_openffboard_has_q_and_a_quarter_turn_at_its_frequency() {
    for frequency in OpenFfBoard::PROFILES {
        let filter = OpenFfBoard::new(frequency, OpenFfBoard::Q, OpenFfBoard::RATE);
        let (gain, phase) = response(&filter, frequency.0, 1000.0);
        // The bilinear transform is exact at its frequency; f32 coefficients have 24 bits.
        assert!((gain - OpenFfBoard::Q).abs() < 1e-4, "{frequency:?} {gain}");
        assert!((phase + 0.25 * TAU).abs() < 1e-4, "{frequency:?} {phase}");
    }
}

#[test]
fn biquad_of_openffboard_keeps_a_constant_velocity_and_removes_half_of_the_rate() {
    let filter = OpenFfBoard::new(OpenFfBoard::PROFILES[1], OpenFfBoard::Q, OpenFfBoard::RATE);
    let constant = over(&filter, &started(12, 2000));
    assert!((constant[1999] - 12.0).abs() < 1e-3, "{}", constant[1999]);
    // Differences of 2 and 0 in turn: a mean of 1, and a zero at half of the rate.
    let counts: Vec<i64> = (0..2000).map(|k| (k + 1) / 2 * 2).collect();
    let found = over(&filter, &counts);
    assert!((found[1998] - 1.0).abs() < 1e-3, "{}", found[1998]);
    assert!((found[1997] - 1.0).abs() < 1e-3, "{}", found[1997]);
}
