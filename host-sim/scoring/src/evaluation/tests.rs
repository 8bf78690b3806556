//! Tests of the evaluation of a trace.

use super::*;
use crate::score::{Truth, is_within_2_sigma};
use simulation::device::Device;
use simulation::scenario::ScenarioName;
use simulation::simulate::simulate;
use simulation::trace::Columns;

/// A track at 1 kHz with the signals of an observer.
fn track(seconds: f64) -> Trace {
    let columns = Columns {
        counts_small: true,
        edges: false,
    };
    let device = Device::default();
    simulate(&device, ScenarioName::Track, 1000.0, 1, seconds, columns).unwrap()
}

/// These estimators as shipped, at 1 kHz.
fn evaluation(names: &[&str]) -> Evaluation {
    let kinds: Vec<_> = names
        .iter()
        .map(|name| Kind::named(name).unwrap())
        .collect();
    let setup = Setup::of(&Device::default(), 1000.0);
    Evaluation::new(&kinds, &Parameters::default(), &setup, PlantKind::Friction).unwrap()
}

#[test]
fn learned_damping_is_that_of_the_estimate_or_of_a_run() {
    let (trace, evaluation) = (track(3.0), evaluation(&["adaptive", "pll"]));
    let [adaptive, pll] = evaluation.candidates() else {
        panic!("two candidates");
    };
    let mut estimates = evaluation.estimates(&trace);
    let learned = |of, estimates: &[Estimate]| evaluation.learned_damping(of, &trace, estimates);
    let run = learned(adaptive, &[]).unwrap();
    assert_ne!(run[0], run[2999], "the damping is learned");
    assert_eq!(learned(adaptive, &estimates), Some(run));
    assert_eq!(learned(pll, &estimates), None);
    estimates[0].damping_ratio = Some(vec![2.0; 3000]);
    let twice = vec![2.0 * evaluation.assumed_damping(); 3000];
    assert_eq!(learned(adaptive, &estimates), Some(twice));
}

#[test]
fn within_2_sigma_is_the_share_after_the_start() {
    let velocity = [9.0, 1.0, 1.0, 1.0, 1.0];
    let deviation = [0.0, 0.5, 0.5, 0.4, 0.0];
    let omega = [0.0, 2.0, 2.1, 1.5, 1.0];
    let interval = HapticInterval::new(0.1, 0.01, 0.07, 1e-3);
    let share = |rate_hz, known: Option<&[bool]>| {
        let truth = Truth::where_known(&omega, known, rate_hz, interval, Wanted::NONE).unwrap();
        truth.within_2_sigma(&velocity, &deviation)
    };
    // At 10 Hz the first 0.1 s, which are not scored, are one sample.
    assert_eq!(share(10.0, None), Some(0.75));
    assert_eq!(
        share(10.0, Some(&[true, true, false, true, false])),
        Some(1.0)
    );
    assert_eq!(share(50.0, None), None, "none is scored");
}

#[test]
fn two_sigma_are_twice_the_deviation_either_way() {
    for (velocity, inside) in [(3.0, true), (7.0, true), (2.99, false), (7.01, false)] {
        assert_eq!(is_within_2_sigma(velocity, 1.0, 5.0), inside, "{velocity}");
    }
}

#[test]
fn damping_is_the_mean_of_the_last_tenth() {
    // Of 25 values the last three.
    let mut values = vec![100.0; 25];
    values[22..].copy_from_slice(&[1.0, 2.0, 6.0]);
    assert_eq!(last_tenth(&values), 3.0);
    assert_eq!(last_tenth(&[7.0]), 7.0);
}

#[test]
fn error_of_the_damping_is_relative_and_without_the_start() {
    let mut trace = Trace {
        rate_hz: 10.0,
        counts_large: vec![0; 32],
        ..Trace::default()
    };
    assert_eq!(damping_error(&[1.0; 32], &trace), None);
    // The first 3 s are 30 samples. After them the errors are 30 and -40 % of the truth.
    let mut truth = vec![1e-9; 30];
    truth.extend([2.0, 5.0]);
    trace.true_damping = Some(truth);
    let mut learned = vec![1.0; 30];
    learned.extend([2.6, 3.0]);
    let error = damping_error(&learned, &trace).unwrap();
    assert!((error - 1250.0_f64.sqrt()).abs() < 1e-9, "{error}");
    assert_eq!(damping_error(&learned[..30], &trace), None);
}

