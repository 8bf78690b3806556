use super::*;
use crate::score::Field;
use std::f64::consts::{SQRT_2, TAU};

const RATE_HZ: f64 = 1000.0;

fn interval() -> HapticInterval {
    HapticInterval::new(0.05, 0.010, 0.070, 0.96e-3)
}

fn signal(n: usize, of_time: impl Fn(f64) -> f64) -> Vec<f64> {
    (0..n).map(|i| of_time(i as f64 / RATE_HZ)).collect()
}

fn estimate(n: usize, of_time: impl Fn(f64) -> f64) -> Vec<f32> {
    signal(n, of_time).into_iter().map(|e| e as f32).collect()
}

fn score(truth: &[f64], estimate: &[f32]) -> Score {
    Truth::new(truth, RATE_HZ, interval(), Wanted::ALL)
        .unwrap()
        .score(estimate)
}

fn near(found: Option<f64>, expected: f64, within: f64) {
    let found = found.expect("a score");
    assert!(
        (found - expected).abs() <= within,
        "{found}, not {expected}"
    );
}

#[test]
fn distance_of_a_constant_offset_is_measured_from_the_interval() {
    // tolerance(10) = 0.5 + 0.36458; 1.5 above it is 0.63542 outside.
    let s = score(&vec![10.0; 2000], &vec![11.5; 2000]);
    near(s.distance_rad_s, 0.635_416_7, 1e-6);
    near(s.outside, 1.0, 0.0);
    near(s.rms_rad_s, 1.5, 1e-9);
    near(s.max_rad_s, 1.5, 1e-9);
    near(s.force_mn, 1.5 * 27.428_57, 1e-4);
    assert_eq!(s.delay_ms, None, "the truth does not move");
    assert_eq!(s.distance_transient_rad_s, None, "no transient");
}

#[test]
fn offset_inside_the_interval_has_no_distance_but_an_rms_error() {
    let s = score(&vec![-10.0; 2000], &vec![-10.8; 2000]);
    near(s.distance_rad_s, 0.0, 0.0);
    near(s.outside, 0.0, 0.0);
    near(s.rms_rad_s, 0.8, 1e-6);
}

#[test]
fn outside_is_the_share_of_samples_after_the_start() {
    let mut guess = vec![0.0; 1100];
    guess[..100].fill(50.0);
    guess[1000..].fill(-0.364_583_3 - 0.2);
    let s = score(&vec![0.0; 1100], &guess);
    near(s.outside, 0.1, 1e-12);
    near(s.distance_rad_s, 0.02, 1e-6);
    near(s.max_rad_s, 0.564_583_3, 1e-6);
}

/// A force of exactly the threshold is not felt.
#[test]
fn the_bound_of_the_interval_is_inside() {
    let interval = HapticInterval::new(0.0, 0.5, 1.0, 0.25);
    let truth = vec![0.0; 2000];
    let truth = Truth::new(&truth, RATE_HZ, interval, Wanted::ALL).unwrap();
    near(truth.score(&vec![1.0; 2000]).outside, 0.0, 0.0);
    near(truth.score(&vec![1.001; 2000]).outside, 1.0, 0.0);
}

#[test]
fn force_follows_from_the_rms_error() {
    // One of 1000 scored samples is wrong by 3 rad/s.
    let mut guess = vec![0.0; 1100];
    guess[600] = 3.0;
    let s = score(&vec![0.0; 1100], &guess);
    let rms = 3.0 / 1000_f64.sqrt();
    near(s.rms_rad_s, rms, 1e-9);
    near(s.max_rad_s, 3.0, 0.0);
    // F = 2 b w / D at the fingertip.
    near(s.force_mn, 1e3 * 2.0 * 0.96e-3 * rms / 0.070, 1e-6);
}

#[test]
fn delay_of_a_ramp_is_in_ms() {
    let truth = signal(2000, |t| 8.0 * t);
    near(
        score(&truth, &estimate(2000, |t| 8.0 * (t - 0.0015))).delay_ms,
        1.5,
        1e-3,
    );
    near(
        score(&truth, &estimate(2000, |t| 8.0 * (t + 0.0015))).delay_ms,
        -1.5,
        1e-3,
    );
}

