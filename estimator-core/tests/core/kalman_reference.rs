//! The core's filters against the textbook's, in f64 and with absolute positions.
//!
//! The deviation that f32 may cause: each tick rounds the state by at most ε = 2^-24 of the
//! largest velocity in sight, and the filter remembers about as many ticks as its slowest pole
//! says, so the errors add up to fewer than `memory` roundings. The gain of the run-time
//! covariance is rounded as well: a relative error of a few ε times the innovation.

mod tables;

use estimator_core::{
    Amps, Count, CountsPerTick, Hertz, Kalman, KalmanMotor, KalmanTriple, LateCurrent, Model,
    MotorModel, Sample, Scale, SteadyKalman, VelocityEstimator,
};

use crate::every::{CURRENT_NOISE, JERK, RATES};
use crate::motion::{Motion, Stretch};
use crate::reference::{self, Matrix, R, Reference, Vector};

/// The filter as eqs. 9 to 12 print it: state, covariance, absolute position.
struct Textbook<const S: usize> {
    model: Reference<S>,
    x: Vector<S>,
    p: Matrix<S>,
    /// A gain that replaces that of the covariance.
    preset: Option<Vector<S>>,
}

impl<const S: usize> Textbook<S> {
    fn new(model: &Reference<S>, position: f64) -> Self {
        let mut x = Vector::zeros();
        x[0] = position;
        Self {
            model: model.clone(),
            x,
            p: model.p0,
            preset: None,
        }
    }

    /// Predicts with `input`, then takes the position in.
    fn tick(&mut self, input: f64, position: f64) {
        self.x = self.model.a * self.x + self.model.b * input;
        self.p = self.model.predicted(&self.p);
        let k = self.preset.unwrap_or_else(|| Reference::gain(&self.p));
        self.x += k * (position - self.x[0]);
        self.p = Reference::updated(&self.p, &k);
    }
}

/// A motion with everything, starting in motion, with a step of current now and then.
fn motion() -> Motion {
    let mut motion = Motion::of(
        &[
            (Stretch::Slope(11.3), 100),
            (Stretch::Walk(3, 4), 200),
            (Stretch::Rest, 200),
            (Stretch::Creep(13, true), 300),
            (Stretch::Sine(400.0, 150.0), 600),
            (Stretch::Slope(-57.9), 400),
            (Stretch::Rest, 300),
        ],
        6,
    );
    let count = motion.amps.len();
    for tick in 0..count {
        motion.amps[tick] = (motion.amps[tick] * 3.0).round() / 2.0 + (tick / 90 % 3) as f32;
    }
    motion
}

/// Largest difference of two velocity signals, in counts a tick.
fn largest_difference(one: &[f64], other: &[f64]) -> f64 {
    assert_eq!(one.len(), other.len());
    let differences = one.iter().zip(other).map(|(a, b)| (a - b).abs());
    differences.fold(0.0, f64::max)
}

fn run<E: VelocityEstimator>(estimator: &E, samples: &[Sample]) -> Vec<f64> {
    let mut state = estimator.start(&samples[0]);
    let update = |sample| f64::from(estimator.update(&mut state, sample).0);
    samples[1..].iter().map(update).collect()
}

/// 2^-24 of the fastest motion here, 60 counts a tick, over a memory of some hundred ticks.
const DEVIATION: f64 = 60.0 * 300.0 / 16_777_216.0;

/// Soon after a start the full filter's P is off by up to 2e-3 of itself (see `assert_near`) and
/// its gain by half as much, which an innovation of 5 counts meets: a motor model in a motion of
/// 60 counts a tick that no current explains.
const START_DEVIATION: f64 = 5e-3;

#[test]
fn model_of_the_triple_integrator_is_that_of_van_loan() {
    for (rate, counts) in [(1e3, 4096), (1.16e4, 4096), (1e5, 20_000), (100.0, 64)] {
        let ours = Model::triple_integrator(counts, Hertz(rate), JERK).unwrap();
        let theirs = reference::triple(counts, rate, JERK);
        assert_same(ours.transition(), &theirs.a);
        assert_same(ours.process_noise(), &theirs.q);
        assert_eq!(ours.measurement_noise(), R);
        assert_eq!(ours.prior().as_slice(), &reference::PRIOR);
    }
}