#[test]
fn rows_name_the_values_of_the_parameters() {
    let evaluation = evaluation(&["pll"]);
    let candidate = &evaluation.candidates()[0];
    let values = candidate.named_values();
    assert_eq!(values.len(), candidate.kind.parameters.len());
    for (parameter, value) in candidate.kind.parameters.iter().zip(&candidate.values) {
        assert_eq!(values.get(parameter.name), Some(value));
    }
}

#[test]
fn rows_are_those_of_the_estimates_relative_to_finite_difference() {
    let trace = track(4.0);
    let kinds = ["pll", "adaptive", "finite-difference"];
    let heading = Heading {
        scenario: "track".to_owned(),
        rate_hz: 1000.0,
        plant: PlantKind::Friction,
        seed: 7,
    };
    let interval = HapticInterval::new(0.1, 0.01, 0.07, 1e-3);
    let evaluated = |kinds: &[&str], trace: &Trace| {
        let evaluation = evaluation(kinds);
        let estimates = evaluation.estimates(trace);
        let rows = evaluation.rows(&heading, trace, &estimates, interval, Wanted::ALL);
        (rows.unwrap(), estimates)
    };
    let rows = |kinds: &[&str], trace: &Trace| evaluated(kinds, trace).0;
    let (found, estimates) = evaluated(&kinds, &trace);
    let omega = trace.true_omega.as_deref().unwrap();
    for (row, estimate) in found.iter().zip(&estimates) {
        let truth = Truth::new(omega, 1000.0, interval, Wanted::NONE).unwrap();
        let deviation = estimate.deviation.as_ref();
        let within = deviation.and_then(|sd| truth.within_2_sigma(&estimate.velocity, sd));
        assert_eq!(row.score.within_2_sigma, within, "{}", row.estimator);
    }
    let reports = |row: &Row| row.score.within_2_sigma.is_some();
    assert!(reports(&found[1]) && !reports(&found[0]));
    let names: Vec<_> = found.iter().map(|row| row.estimator).collect();
    assert_eq!(names, kinds);
    let rms = |row: &Row| row.score.rms_rad_s.unwrap();
    for row in &found {
        assert_eq!((&*row.scenario, row.seed), ("track", 7));
        let expected = 100.0 * rms(row) / rms(&found[2]);
        assert_eq!(row.score.rms_pct, Some(expected), "{}", row.estimator);
        // The adaptive observer alone learns the damping, which the trace has.
        let learns = row.estimator == "adaptive";
        assert_eq!(row.score.learned_damping_nms_per_rad.is_some(), learns);
        assert_eq!(row.score.learned_damping_pct.is_some(), learns);
    }
    assert!(rms(&found[1]) < rms(&found[0]) && rms(&found[0]) < rms(&found[2]));
    // The reference is computed where it is not among the estimators.
    assert_eq!(rows(&kinds[..1], &trace)[0].score, found[0].score);
    let unknown = Trace {
        true_omega: None,
        ..trace
    };
    assert!(rows(&kinds, &unknown).is_empty());
}

#[test]
fn samples_at_which_the_velocity_is_not_known_are_in_no_row() {
    let mut trace = track(2.0);
    let evaluation = evaluation(&["pll", "finite-difference"]);
    let estimates = evaluation.estimates(&trace);
    let heading = Heading {
        scenario: "track".to_owned(),
        rate_hz: 1000.0,
        plant: PlantKind::Friction,
        seed: 1,
    };
    let interval = HapticInterval::new(0.1, 0.01, 0.07, 1e-3);
    let is_known = |k: usize| !(900..1200).contains(&k);
    let omega = trace.true_omega.clone().unwrap();
    trace.known = Some((0..2000).map(is_known).collect());
    trace.true_omega.as_mut().unwrap()[1000..1100].fill(1e4);
    let rows = evaluation.rows(&heading, &trace, &estimates, interval, Wanted::ALL);
    let rms = |velocity: &[f32]| {
        let scored = (100..2000).filter(|k| is_known(*k));
        let squares: f64 = scored
            .map(|k| (f64::from(velocity[k]) - omega[k]).powi(2))
            .sum();
        (squares / 1600.0).sqrt()
    };
    let difference = rms(&estimates[1].velocity);
    for (row, estimate) in rows.unwrap().iter().zip(&estimates) {
        let expected = rms(&estimate.velocity);
        let [found, share] = [row.score.rms_rad_s, row.score.rms_pct].map(Option::unwrap);
        assert!((found / expected - 1.0).abs() < 1e-12, "{found} {expected}");
        assert!((share / (100.0 * expected / difference) - 1.0).abs() < 1e-12);
    }
}