/// The rate is not 1 kHz, so that samples and milliseconds differ.
#[test]
fn delay_of_a_sine_is_in_ms() {
    let rate_hz = 8000.0;
    let wave = |t: f64| 3.0 * (TAU * 7.0 * t).sin() + 2.0 * (TAU * 2.9 * t).cos();
    let at = |i: usize| i as f64 / rate_hz;
    let truth: Vec<f64> = (0..16_000).map(|i| wave(at(i))).collect();
    let scorer = Truth::new(&truth, rate_hz, interval(), Wanted::ALL).unwrap();
    for delay_ms in [1.5, -2.3, 0.06, 20.0] {
        let late: Vec<f32> = (0..16_000)
            .map(|i| wave(at(i) - 1e-3 * delay_ms) as f32)
            .collect();
        near(scorer.score(&late).delay_ms, delay_ms, 2e-3);
    }
}

#[test]
fn noise_is_the_rms_in_the_tactile_band() {
    // Motion of the truth inside the band is not noise.
    let motion = |t: f64| 5.0 * t + 2.0 * (TAU * 120.0 * t).sin();
    let truth = signal(4000, motion);
    near(
        score(&truth, &estimate(4000, motion)).noise_rad_s,
        0.0,
        1e-6,
    );
    for (hz, share) in [
        (200.0, 1.0),
        (55.0, 0.97),
        (480.0, 1.0),
        (20.0, 0.0),
        (40.0, 0.0),
    ] {
        let s = score(
            &truth,
            &estimate(4000, |t| motion(t) + 0.7 * (TAU * hz * t).sin()),
        );
        near(s.noise_rad_s, share * 0.7 / SQRT_2, 0.03 * 0.7);
        near(s.rms_rad_s, 0.7 / SQRT_2, 1e-3);
    }
}

#[test]
fn offset_and_slow_drift_are_not_noise() {
    let s = score(&vec![0.0; 4000], &estimate(4000, |t| 4.0 + 3.0 * t));
    near(s.noise_rad_s, 0.0, 0.01);
}

#[test]
fn chatter_of_a_sawtooth_is_its_total_variation() {
    // The truth increases by 0.01 a sample. The estimate is alternately 0 and 1 above it.
    let truth = signal(1100, |t| 10.0 * t);
    let saw = estimate(1100, |t| 10.0 * t + ((t * RATE_HZ).round() % 2.0));
    let s = score(&truth, &saw);
    // 1000 samples have 999 steps: half of +1.01, half of 0.99; the truth's are 0.01.
    near(s.chatter_rad_s, 999.0 * (1.0 - 0.01) / 1000.0, 2e-3);
    near(
        score(&truth, &estimate(1100, |t| 5.0 * t)).chatter_rad_s,
        0.0,
        0.0,
    );
}

/// The total variation of a sine of amplitude A and frequency f is 4 A f in a second.
#[test]
fn chatter_excludes_the_total_variation_of_the_truth() {
    let sine = |amplitude: f64| move |t: f64| amplitude * (TAU * 5.0 * t).sin();
    // 2 s after the start, which is not scored.
    let truth = signal(2100, sine(3.0));
    let chatter =
        |of_time: &dyn Fn(f64) -> f64| score(&truth, &estimate(2100, of_time)).chatter_rad_s;
    let variation = |amplitude: f64| 4.0 * amplitude * 5.0 / RATE_HZ;
    near(chatter(&sine(4.5)), variation(4.5) - variation(3.0), 1e-4);
    // An estimate of opposite sign has the same total variation. A smaller one gives 0.
    near(chatter(&sine(-3.0)), 0.0, 1e-5);
    near(chatter(&sine(2.0)), 0.0, 0.0);
    // The total variation of an estimate that does not follow the truth counts as well.
    let rippled = |t: f64| 2.0 * (TAU * 25.0 * t).sin();
    near(
        chatter(&rippled),
        4.0 * 2.0 * 25.0 / RATE_HZ - variation(3.0),
        2e-3,
    );
}

#[test]
fn transient_distance_averages_over_the_transient_alone() {
    let truth = signal(1000, |t| if t < 0.4995 { 0.0 } else { 2.0 });
    let t = Truth::new(&truth, RATE_HZ, interval(), Wanted::ALL).unwrap();
    assert_eq!(t.transients(), std::slice::from_ref(&(498..522)));
    // 12 of the 24 transient samples have an error of 2, with a tolerance of 0.46458.
    let late = estimate(1000, |t| if t < 0.5115 { 0.0 } else { 2.0 });
    let s = t.score(&late);
    near(s.distance_transient_rad_s, 0.5 * (2.0 - 0.464_583_3), 1e-6);
    near(s.distance_rad_s, 12.0 / 900.0 * (2.0 - 0.464_583_3), 1e-6);
}

