//! Preset gains against the plain recursion, run until it stops changing.

use estimator_core::{
    Count, DesignError, Hertz, Input, Kalman, Model, MotorModel, Sample, VelocityEstimator,
};

use crate::every::{CURRENT_NOISE, JERK, RATES};
use crate::reference::{self, Reference};

/// Both accept with the same gain, or both refuse; returns whether they accepted.
///
/// The core promises to refuse what takes more than 2^20 ticks. What stands still only in the
/// last doubling before that may go either way: the core looks for the change of 1e-12, which the
/// rounding of a million plain steps hides.
fn agree<const S: usize, U: Copy>(ours: &Model<S, U>, model: &Reference<S>, what: &str) -> bool {
    match (ours.steady_gain(), model.settled()) {
        (Ok(ours), Some((limit, _))) => {
            for (ours, limit) in ours.iter().zip(&limit) {
                let error = (f64::from(*ours) / limit - 1.0).abs();
                assert!(error < 1e-6, "{what}: {ours} against {limit}");
            }
            let rounded = reference::Vector::from_fn(|i, _| f64::from(ours[i]));
            let radius = model.spectral_radius(&rounded);
            assert!(radius < 1.0, "{what}: spectral radius {radius}");
            true
        }
        (Err(error), None | Some((_, 20))) => {
            assert_eq!(error, DesignError::NOT_CONVERGED, "{what}");
            false
        }
        (ours, limit) => panic!("{what}: {ours:?} against {limit:?}"),
    }
}

const HERTZ: [f64; 4] = [100.0, 1e3, 1e4, 1e5];
const LINES: [u32; 3] = [16, 1024, 1_000_000];

#[test]
fn triple_integrator_settles_where_the_recursion_does() {
    let (mut accepted, mut refused) = (0, 0);
    for rate in HERTZ {
        for lines in LINES {
            for exponent in [-9, -6, -3, 1, 4, 7, 15] {
                let noise = 2.7 * 10f64.powi(exponent);
                let ours = Model::triple_integrator(4 * lines, Hertz(rate), noise).unwrap();
                let model = reference::triple(4 * lines, rate, noise);
                let what = format!("{lines} lines, {rate} Hz, {noise:e}");
                if agree(&ours, &model, &what) {
                    accepted += 1;
                } else {
                    refused += 1;
                }
            }
        }
    }
    assert!(accepted > 30 && refused > 5, "{accepted} and {refused}");
}

#[test]
fn motor_settles_where_the_recursion_does() {
    let (mut accepted, mut refused) = (0, 0);
    for rate in HERTZ {
        for lines in LINES {
            for exponent in [-9, -7, -4, -2, 0, 2] {
                let noise = 2.7 * 10f64.powi(exponent);
                let device = MotorModel {
                    counts_per_rev: 4 * lines,
                    ..MotorModel::DCX35L
                };
                let ours = Model::motor(&device, Hertz(rate), noise).unwrap();
                let model = reference::motor_reduced(&device, rate, noise);
                let what = format!("{lines} lines, {rate} Hz, {noise:e} A");
                if agree(&ours, &model, &what) {
                    accepted += 1;
                } else {
                    refused += 1;
                }
            }
        }
    }
    assert!(accepted > 30 && refused > 5, "{accepted} and {refused}");
}

#[test]
fn run_time_covariance_settles_to_the_preset_gain() {
    for rate in RATES {
        for scale in [1e-2, 1.0, 1e2] {
            let triple = Model::triple_integrator(4096, Hertz(rate), JERK * scale).unwrap();
            settles(
                &triple,
                &format!("triple at {rate} Hz, noise times {scale}"),
            );
            let motor =
                Model::motor(&MotorModel::DCX35L, Hertz(rate), CURRENT_NOISE * scale).unwrap();
            settles(&motor, &format!("motor at {rate} Hz, noise times {scale}"));
        }
    }
}

fn settles<const S: usize, U: Input<S>>(model: &Model<S, U>, what: &str) {
    let filter = Kalman::new(model).unwrap();
    let sample = Sample::new(Count(0));
    let mut state = filter.start(&sample);
    for _ in 0..100_000 {
        filter.update(&mut state, &sample);
    }
    // After an update P H^T / r is the gain.
    let preset = model.steady_gain().unwrap();
    for (row, preset) in filter.covariance(&state).iter().zip(preset) {
        let gain = f64::from(row[0]) / reference::R;
        // The recursion stalls where its change rounds to nothing: the square root of the number
        // of ticks it remembers, or so, times the rounding.
        let error = (gain / f64::from(preset) - 1.0).abs();
        assert!(error < 1e-3, "{what}: {gain} against {preset}");
    }
}

/// Noise of which f64 cannot hold the variance is none: of 1e-162 A that of the position is below
/// 5e-324, and that of the velocity still is not.
#[test]
fn noise_whose_square_underflows_is_refused() {
    for noise in [1e-162, 1e-170] {
        let motor = Model::motor(&MotorModel::DCX35L, Hertz(1000.0), noise);
        assert_eq!(motor.err(), Some(DesignError::CURRENT_NOISE), "{noise} A");
        let triple = Model::triple_integrator(4096, Hertz(1000.0), noise);
        assert_eq!(triple.err(), Some(DesignError::JERK_DENSITY), "{noise}");
    }
    assert!(Model::motor(&MotorModel::DCX35L, Hertz(1000.0), 1e-160).is_ok());
}

#[test]
fn model_names_the_parameter_out_of_range() {
    let rate = Hertz(1000.0);
    let motor =
        |device: MotorModel, rate: f64, noise: f64| Model::motor(&device, Hertz(rate), noise);
    for bad in [0.0, -1.0, f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        let triple = Model::triple_integrator(4096, Hertz(bad), JERK);
        assert_eq!(triple.err(), Some(DesignError::RATE));
        assert_eq!(
            motor(MotorModel::DCX35L, bad, 0.1).err(),
            Some(DesignError::RATE)
        );
        let triple = Model::triple_integrator(4096, rate, bad);
        assert_eq!(triple.err(), Some(DesignError::JERK_DENSITY), "{bad}");
        assert_eq!(
            motor(MotorModel::DCX35L, 1e3, bad).err(),
            Some(DesignError::CURRENT_NOISE)
        );
        let inertia = MotorModel {
            inertia: bad,
            ..MotorModel::DCX35L
        };
        assert_eq!(motor(inertia, 1e3, 0.1).err(), Some(DesignError::INERTIA));
        let torque_constant = MotorModel {
            torque_constant: bad,
            ..MotorModel::DCX35L
        };
        assert_eq!(
            motor(torque_constant, 1e3, 0.1).err(),
            Some(DesignError::TORQUE_CONSTANT)
        );
        let damping = MotorModel {
            damping: bad,
            ..MotorModel::DCX35L
        };
        let refused = motor(damping, 1e3, 0.1).err();
        let error = (bad != 0.0).then_some(DesignError::DAMPING);
        assert_eq!(refused, error, "damping {bad}");
    }
    let none = MotorModel {
        counts_per_rev: 0,
        ..MotorModel::DCX35L
    };
    assert_eq!(
        motor(none, 1e3, 0.1).err(),
        Some(DesignError::COUNTS_PER_REV)
    );
    assert_eq!(
        Model::triple_integrator(0, rate, JERK).err(),
        Some(DesignError::COUNTS_PER_REV)
    );
}
