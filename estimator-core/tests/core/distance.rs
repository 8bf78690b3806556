//! Long distances: positions beyond the exact range of f32, and long ramps.

use std::sync::LazyLock;

use estimator_core::{
    Count, Counts, EndFit, FiniteDifference, Foaw, Hertz, Kalman, LowPass, Model, Pll, Sample,
    SteadyKalman, VelocityEstimator,
};

use crate::every::{Case, JERK, Ramp, everywhere};
use crate::motion::medley;

static EVERY: LazyLock<Vec<Case>> = LazyLock::new(everywhere);

/// After a displacement of a billion counts an estimator has the output of one that starts there.
#[test]
fn velocity_is_exact_beyond_a_billion_counts() {
    let motion = medley();
    for case in EVERY.iter() {
        // Motion at high speed, then rest until its effect on the state has decayed.
        let mut run = case.make();
        let mut count = Count(0);
        run.start(&Sample::new(count));
        for _ in 0..50_000 {
            count = count + Counts(20_000);
            run.update(&Sample::new(count));
        }
        for _ in 0..3 * case.memory + 3 {
            run.update(&Sample::new(count));
        }
        assert_eq!(count, Count(1_000_000_000));
        let arrived: Vec<f32> = {
            let samples = motion.samples(count.0);
            samples[1..]
                .iter()
                .map(|sample| run.update(sample))
                .collect()
        };
        // The other estimator also gets time to settle, because its covariance starts wide.
        let mut fresh = case.make();
        fresh.start(&Sample::new(Count(7)));
        for _ in 0..case.memory + 3 {
            fresh.update(&Sample::new(Count(7)));
        }
        let started = motion.samples(7)[1..]
            .iter()
            .map(|sample| fresh.update(sample))
            .collect::<Vec<f32>>();
        for (there, here) in arrived.iter().zip(&started) {
            // The states of both filters differ in their last digits when the motion begins.
            let rounding = 1e-6 * motion.fastest() as f32;
            let tolerance = if case.ramp == Ramp::Exact {
                0.0
            } else {
                rounding
            };
            assert!(
                (there - here).abs() <= tolerance,
                "{}: {there} against {here}",
                case.name
            );
        }
    }
}

/// Over 2e7 ticks and 7e9 counts the error of the last million ticks is that of the first.
#[test]
fn long_ramps_do_not_drift() {
    let rate = Hertz(10_000.0);
    let triple = Model::triple_integrator(4096, rate, JERK).unwrap();
    let window = Foaw::<15, EndFit>::new(15, 1).unwrap();
    let kalman = Kalman::new(&triple).unwrap();
    let steady = SteadyKalman::new(&triple).unwrap();
    let pll = Pll::new(Hertz(60.0), rate).unwrap();
    let low_pass = LowPass::new(FiniteDifference, Hertz(60.0), rate).unwrap();
    std::thread::scope(|scope| {
        scope.spawn(|| assert_no_drift(&kalman, 4_000_000));
        scope.spawn(|| assert_no_drift(&steady, 20_000_000));
        scope.spawn(|| assert_no_drift(&pll, 20_000_000));
        scope.spawn(|| assert_no_drift(&low_pass, 20_000_000));
        scope.spawn(|| assert_no_drift(&window, 2_000_000));
    });
}

fn assert_no_drift<E: VelocityEstimator>(estimator: &E, ticks: u64) {
    // 353 and 0.618 034 counts a tick, exactly, in units of 2^-32 counts.
    const STEP: u64 = (353 << 32) + 2_654_435_769;
    let truth = STEP as f64 / 4_294_967_296.0;
    let mut position = 0u64;
    let mut count = Count(0);
    let mut state = estimator.start(&Sample::new(count));
    let span = ticks / 10;
    let (mut first, mut last) = (0.0f64, 0.0f64);
    let mut travelled = 0.0;
    for tick in 0..ticks {
        position = position.wrapping_add(STEP);
        let shown = Count((position >> 32) as u32);
        let counted = f64::from((shown - count).0);
        count = shown;
        let output = f64::from(estimator.update(&mut state, &Sample::new(count)).0);
        let error = (output - truth).abs();
        if tick >= span {
            // The integral of the estimate stays equal to the counts.
            travelled += output - counted;
        }
        if (span..2 * span).contains(&tick) {
            first = first.max(error);
        } else if tick >= ticks - span {
            last = last.max(error);
        }
    }
    let name = std::any::type_name::<E>();
    assert!(first < 1.0, "{name}: off by {first}");
    assert!(last <= first * 1.01 + 1e-4, "{name}: {last} after {first}");
    // A few roundings of the velocity per tick, 2^-24 of it each; none of them grows.
    let drift = travelled.abs() / (ticks - span) as f64;
    assert!(
        drift < 4e-7 * truth,
        "{name}: drifts by {drift} counts a tick"
    );
}
