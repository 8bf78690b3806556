//! Velocity from encoder and motor current: a filter of counts alone against filters of a motor.
//!
//! A motor with friction follows a square wave of current, ±0.4 A at 2 Hz. Its encoder has 4096
//! counts per revolution and is sampled at 1 kHz; the coupled shaft is held. Here a model without
//! friction is worse than a filter of counts. A model with friction needs the right damping, or an
//! adaptation that finds it.
//!
//! `cargo run --release --package estimator-core --example encoder_and_current` prints the RMS error
//! of every estimator.

use estimator_core::{
    Amps, Count, CoupledMotor, DesignError, Hertz, Kalman, Model, ObserverDesign, Sample, Scale,
    Uncertainty, VelocityEstimator,
};

const RATE: Hertz = Hertz(1000.0);
const DEVICE: CoupledMotor = CoupledMotor {
    amplifier_lag: 0.0,
    ..CoupledMotor::DCX35L
};
const UNCERTAINTY: Uncertainty = Uncertainty {
    torque_noise: 5e-6,
    disturbance: 1e-4,
    disturbance_time: 0.1,
    friction_share: 0.7,
    boundary_noise: 0.0625,
};
const TICKS: u32 = 4000;

/// Samples of the motor and its true velocity, rad/s, at each tick.
fn simulated() -> Vec<(Sample, f64)> {
    let (motor, per_rad) = (
        DEVICE.motor,
        f64::from(DEVICE.motor.counts_per_rev) / std::f64::consts::TAU,
    );
    let steps = 100;
    let dt = RATE.period_s() / f64::from(steps);
    let (mut angle, mut omega, mut amps) = (1.0f64, 0.0f64, 0.0);
    let mut samples = Vec::new();
    for tick in 0..=TICKS {
        let count = Count((angle * per_rad) as i64 as u32);
        samples.push((
            Sample::new(count).with_current(Amps::new(amps as f32)),
            omega,
        ));
        amps = if tick / 250 % 2 == 0 { 0.4 } else { -0.4 };
        for _ in 0..steps {
            let torque = motor.torque_constant * amps - motor.damping * omega;
            let friction = if omega == 0.0 { torque } else { omega };
            omega += (torque - DEVICE.coulomb_friction.copysign(friction)) / motor.inertia * dt;
            angle += omega * dt;
        }
    }
    samples
}

/// RMS error of an estimator, rad/s, over the second half of the samples.
fn rms_error<E>(estimator: &E, samples: &[(Sample, f64)]) -> f64
where
    E: VelocityEstimator,
{
    let scale = Scale::new(DEVICE.motor.counts_per_rev, RATE).expect("valid parameters");
    let mut state = estimator.start(&samples[0].0);
    let mut squares = Vec::new();
    for (sample, truth) in &samples[1..] {
        let estimate = estimator.update(&mut state, sample).rad_per_s(&scale);
        squares.push((f64::from(estimate) - truth).powi(2));
    }
    let half = &squares[squares.len() / 2..];
    (half.iter().sum::<f64>() / half.len() as f64).sqrt()
}

fn main() -> Result<(), DesignError> {
    let samples = simulated();
    let counts = DEVICE.motor.counts_per_rev;
    let triple = Kalman::new(&Model::triple_integrator(counts, RATE, 1e4)?)?;
    let motor = Kalman::new(&Model::motor(&DEVICE.motor, RATE, 0.1)?)?;
    let observer = ObserverDesign::new(&DEVICE, RATE, &UNCERTAINTY)
        .held()
        .build()?;
    let mut nominal = DEVICE;
    nominal.motor.damping *= 1.3;
    let wrong = ObserverDesign::new(&nominal, RATE, &UNCERTAINTY).held();
    let adaptive = wrong.adaptive().build()?;
    let wrong = wrong.build()?;

    println!("estimator                              RMS error, rad/s");
    let mut errors = Vec::new();
    for (name, error) in [
        ("Kalman, triple integrator", rms_error(&triple, &samples)),
        (
            "Kalman, motor without friction",
            rms_error(&motor, &samples),
        ),
        (
            "observer, motor with friction",
            rms_error(&observer, &samples),
        ),
        (
            "observer, damping 30 % too large",
            rms_error(&wrong, &samples),
        ),
        (
            "adaptive, damping 30 % too large",
            rms_error(&adaptive, &samples),
        ),
    ] {
        println!("{name:<38} {error:.3}");
        errors.push(error);
    }
    let [triple, _, observer, wrong, adaptive] = errors[..] else {
        unreachable!("five estimators");
    };
    assert!(
        observer < 0.1 * triple,
        "current and friction are of no use"
    );
    assert!(adaptive < 0.1 * wrong, "the damping is not adapted");
    Ok(())
}

#[test]
fn observer_is_best_and_adaptation_finds_the_damping() -> Result<(), DesignError> {
    main()
}
