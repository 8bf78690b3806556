//! Adaptation of the parameters, and motions that must not change them.

use estimator_core::{
    Adaptation, Adaptive, AmplifierCurrent, Amps, Correction, Count, CoupledEncoder, CoupledMotor,
    HeldShaft, Hertz, Observer, ObserverDesign, Sample, Uncertainty, VelocityEstimator,
};

use super::modelled::{modelled, modelled_over, rms};
use super::{CLOCK, UNSURE, at};

/// The parameters of a motor whose damping, friction and torque constant are wrong are estimated.
#[test]
fn wrong_parameters_are_estimated() {
    let rate = Hertz(1000.0);
    let assumed = CoupledMotor::DCX35L;
    for (damping, inertia, friction) in [(0.7, 1.0, 1.0), (1.3, 1.2, 0.7), (0.8, 0.8, 1.4)] {
        let mut device = assumed;
        device.motor.damping *= damping;
        device.motor.inertia *= inertia;
        device.coulomb_friction *= friction;
        let (samples, truth) = modelled(rate.0, 12.0, 0.3, device);
        let edges = ObserverDesign::new(&assumed, rate, &UNSURE).with_edges(CLOCK);
        let fixed = at(rate.0);
        let fixed = fixed
            .iter()
            .find(|case| case.name.starts_with("observer, edges at"));
        let fixed = rms(&(fixed.expect("there").run)(&samples), &truth, 6000);

        let estimator = edges.adaptive().build().expect("valid");
        let mut state = estimator.start(&samples[0]);
        let mut velocities = Vec::new();
        for sample in &samples[1..] {
            velocities.push(estimator.update(&mut state, sample).0);
        }
        let errors = f64::from(estimator.parameter_errors(&state).damping_ratio());
        assert!(
            (errors / damping - 1.0).abs() < 0.05,
            "{errors} for {damping}"
        );
        let error = rms(&velocities, &truth, 6000);
        assert!(error < 0.5 * fixed, "{error} of {fixed}");
    }
}

/// A model that is wrong by a factor of ten, has no friction or the wrong sign of the torque constant is
/// learned without the small encoder: the torque constant per inertia, and a velocity that is nearly as
/// good as with the right model.
#[test]
fn model_of_another_device_is_learned() {
    let rate = Hertz(1000.0);
    let device = CoupledMotor::DCX35L;
    let (samples, truth) = modelled_over(0.0, rate.0, 8.0, 0.3, device);
    let turned = samples.iter().map(|sample| {
        let current = Amps::new(-sample.current.get());
        sample.with_current(current)
    });
    let turned: Vec<Sample> = turned.collect();
    let design = |assumed: &CoupledMotor| ObserverDesign::new(assumed, rate, &UNSURE).held();
    let with = |inertia: f64, torque_constant: f64, damping: f64, friction: f64| {
        let mut assumed = device;
        assumed.motor.inertia *= inertia;
        assumed.motor.torque_constant *= torque_constant;
        assumed.motor.damping *= damping;
        assumed.coulomb_friction *= friction;
        assumed
    };
    let from = 4000;
    // The largest error that learning may leave, in parts of that without: a twentieth, from counts and with
    // edges. The gains stay those of the model: with a tenth of the inertia they are too large. Without friction the
    // model is wrong by one parameter of three, and the error without learning is small.
    for (assumed, sign, what, parts) in [
        (with(10.0, 1.0, 1.0, 1.0), 1.0, "inertia 10", [0.05; 2]),
        (with(0.1, 1.0, 1.0, 1.0), 1.0, "inertia 0.1", [0.75, 0.05]),
        (
            with(1.0, 3.0, 1.0, 1.0),
            1.0,
            "torque constant 3",
            [0.05; 2],
        ),
        (with(1.0, 1.0, 5.0, 1.0), 1.0, "damping 5", [0.05; 2]),
        (with(1.0, 1.0, 1.0, 0.0), 1.0, "no friction", [0.6, 0.35]),
        (with(1.0, 1.0, 1.0, 1.0), -1.0, "sign", [0.05; 2]),
    ] {
        let samples = if sign > 0.0 { &samples } else { &turned };
        let right = sign * assumed.motor.inertia / assumed.motor.torque_constant
            * device.motor.torque_constant
            / device.motor.inertia;
        let fixed = run(&design(&assumed).build().expect("valid"), samples).0;
        let fixed = rms(&fixed, &truth, from);
        let counts = design(&assumed).widely_adaptive();
        let edges = run(&counts.with_edges(CLOCK).build().expect("valid"), samples);
        let counts = run(&counts.build().expect("valid"), samples);
        for ((velocities, gain), part) in [(counts, parts[0]), (edges, parts[1])] {
            let error = rms(&velocities, &truth, from);
            assert!(error < part * fixed, "{what}: {error} of {fixed}");
            // Within 30 % of the larger of the true and the assumed one.
            let allowed = 0.3 * right.abs().max(1.0);
            assert!((gain - right).abs() < allowed, "{what}: {gain} for {right}");
        }
    }
}

