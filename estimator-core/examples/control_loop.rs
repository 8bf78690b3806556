//! A velocity loop: encoder, observer, proportional-integral controller and motor, in one file.
//!
//! `cargo run --release --package estimator-core --example control_loop` prints the response to a
//! step of 10 rad/s. In firmware, the body of the loop is the control interrupt.

use estimator_core::{
    Amps, Count, CountObserver, CoupledMotor, Hertz, Observer, Sample, Scale, Uncertainty,
    VelocityEstimator, preset,
};

const RATE: Hertz = Hertz(1000.0);
const DEVICE: CoupledMotor = CoupledMotor::DCX35L;
const UNCERTAINTY: Uncertainty = Uncertainty {
    torque_noise: 5e-6,
    disturbance: 1e-4,
    disturbance_time: 0.1,
    friction_share: 0.7,
    boundary_noise: 0.0625,
};
const OBSERVER: CountObserver = preset!(Observer::new(&DEVICE, RATE, &UNCERTAINTY));
const SCALE: Scale = preset!(Scale::new(DEVICE.motor.counts_per_rev, RATE));

/// The motor: angle, rad, and velocity, rad/s, integrated in steps of 10 µs.
fn turn([angle, omega]: &mut [f64; 2], amps: f64) {
    for _ in 0..100 {
        let torque = DEVICE.motor.torque_constant * amps - DEVICE.motor.damping * *omega;
        let friction = DEVICE.coulomb_friction * (*omega / 0.01).clamp(-1.0, 1.0);
        *omega += (torque - friction) / DEVICE.motor.inertia * 1e-5;
        *angle += *omega * 1e-5;
    }
}

fn main() {
    let (target, proportional, integral) = (10.0, 0.05, 1.5); // rad/s, A s/rad, A/rad
    let mut motor = [0.0, 0.0];
    let mut state = OBSERVER.start(&Sample::new(Count(0)));
    let (mut amps, mut sum) = (Amps::ZERO, 0.0);
    println!("time, ms   velocity, rad/s   estimate, rad/s   current, A");
    for tick in 1..=200 {
        turn(&mut motor, f64::from(amps.get()));
        let counts = motor[0] / std::f64::consts::TAU * f64::from(DEVICE.motor.counts_per_rev);
        let sample = Sample::new(Count(counts as i64 as u32)).with_current(amps);
        let estimate = OBSERVER.update(&mut state, &sample).rad_per_s(&SCALE);
        let error = target - estimate;
        sum += integral * error * RATE.period_s() as f32;
        amps = Amps::new(proportional * error + sum);
        if tick % 20 == 0 {
            println!(
                "{tick:>8} {:>17.2} {estimate:>17.2} {:>12.3}",
                motor[1],
                amps.get()
            );
        }
    }
    assert!(
        (motor[1] - f64::from(target)).abs() < 0.2,
        "the loop misses its target: {motor:?}"
    );
}

#[test]
fn loop_reaches_its_target() {
    main();
}
