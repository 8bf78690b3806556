//! The filters with a table of gains against the textbook's.

use estimator_core::{
    Confidence, Count, DesignError, Hertz, Kalman, Model, MotorModel, Sample, TableKalmanMotor,
    TableKalmanTriple, VelocityEstimator,
};

use super::{DEVIATION, START_DEVIATION, Textbook, largest_difference, motion, run};
use crate::every::{CURRENT_NOISE, JERK, RATES};
use crate::reference::{self, Reference};

/// A table gives what the full filter gives, from any start: in motion, at a boundary of the
/// motion's stretches, and long after it ended.
#[test]
fn tables_follow_the_textbook_and_the_full_filter_after_any_start() {
    let motion = motion();
    let samples = motion.samples(u32::MAX - 500);
    for rate in RATES {
        let triple = reference::triple(4096, rate, JERK);
        let model = Model::triple_integrator(4096, Hertz(rate), JERK).unwrap();
        let full = Kalman::new(&model).unwrap();
        let table = TableKalmanTriple::<128>::new(&model).unwrap();
        let motor = reference::motor_reduced(&MotorModel::DCX35L, rate, CURRENT_NOISE);
        let motor_model = Model::motor(&MotorModel::DCX35L, Hertz(rate), CURRENT_NOISE).unwrap();
        let motor_full = Kalman::new(&motor_model).unwrap();
        let motor_table = TableKalmanMotor::<512>::new(&motor_model).unwrap();
        for start in (0..1500).step_by(50) {
            let mut textbook = Textbook::new(&triple, motion.counts[start] as f64);
            let mut motor_textbook = Textbook::new(&motor, motion.counts[start] as f64);
            let (mut expected, mut motor_expected) = (Vec::new(), Vec::new());
            for tick in start + 1..motion.counts.len() {
                let position = motion.counts[tick] as f64;
                textbook.tick(0.0, position);
                expected.push(textbook.x[1]);
                motor_textbook.tick(f64::from(motion.amps[tick]), position);
                motor_expected.push(motor_textbook.x[1]);
            }
            let what = format!("{rate} Hz, from {start}");
            for (ours, full, expected) in [
                (
                    run(&table, &samples[start..]),
                    run(&full, &samples[start..]),
                    expected,
                ),
                (
                    run(&motor_table, &samples[start..]),
                    run(&motor_full, &samples[start..]),
                    motor_expected,
                ),
            ] {
                let difference = largest_difference(&ours, &expected);
                assert!(difference < DEVIATION / 10.0, "{what}: {difference}");
                let difference = largest_difference(&ours, &full);
                assert!(difference < START_DEVIATION, "{what}: {difference}");
            }
        }
    }
}

/// As many ticks as the documentation says: with one gain less it has not settled.
#[test]
fn table_that_ends_too_early_is_refused() {
    let model = Model::triple_integrator(4096, Hertz(1e3), 1e3).unwrap();
    assert!(TableKalmanTriple::<37>::new(&model).is_ok());
    let refused = TableKalmanTriple::<36>::new(&model).err();
    assert_eq!(refused, Some(DesignError::TABLE));
    let model = Model::triple_integrator(4096, Hertz(1e4), 3650.0).unwrap();
    assert!(TableKalmanTriple::<167>::new(&model).is_ok());
    let refused = TableKalmanTriple::<166>::new(&model).err();
    assert_eq!(refused, Some(DesignError::TABLE));
    assert!(TableKalmanTriple::<0>::new(&model).is_err());
}

/// The velocity's variance of a table is the textbook's P_11, from before the first tick on.
#[test]
fn tables_report_the_variance_of_the_velocity() {
    for rate in RATES {
        let model = reference::triple(4096, rate, JERK);
        let ours = Model::triple_integrator(4096, Hertz(rate), JERK).unwrap();
        let filter = TableKalmanTriple::<128>::new(&ours).unwrap();
        let sample = Sample::new(Count(1));
        let mut state = filter.start(&sample);
        let mut p = model.p0;
        for tick in 0..200 {
            let ours = f64::from(filter.variance(&state).0);
            let error = (ours / p[(1, 1)] - 1.0).abs();
            assert!(error < 1e-5, "{rate} Hz, {tick}: {ours}, {}", p[(1, 1)]);
            filter.update(&mut state, &sample);
            p = model.predicted(&p);
            p = Reference::updated(&p, &Reference::gain(&p));
        }
    }
}
