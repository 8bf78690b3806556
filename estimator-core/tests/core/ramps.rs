//! Constant velocity and rest: what every estimator converges to.

use std::sync::LazyLock;

use estimator_core::{Amps, Count, Hertz, Kalman, Model, Sample, VelocityEstimator};

use crate::every::{self, Case, JERK, RATES, Ramp, at, everywhere};
use crate::reference;

static EVERY: LazyLock<Vec<Case>> = LazyLock::new(everywhere);

/// A ramp of `velocity` with the current that a motor needs to hold it.
fn held_ramp(case: &Case, velocity: f64, ticks: usize) -> Vec<Sample> {
    let amps = Amps::new((velocity * case.holding_amps) as f32);
    let count = |tick: usize| Count((velocity * tick as f64).floor() as i64 as u32);
    (0..ticks)
        .map(|tick| Sample::new(count(tick)).with_current(amps))
        .collect()
}

#[test]
fn ramp_is_followed() {
    for case in EVERY.iter() {
        for velocity in [
            1, -1, 7, 46, -47, 211, 6001, 6002, -9973, 20_011, 32_767, -32_767,
        ] {
            let samples = held_ramp(case, f64::from(velocity), case.memory + 300);
            if f64::from(samples[0].current.get()).abs() >= f64::from(Amps::MAX) {
                continue;
            }
            let outputs = case.run(&samples);
            for output in &outputs[case.memory..] {
                match case.ramp {
                    Ramp::Exact => assert_eq!(*output, velocity as f32, "{}", case.name),
                    Ramp::Rounded => {
                        // A filter of time constant τ stalls where its step, error / τ, rounds
                        // to nothing: at τ half units in the last place.
                        let stall = case.memory as f64 * f64::from(f32::EPSILON);
                        let error = (f64::from(*output) / f64::from(velocity) - 1.0).abs();
                        assert!(
                            error <= 2e-6 + stall,
                            "{}: {output} for {velocity}",
                            case.name
                        );
                    }
                }
            }
        }
    }
}

#[test]
fn velocity_returns_to_zero_at_rest() {
    for case in EVERY.iter() {
        let mut samples = held_ramp(case, 211.0, 400);
        let rest = samples[399].with_current(Amps::ZERO);
        samples.resize(400 + 2 * case.memory + 4, rest);
        let outputs = case.run(&samples);
        // Within its memory all but a millionth of the velocity is gone, within twice that all
        // but a millionth of a count; without a low-pass there is nothing at all.
        for (ticks, bound) in [(case.memory + 1, 211e-6), (2 * case.memory + 2, 1e-6)] {
            let bound = if case.ramp == Ramp::Exact { 0.0 } else { bound };
            for output in &outputs[399 + ticks..] {
                assert!(
                    f64::from(output.abs()) <= bound * case.per_count,
                    "{}: {output} {ticks} ticks after the stop",
                    case.name
                );
            }
        }
    }
}

#[test]
fn slow_motion_has_the_correct_mean_velocity() {
    for case in EVERY.iter() {
        for direction in [1.0, -1.0] {
            let slow = direction / 50.0;
            let periods = 50 * (case.memory / 50 + 2);
            let samples = held_ramp(case, slow, periods + 2000 + 1);
            let outputs = case.run(&samples);
            let mean = outputs[periods..]
                .iter()
                .copied()
                .map(f64::from)
                .sum::<f64>()
                / 2000.0;
            // A linear filter and the end-fit take every count in full. A best-fit weighs its
            // window's middle more, and where an edge lies decides how long its windows are.
            let tolerance = if case.name.contains("best-fit") {
                0.15
            } else {
                1e-3
            };
            assert!(
                (mean / slow - 1.0).abs() < tolerance,
                "{}: mean {mean} for {slow}",
                case.name
            );
        }
    }
}

/// The bound of a Kalman filter is reached by the worst input: it is no larger than it must be.
#[test]
fn bound_is_tight() {
    for rate in RATES {
        let model = reference::triple(4096, rate, JERK);
        let filter =
            Kalman::new(&Model::triple_integrator(4096, Hertz(rate), JERK).unwrap()).unwrap();
        let cases = at(rate);
        let case = cases
            .iter()
            .find(|case| case.name.starts_with("Kalman triple"))
            .unwrap();
        let steps = every::worst_steps(&model, &model.gains(case.memory), 1000);
        let mut count = Count(0);
        let mut state = filter.start(&Sample::new(count));
        let mut output = 0.0;
        for step in steps {
            count = count + estimator_core::Counts(step as i32);
            output = filter.update(&mut state, &Sample::new(count)).0;
        }
        let bound = 1000.0 * case.per_count;
        let reached = f64::from(output);
        assert!(
            reached <= bound * 1.0001 && reached >= bound * 0.5,
            "{reached} of {bound}"
        );
    }
}
