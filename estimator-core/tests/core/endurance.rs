//! Long runs and bad input: no drift, no lost count, no output that is not finite.

use std::sync::LazyLock;

use estimator_core::{
    Amps, Count, Counts, Hertz, Input, Kalman, KalmanState, Model, MotorModel, Sample,
    VelocityEstimator,
};

use crate::every::{CURRENT_NOISE, Case, JERK, RATES, everywhere};
use crate::motion::{Draws, medley};
use crate::reference::Matrix;

static EVERY: LazyLock<Vec<Case>> = LazyLock::new(everywhere);

/// Asserts that P is finite, symmetric to the bit and positive definite.
#[track_caller]
fn assert_covariance<const S: usize, U: Input<S>>(
    filter: &Kalman<S, U>,
    state: &KalmanState<S>,
    what: &str,
) {
    let p = filter.covariance(state);
    for i in 0..S {
        for j in 0..S {
            assert!(p[i][j].is_finite(), "{what}: {p:?}");
            assert_eq!(p[i][j].to_bits(), p[j][i].to_bits(), "{what}: {p:?}");
        }
    }
    let exact = Matrix::<S>::from_fn(|i, j| f64::from(p[i][j]));
    assert!(exact.cholesky().is_some(), "{what}: {p:?}");
}

/// Alternately rest, the largest speed in both directions, and random counts.
fn abuse(tick: usize, draws: &mut Draws, count: Count) -> Sample {
    let step = match tick / 1000 % 4 {
        0 => 0,
        1 => 32_767,
        2 => draws.within(40_000) as i32,
        _ => -32_767,
    };
    let amps = Amps::new((draws.unit() * 6.0) as f32);
    Sample::new(count + Counts(step)).with_current(amps)
}

#[test]
fn covariance_stays_symmetric_and_positive() {
    for rate in RATES {
        for scale in [0.01, 1.0, 100.0] {
            let what = format!("{rate} Hz, noise times {scale}");
            let triple = Model::triple_integrator(4096, Hertz(rate), JERK * scale).unwrap();
            let triple = Kalman::new(&triple).unwrap();
            let motor =
                Model::motor(&MotorModel::DCX35L, Hertz(rate), CURRENT_NOISE * scale).unwrap();
            let motor = Kalman::new(&motor).unwrap();
            let mut sample = Sample::new(Count(0));
            let mut triple_state = triple.start(&sample);
            let mut motor_state = motor.start(&sample);
            assert_covariance(&triple, &triple_state, &what);
            assert_covariance(&motor, &motor_state, &what);
            let mut draws = Draws(rate as u64);
            for tick in 0..100_000 {
                sample = abuse(tick, &mut draws, sample.count);
                let fast = triple.update(&mut triple_state, &sample).0;
                let slow = motor.update(&mut motor_state, &sample).0;
                assert!(fast.is_finite() && slow.is_finite());
                assert_covariance(&triple, &triple_state, &what);
                assert_covariance(&motor, &motor_state, &what);
            }
        }
    }
}

/// Every design that is not refused gives finite outputs and comes to rest.
#[test]
fn accepted_designs_stay_finite_and_positive() {
    let mut tried = 0;
    for rate in [100.0, 1e3, 1e4, 1e5] {
        for counts_per_rev in [64, 4096, 4_000_000] {
            for exponent in -12..=24 {
                let noise = 10f64.powi(exponent);
                let what = format!("{counts_per_rev} counts, {rate} Hz, noise {noise:e}");
                let triple = Model::triple_integrator(counts_per_rev, Hertz(rate), noise);
                if let Ok(filter) = triple.and_then(|model| Kalman::new(&model)) {
                    assert_survives(&filter, &what);
                    tried += 1;
                }
                let device = MotorModel {
                    counts_per_rev,
                    ..MotorModel::DCX35L
                };
                let motor = Model::motor(&device, Hertz(rate), noise);
                if let Ok(filter) = motor.and_then(|model| Kalman::new(&model)) {
                    assert_survives(&filter, &what);
                    tried += 1;
                }
            }
        }
    }
    assert!(tried > 200, "{tried} accepted");
}

fn assert_survives<const S: usize, U: Input<S>>(filter: &Kalman<S, U>, what: &str) {
    let mut state = filter.start(&Sample::new(Count(0)));
    let mut draws = Draws(1);
    let mut count = Count(0);
    for _ in 0..3000 {
        count = count + Counts(draws.within(100) as i32);
        let output = filter.update(&mut state, &Sample::new(count));
        assert!(output.0.is_finite(), "{what}");
        assert_covariance(filter, &state, what);
    }
}

#[test]
fn bad_currents_leave_everything_finite_for_ever() {
    let bad = [
        f32::NAN,
        -f32::NAN,
        f32::INFINITY,
        f32::NEG_INFINITY,
        f32::MAX,
        f32::MIN,
        1e30,
        f32::MIN_POSITIVE / 8.0,
        -0.0,
    ];
    let motion = medley().samples(77);
    for case in EVERY.iter() {
        let mut draws = Draws(8);
        let mut run = case.make();
        run.start(&motion[0].with_current(Amps::new(f32::NAN)));
        for sample in &motion[1..] {
            let amps = Amps::new(bad[draws.bits() as usize % bad.len()]);
            let output = run.update(&sample.with_current(amps));
            assert!(output.is_finite(), "{}", case.name);
        }
        // At rest the effect of the earlier motion decays.
        let rest = motion[motion.len() - 1].with_current(Amps::ZERO);
        let outputs: Vec<f32> = (0..3 * case.memory + 3)
            .map(|_| run.update(&rest))
            .collect();
        assert!(
            outputs.iter().all(|output| output.is_finite()),
            "{}",
            case.name
        );
        assert!(outputs[outputs.len() - 1].abs() < 1e-5, "{}", case.name);
    }
    let mut draws = Draws(9);
    let motor = Model::motor(&MotorModel::DCX35L, Hertz(1000.0), CURRENT_NOISE).unwrap();
    let motor = Kalman::new(&motor).unwrap();
    let mut state = motor.start(&motion[0]);
    for sample in &motion {
        let amps = Amps::new(bad[draws.bits() as usize % bad.len()]);
        assert!(amps.get().abs() <= Amps::MAX);
        motor.update(&mut state, &sample.with_current(amps));
        assert_covariance(&motor, &state, "bad currents");
    }
}

#[test]
fn huge_jumps_leave_everything_finite() {
    let jumps = [
        i32::MIN,
        i32::MAX,
        -i32::MAX,
        1 << 15,
        -(1 << 15),
        (1 << 15) - 1,
        1 << 30,
    ];
    for case in EVERY.iter() {
        let mut draws = Draws(4);
        let mut count = Count(3);
        let mut run = case.make();
        run.start(&Sample::new(count));
        for tick in 0..3000 {
            let step = match tick % 3 {
                0 => jumps[draws.bits() as usize % jumps.len()],
                1 => draws.bits() as i32,
                _ => draws.within(3) as i32,
            };
            count = count + Counts(step);
            let output = f64::from(run.update(&Sample::new(count)));
            let bound = 2f64.powi(31) * case.per_count * 1.001;
            assert!(output.abs() <= bound, "{}: {output}", case.name);
        }
        let mut last = f32::NAN;
        for _ in 0..3 * case.memory + 3 {
            last = run.update(&Sample::new(count));
        }
        assert!(last.abs() < 1e-3, "{}: {last} at rest", case.name);
    }
}