#[test]
fn non_finite_sample_makes_the_scores_infinite_and_is_counted() {
    let truth = signal(1000, |t| if t < 0.4995 { 0.0 } else { 2.0 });
    for bad in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
        let mut guess = estimate(1000, |t| if t < 0.4995 { 0.0 } else { 2.0 });
        guess[50] = bad;
        assert_eq!(score(&truth, &guess).non_finite, 0, "skipped");
        guess[700] = bad;
        let s = score(&truth, &guess);
        assert_eq!(s.non_finite, 1);
        for infinite in [
            s.rms_rad_s,
            s.max_rad_s,
            s.distance_rad_s,
            s.distance_transient_rad_s,
        ] {
            assert_eq!(infinite, Some(f64::INFINITY));
        }
        assert_eq!(s.force_mn, Some(f64::INFINITY));
        near(s.outside, 1.0 / 900.0, 1e-12);
        assert_eq!(
            (s.delay_ms, s.noise_rad_s, s.chatter_rad_s),
            (None, None, None)
        );
    }
}

#[test]
fn only_requested_scores_are_computed_with_unchanged_values() {
    let truth = signal(2000, |t| {
        4.0 * (TAU * 3.0 * t).sin() + if t < 1.0 { 0.0 } else { 3.0 }
    });
    let guess: Vec<f32> = truth.iter().map(|&w| (1.1 * w).round() as f32).collect();
    let all = serde_json::to_value(score(&truth, &guess)).unwrap();
    let takes = |field: &Field<Score>| {
        let mut wanted = Wanted::NONE;
        if let Some(takes) = field.takes {
            *takes(&mut wanted) = true;
        }
        wanted
    };
    let mut compared = 0;
    for field in Score::FIELDS {
        let wanted = takes(field);
        let one = Truth::new(&truth, RATE_HZ, interval(), wanted)
            .unwrap()
            .score(&guess);
        let one = serde_json::to_value(one).unwrap();
        for other in Score::FIELDS {
            let (value, full) = (&one[other.name], &all[other.name]);
            if takes(other) == wanted {
                assert_eq!(value, full, "{} where {} is wanted", other.name, field.name);
            } else {
                assert!(
                    value.is_null(),
                    "{} where {} is wanted",
                    other.name,
                    field.name
                );
            }
        }
        compared += usize::from(all[field.name].is_number());
    }
    // The other scores are relative to the finite difference or come from the estimator.
    assert!(compared >= 9, "{compared} scores");
}

#[test]
fn trace_shorter_than_the_skipped_start_has_no_scores() {
    assert_eq!(score(&[0.0; 100], &[9.0; 100]), Score::default());
    assert!(score(&[0.0; 101], &[9.0; 101]).rms_rad_s.is_some());
}

#[test]
fn a_truth_that_is_not_finite_or_has_no_rate_is_refused() {
    let refuse = |omega: &[f64], rate| Truth::new(omega, rate, interval(), Wanted::ALL).err();
    assert!(
        refuse(&[0.0, f64::NAN], 1000.0)
            .unwrap()
            .contains("sample 1 is NaN")
    );
    assert!(refuse(&[0.0], 0.0).unwrap().contains("0 Hz"));
    assert!(refuse(&[0.0], f64::NAN).is_some());
}

#[test]
fn one_of_100_samples_exceeds_p99() {
    // 0.1 s that is not scored, then errors of 0.01 to 10 rad/s of both signs in scrambled order.
    let truth = signal(1100, |_| 3.0);
    let error = |k: usize| match k {
        0..100 => 500.0,
        _ => {
            0.01 * ((37 * (k - 100)) % 1000 + 1) as f32
                * if k.is_multiple_of(2) { 1.0 } else { -1.0 }
        }
    };
    let guess: Vec<f32> = (0..1100).map(|k| 3.0 + error(k)).collect();
    near(score(&truth, &guess).p99_rad_s, 9.9, 1e-5);
    let broken: Vec<f32> = (0..1100)
        .map(|k| if k == 900 { f32::NAN } else { 3.0 })
        .collect();
    assert_eq!(score(&truth, &broken).p99_rad_s, Some(f64::INFINITY));
}