#[test]
fn model_of_the_motor_is_the_matrix_exponential() {
    let stiff = MotorModel {
        damping: 0.5,
        ..MotorModel::DCX35L
    };
    let undamped = MotorModel {
        damping: 0.0,
        ..MotorModel::DCX35L
    };
    for device in [MotorModel::DCX35L, stiff, undamped] {
        for rate in [100.0, 1e3, 1e4, 1.16e4, 1e5] {
            let ours = Model::motor(&device, Hertz(rate), CURRENT_NOISE).unwrap();
            let theirs = reference::motor_reduced(&device, rate, CURRENT_NOISE);
            assert_same(ours.transition(), &theirs.a);
            assert_same(ours.process_noise(), &theirs.q);
            // B_0 is a product of two rounded numbers, rounded.
            let b = ours.input().per_amp();
            let b = b.iter().zip(&theirs.b).zip([3.0, 1.0]);
            for ((ours, theirs), roundings) in b {
                let error = (f64::from(*ours) / theirs - 1.0).abs();
                assert!(error <= roundings / 16_777_216.0, "{ours} {theirs}");
            }
        }
    }
}

#[track_caller]
fn assert_same<const S: usize>(ours: &[[f64; S]; S], theirs: &Matrix<S>) {
    for i in 0..S {
        for j in 0..S {
            let (ours, theirs) = (ours[i][j], theirs[(i, j)]);
            // Padé's exponential is good to 1e-15 of the largest element, the rest less.
            let close = (ours - theirs).abs() <= 1e-10 * theirs.abs() + 1e-16;
            assert!(close, "element {i} {j}: {ours} against {theirs}");
        }
    }
}

#[test]
fn triple_follows_the_textbook() {
    let motion = motion();
    for rate in RATES {
        let model = reference::triple(4096, rate, JERK);
        let mut textbook = Textbook::new(&model, 0.0);
        let expected: Vec<f64> = motion.counts[1..]
            .iter()
            .map(|count| {
                textbook.tick(0.0, *count as f64);
                textbook.x[1]
            })
            .collect();
        let ours = Model::triple_integrator(4096, Hertz(rate), JERK).unwrap();
        let filter: KalmanTriple = Kalman::new(&ours).unwrap();
        let outputs = run(&filter, &motion.samples(u32::MAX - 500));
        let difference = largest_difference(&outputs, &expected);
        assert!(difference < DEVIATION, "{rate} Hz: {difference}");
    }
}

/// Eq. 16 with all three states: eliminating the current loses nothing.
#[test]
fn motor_follows_the_textbook_of_three_states() {
    let motion = motion();
    for rate in RATES {
        for noise in [0.03, CURRENT_NOISE, 0.6] {
            let model = reference::motor(&MotorModel::DCX35L, rate, noise);
            // The current of a sample is that of the period before it: it is commanded at the
            // sample before, and enters the state there.
            let mut textbook = Textbook::new(&model, 0.0);
            textbook.x[2] = f64::from(motion.amps[1]);
            let mut expected = Vec::new();
            for tick in 1..motion.counts.len() {
                let commanded = motion.amps.get(tick + 1).copied().unwrap_or(0.0);
                textbook.tick(f64::from(commanded), motion.counts[tick] as f64);
                expected.push(textbook.x[1]);
                // The measured current is known, but for its own noise.
                assert!((textbook.x[2] - f64::from(commanded)).abs() < 1e-9);
            }
            let ours = Model::motor(&MotorModel::DCX35L, Hertz(rate), noise).unwrap();
            let filter: KalmanMotor = Kalman::new(&ours).unwrap();
            let outputs = run(&filter, &motion.samples(u32::MAX - 500));
            let difference = largest_difference(&outputs, &expected);
            assert!(difference < DEVIATION, "{rate} Hz, {noise} A: {difference}");

            // In rad/s, too.
            let scale = Scale::new(4096, Hertz(rate)).unwrap();
            let last = CountsPerTick(outputs[outputs.len() - 1] as f32).rad_per_s(&scale);
            let omega = expected[expected.len() - 1] * std::f64::consts::TAU * rate / 4096.0;
            let bound = DEVIATION * std::f64::consts::TAU * rate / 4096.0;
            assert!((f64::from(last) - omega).abs() < bound);
        }
    }
}

