//! Velocity from an encoder alone: five estimators on the same counts.
//!
//! A shaft with 4096 counts per revolution turns at 3 rad/s with a superposed oscillation of 2 rad/s
//! at 1 Hz, sampled at 1 kHz. `cargo run --release --package estimator-core --example encoder_only`
//! prints the RMS error of every estimator.

use std::f64::consts::TAU;

use estimator_core::{
    Count, EndFit, FiniteDifference, Foaw, Hertz, Kalman, LowPass, Model, Pll, Sample, Scale,
    VelocityEstimator, preset,
};

const COUNTS_PER_REV: u32 = 4096;
const RATE: Hertz = Hertz(1000.0);
const SCALE: Scale = preset!(Scale::new(COUNTS_PER_REV, RATE));
const TICKS: u32 = 5000;

/// True angle, rad, and velocity, rad/s, at time `t`, s.
fn motion(t: f64) -> (f64, f64) {
    let phase = TAU * t;
    (
        3.0 * t + 2.0 / TAU * (1.0 - phase.cos()),
        3.0 + 2.0 * phase.sin(),
    )
}

/// RMS error of an estimator, rad/s, without the first tenth of the motion.
fn rms_error<E: VelocityEstimator>(estimator: &E) -> f64 {
    let sample = |tick: u32| {
        let (angle, _) = motion(f64::from(tick) * RATE.period_s());
        Sample::new(Count((angle / TAU * f64::from(COUNTS_PER_REV)) as u32))
    };
    let mut state = estimator.start(&sample(0));
    let mut squares = 0.0;
    for tick in 1..=TICKS {
        let estimate = estimator
            .update(&mut state, &sample(tick))
            .rad_per_s(&SCALE);
        let (_, truth) = motion(f64::from(tick) * RATE.period_s());
        if tick > TICKS / 10 {
            squares += (f64::from(estimate) - truth).powi(2);
        }
    }
    (squares / f64::from(TICKS - TICKS / 10)).sqrt()
}

fn main() {
    const LOW_PASS: LowPass<FiniteDifference> =
        preset!(LowPass::new(FiniteDifference, Hertz(30.0), RATE));
    const FOAW: Foaw<32, EndFit> = preset!(Foaw::new(32, 1));
    const PLL: Pll = preset!(Pll::new(Hertz(20.0), RATE));
    let model = Model::triple_integrator(COUNTS_PER_REV, RATE, 100.0).expect("valid parameters");
    let kalman = Kalman::new(&model).expect("valid parameters");

    let reference = rms_error(&FiniteDifference);
    println!("estimator            RMS error, rad/s");
    println!("finite difference    {reference:.3}");
    for (name, error) in [
        ("low-pass, 30 Hz", rms_error(&LOW_PASS)),
        ("FOAW, n = 32", rms_error(&FOAW)),
        ("PLL, 20 Hz", rms_error(&PLL)),
        ("Kalman, triple", rms_error(&kalman)),
    ] {
        println!("{name:<20} {error:.3}");
        assert!(error < 0.5 * reference, "{name} does not filter");
    }
}

#[test]
fn every_estimator_halves_the_error() {
    main();
}