/// The estimate is far off where the truth is not known.
#[test]
fn samples_at_which_the_truth_is_not_known_are_in_no_score() {
    let n = 6000;
    let wave = |t: f64| 3.0 * (TAU * 1.3 * t).sin() + if t > 4.0 { 2.0 } else { 0.0 };
    let noise = |t: f64| 0.5 * (TAU * 120.0 * t).sin();
    let truth = signal(n, wave);
    let good = estimate(n, |t| wave(t - 3e-3) + noise(t));
    let unknown = |k: usize| (1200..1300).contains(&k) || (3990..4030).contains(&k) || k >= 5900;
    let known: Vec<_> = (0..n).map(|k| !unknown(k)).collect();
    let masked =
        Truth::where_known(&truth, Some(&known), RATE_HZ, interval(), Wanted::ALL).unwrap();
    assert_eq!(masked.scored(), n - 100 - 100 - 40 - 100);
    let mut bad = good.clone();
    (0..n).filter(|k| unknown(*k)).for_each(|k| bad[k] = 1e6);
    let deviation = vec![0.3; n];
    let within = |estimate: &[f32]| masked.within_2_sigma(estimate, &deviation);
    assert_eq!(masked.score(&bad), masked.score(&good));
    assert_eq!(within(&bad), within(&good));
    bad[1250] = f32::NAN;
    assert_eq!(masked.score(&bad).non_finite, 0);
    // The scores of the whole trace but for the step, which is not known and has the transients.
    let steady = truth.iter().zip(&known).map(|(w, known)| (w, *known));
    let errors = steady.zip(&good).skip(100).filter(|((_, known), _)| *known);
    let squares: Vec<_> = errors
        .map(|((w, _), e)| (f64::from(*e) - w).powi(2))
        .collect();
    let rms = (squares.iter().sum::<f64>() / squares.len() as f64).sqrt();
    let found = masked.score(&good);
    near(found.rms_rad_s, rms, 1e-9);
    near(found.noise_rad_s, 0.5 / SQRT_2, 0.01);
    near(found.delay_ms, 3.0, 0.02);
    assert_eq!(found.distance_transient_rad_s, None);
    assert_eq!(
        Truth::where_known(
            &truth,
            Some(&vec![false; n]),
            RATE_HZ,
            interval(),
            Wanted::ALL
        )
        .unwrap()
        .score(&good),
        Score::default()
    );
}

#[test]
fn common_samples_of_ranges_are_in_both() {
    let some = [3..10, 12..14, 20..30];
    let others = [0..3, 4..6, 8..12, 12..13, 29..40];
    assert_eq!(common(&some, &others), [4..6, 8..10, 12..13, 29..30]);
    assert_eq!(common(&some, &[]), []);
    assert_eq!(common(&[], &some), []);
}

/// The ends of what is not known are no noise.
#[test]
fn slow_error_between_unknown_samples_has_no_noise() {
    let n = 30_000;
    let truth = vec![0.0; n];
    let slow = estimate(n, |t| (TAU * 0.5 * t).sin());
    let known: Vec<_> = (0..n).map(|k| k % 300 > 100).collect();
    let truth = Truth::where_known(&truth, Some(&known), RATE_HZ, interval(), Wanted::ALL).unwrap();
    near(truth.score(&slow).noise_rad_s, 0.0, 3e-3);
}

/// Half of the samples are known. Their noise is that of the whole trace, in which it is in all samples.
#[test]
fn noise_does_not_depend_on_the_share_of_known_samples() {
    let n = 30_000;
    let truth = vec![0.0; n];
    let noisy = estimate(n, |t| 0.7 * (TAU * 210.0 * t).sin());
    let known: Vec<_> = (0..n).map(|k| k % 600 < 300).collect();
    let truth = Truth::where_known(&truth, Some(&known), RATE_HZ, interval(), Wanted::ALL).unwrap();
    // The ends of 63 periods of the sine spread a little of its power beyond the band.
    near(truth.score(&noisy).noise_rad_s, 0.7 / SQRT_2, 0.02);
}

#[test]
fn delay_is_found_where_the_truth_is_known_late() {
    let ramp = |t: f64| 8.0 * t;
    let truth = signal(2500, ramp);
    let late = estimate(2500, |t| ramp(t - 0.003));
    let known: Vec<_> = (0..2500).map(|k| k >= 1000).collect();
    let truth = Truth::where_known(&truth, Some(&known), RATE_HZ, interval(), Wanted::ALL).unwrap();
    near(truth.score(&late).delay_ms, 3.0, 1e-3);
}