/// Eq. 15 shows the filter each current a tick later.
#[test]
fn late_current_is_the_textbook_of_eq_15() {
    let motion = motion();
    for rate in RATES {
        let model = reference::motor_reduced(&MotorModel::DCX35L, rate, CURRENT_NOISE);
        let mut textbook = Textbook::new(&model, 0.0);
        let mut expected = Vec::new();
        for tick in 1..motion.counts.len() {
            textbook.tick(f64::from(motion.amps[tick - 1]), motion.counts[tick] as f64);
            expected.push(textbook.x[1]);
        }
        let ours = Model::motor(&MotorModel::DCX35L, Hertz(rate), CURRENT_NOISE).unwrap();
        let late = LateCurrent(Kalman::new(&ours).unwrap());
        let difference = largest_difference(&run(&late, &motion.samples(0)), &expected);
        assert!(difference < DEVIATION, "{rate} Hz: {difference}");
    }
}

#[test]
fn steady_filters_follow_the_textbook_with_its_limit() {
    let motion = motion();
    for rate in RATES {
        let triple = reference::triple(4096, rate, JERK);
        let mut textbook = Textbook::new(&triple, 0.0);
        textbook.preset = Some(triple.steady_gain());
        let ours = Model::triple_integrator(4096, Hertz(rate), JERK).unwrap();
        let ours = SteadyKalman::new(&ours).unwrap();
        let mut state = ours.start(&Sample::new(Count(0)));

        let motor = reference::motor_reduced(&MotorModel::DCX35L, rate, CURRENT_NOISE);
        let mut motor_textbook = Textbook::new(&motor, 0.0);
        motor_textbook.preset = Some(motor.steady_gain());
        let motor = Model::motor(&MotorModel::DCX35L, Hertz(rate), CURRENT_NOISE).unwrap();
        let motor = SteadyKalman::new(&motor).unwrap();
        let mut motor_state = motor.start(&Sample::new(Count(0)));

        for (count, amps) in motion.counts.iter().zip(&motion.amps).skip(1) {
            let sample = Sample::new(Count(*count as u32)).with_current(Amps::new(*amps));
            textbook.tick(0.0, *count as f64);
            let v = f64::from(ours.update(&mut state, &sample).0);
            assert!((v - textbook.x[1]).abs() < DEVIATION, "{rate} Hz: {v}");
            motor_textbook.tick(f64::from(*amps), *count as f64);
            let v = f64::from(motor.update(&mut motor_state, &sample).0);
            assert!(
                (v - motor_textbook.x[1]).abs() < DEVIATION,
                "{rate} Hz: {v}"
            );
        }
    }
}

/// The covariance at run time is the textbook's, tick by tick.
#[test]
fn covariance_follows_the_textbook() {
    for rate in RATES {
        let model = reference::triple(4096, rate, JERK);
        let ours = Model::triple_integrator(4096, Hertz(rate), JERK).unwrap();
        let filter = Kalman::new(&ours).unwrap();
        let motor_model = reference::motor_reduced(&MotorModel::DCX35L, rate, CURRENT_NOISE);
        let motor = Model::motor(&MotorModel::DCX35L, Hertz(rate), CURRENT_NOISE).unwrap();
        let motor = Kalman::new(&motor).unwrap();
        let sample = Sample::new(Count(1));
        let mut state = filter.start(&sample);
        let mut motor_state = motor.start(&sample);
        let (mut p, mut motor_p) = (model.p0, motor_model.p0);
        for tick in 0..2000 {
            filter.update(&mut state, &sample);
            motor.update(&mut motor_state, &sample);
            p = model.predicted(&p);
            p = Reference::updated(&p, &Reference::gain(&p));
            motor_p = motor_model.predicted(&motor_p);
            motor_p = Reference::updated(&motor_p, &Reference::gain(&motor_p));
            assert_near(&filter.covariance(&state), &p, tick);
            assert_near(&motor.covariance(&motor_state), &motor_p, tick);
        }
    }
}

#[track_caller]
fn assert_near<const S: usize>(ours: &[[f32; S]; S], theirs: &Matrix<S>, tick: usize) {
    for i in 0..S {
        for j in 0..S {
            // Of the geometric mean of the variances: a covariance may pass through zero. The
            // first updates cancel 1024 against 1/12, four digits of the seven; once they are
            // forgotten, some tens of roundings are left.
            let size = (theirs[(i, i)] * theirs[(j, j)]).sqrt();
            let error = (f64::from(ours[i][j]) - theirs[(i, j)]).abs() / size;
            let tolerance = if tick < 300 { 2e-3 } else { 2e-5 };
            assert!(
                error < tolerance,
                "element {i} {j} after {tick}: {error}\n{ours:?}{theirs}"
            );
        }
    }
}