/// Velocities of an observer, and the torque constant per inertia that it ends with, in parts of that of
/// its model.
fn run<M: Correction, L: Adaptation>(
    estimator: &Observer<AmplifierCurrent, HeldShaft, M, L>,
    samples: &[Sample],
) -> (Vec<f32>, f64) {
    let mut state = estimator.start(&samples[0]);
    let update = |sample| estimator.update(&mut state, sample).0;
    let velocities = samples[1..].iter().map(update).collect();
    let learned = estimator.parameter_errors(&state).torque_constant;
    (velocities, 1.0 + f64::from(learned))
}

/// After a moving start only the velocity is unknown: the parameters of the design are correct.
#[test]
fn moving_start_changes_no_parameter() {
    let rate = Hertz(10_000.0);
    // Small gains, as one that learns is tuned to.
    let sure = Uncertainty {
        torque_noise: 5.75e-6,
        disturbance: 1.38e-4,
        boundary_noise: 0.0625,
        ..UNSURE
    };
    let counts = ObserverDesign::new(&CoupledMotor::DCX35L, rate, &sure);
    moving_start(&counts.adaptive().build().expect("valid"), rate, 0.003);
    let quantised = ObserverDesign::quantised(&CoupledMotor::DCX35L, rate, &sure);
    // With one count in every tick a count has least information.
    moving_start(&quantised.adaptive().build().expect("valid"), rate, 0.0045);
}

fn moving_start<M: Correction>(
    estimator: &Observer<AmplifierCurrent, CoupledEncoder, M, Adaptive>,
    rate: Hertz,
    bound: f64,
) {
    let (samples, truth) = modelled(rate.0, 4.0, 0.4, CoupledMotor::DCX35L);
    // 0.3 counts a tick are 4.6 rad/s.
    let fast = (0..samples.len() - 2500).filter(|k| truth[*k].abs() > 0.3);
    let starts: Vec<usize> = fast.step_by(500).collect();
    assert!(starts.len() > 20, "{starts:?}");
    for start in starts {
        let samples = &samples[start..start + 2500];
        let mut state = estimator.start(&samples[0]);
        let mut velocities = Vec::new();
        for sample in &samples[1..] {
            velocities.push(estimator.update(&mut state, sample).0);
        }
        let error = rms(&velocities, &truth[start..start + 2500], 200);
        assert!(error < bound, "{error} from tick {start}");
        let errors = estimator.parameter_errors(&state);
        let errors = [errors.damping, errors.friction, errors.torque_constant];
        assert!(
            errors.iter().all(|deviation| deviation.abs() < 0.05),
            "{errors:?} from tick {start}"
        );
    }
}

/// In creep friction hides the rest: a current just above it, and fewer counts than it should
/// give, teach nothing.
#[test]
fn creep_changes_no_parameter() {
    let rate = Hertz(1000.0);
    let counts = ObserverDesign::new(&CoupledMotor::DCX35L, rate, &UNSURE);
    let estimator = counts.adaptive().build().expect("valid");
    let mut state = estimator.start(&Sample::new(Count(7)));
    let fresh = estimator.parameter_errors(&state);
    let mut fastest = 0.0f32;
    for tick in 0..10_000u32 {
        // 4.2 of 4.0 mN.m: 0.22 rad/s, 0.14 counts a tick.
        let sample = Sample::new(Count(7 + tick / 20)).with_current(Amps::new(0.09));
        fastest = fastest.max(estimator.update(&mut state, &sample).0);
    }
    assert!(fastest > 0.02, "{fastest}");
    assert_eq!(estimator.parameter_errors(&state), fresh);
}

/// Where every tick may have an edge, the parameters are updated by one edge in 3.5 ms: the
/// innovations of the others are correlated with it.
#[test]
fn edges_update_parameters_once_in_3_5_ms() {
    for rate in [5_000.0, 10_000.0, 20_000.0] {
        let hertz = Hertz(rate);
        let seconds = 2.0;
        let (samples, truth) = modelled(rate, seconds, 0.4, CoupledMotor::DCX35L);
        let counts = ObserverDesign::new(&CoupledMotor::DCX35L, hertz, &UNSURE);
        let edges = counts.with_edges(CLOCK).adaptive();
        let edges = edges.build().expect("valid");
        let mut state = edges.start(&samples[0]);
        let (mut updates, mut before) = (0, *state.adaptation().diagonal());
        for sample in &samples[1..] {
            edges.update(&mut state, sample);
            updates += u32::from(*state.adaptation().diagonal() != before);
            before = *state.adaptation().diagonal();
        }
        // Above 5 rad/s there is an edge a millisecond or more.
        let fast = 5.0 * 4096.0 / std::f64::consts::TAU / rate;
        let moving = truth.iter().filter(|v| v.abs() > fast).count() as f64 / rate;
        let updates = f64::from(updates);
        assert!(updates <= seconds / 3.5e-3 + 1.0, "{updates} at {rate} Hz");
        // An update waits for the next edge after 3.5 ms: within a millisecond.
        assert!(
            updates >= moving / 4.5e-3,
            "{updates} in {moving} s at {rate} Hz"
        );
    }
}
