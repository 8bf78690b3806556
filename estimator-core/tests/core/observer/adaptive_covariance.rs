//! The covariance of the adapted parameters, through regular and absurd samples.

use estimator_core::{
    Adaptive, AmplifierCurrent, Amps, ClockTicks, Correction, Count, Counts, CoupledMotor, Edge,
    Hertz, MotorModel, Observer, ObserverDesign, Range, Sample, SlipSource, Uncertainty,
    VelocityEstimator,
};

use super::modelled::modelled;
use super::{CLOCK, UNSURE};
use crate::motion::Draws;

/// Asserts that the state of an adaptive observer is valid after any samples.
#[track_caller]
fn assert_sound<S: SlipSource, M: Correction, R: Range>(
    estimator: &Observer<AmplifierCurrent, S, M, Adaptive<R>>,
    samples: impl Iterator<Item = Sample>,
    what: &str,
) {
    let mut state = estimator.start(&Sample::default());
    for (tick, sample) in samples.enumerate() {
        let velocity = estimator.update(&mut state, &sample).0;
        assert!(velocity.is_finite(), "{what}: {velocity} at {tick}");
        let diagonal = state.adaptation().diagonal();
        assert!(
            (0..3).all(|i| diagonal[i] > 0.0 && diagonal[i] <= R::PRIOR[i] * R::PRIOR[i]),
            "{what}: {diagonal:?} at {tick}"
        );
        let upper = state.adaptation().upper();
        assert!(
            upper.iter().all(|u| u.abs() <= 1e3),
            "{what}: {upper:?} at {tick}"
        );
    }
}

/// A tick of 6 to 8 time constants of the motor, and counts that are noise: a damping that is
/// learned to be 60 % larger must not make the velocity grow from tick to tick.
#[test]
fn covariance_is_sound_at_ticks_of_many_time_constants() {
    for rate in [10.5, 10.8, 11.0, 11.4, 11.7, 12.3, 13.1, 13.8] {
        for counts_per_rev in [1, 24, 477, 2784, 22_385] {
            for torque_noise in [1.2e-7, 1.32e-5, 5.77e-4, 0.17] {
                let device = CoupledMotor {
                    motor: MotorModel {
                        counts_per_rev,
                        ..MotorModel::DCX35L
                    },
                    ..CoupledMotor::DCX35L
                };
                let unsure = Uncertainty {
                    torque_noise,
                    disturbance: 10.0 * torque_noise,
                    boundary_noise: 0.0625,
                    ..UNSURE
                };
                let rate = Hertz(rate);
                let what = format!("{rate:?}, {counts_per_rev} counts, {torque_noise:e}");
                let design = ObserverDesign::new(&device, rate, &unsure);
                let counts = design.adaptive();
                let edges = counts.with_edges(CLOCK).build().expect("valid");
                let counts = counts.build().expect("valid");
                let wide = design.held().widely_adaptive();
                let wide_edges = wide.with_edges(CLOCK).build().expect("valid");
                let wide = wide.build().expect("valid");
                let noise = || {
                    let mut draws = Draws(u64::from(counts_per_rev));
                    (0..300).map(move |_| {
                        let count = Count(draws.bits() as u32);
                        let edge = Edge {
                            boundary: Count(count.0.wrapping_add(draws.bits() as u32 & 1)),
                            age: ClockTicks((draws.bits() % 84_000) as u32),
                        };
                        Sample::new(count)
                            .with_coupled(Count(draws.bits() as u32))
                            .with_edge(edge)
                    })
                };
                assert_sound(&counts, noise(), &what);
                assert_sound(&edges, noise(), &what);
                assert_sound(&wide, noise(), &what);
                assert_sound(&wide_edges, noise(), &what);
            }
        }
    }
}

/// The same edge is shown as new over and over: what an innovation says of the parameters then
/// grows with every tick, beyond what f32 can hold.
#[test]
fn covariance_is_sound_with_edges_that_contradict_the_counts() {
    let device = CoupledMotor {
        motor: MotorModel {
            counts_per_rev: 3,
            inertia: 1.8e-5,
            damping: 1.7e-5,
            torque_constant: 0.0128,
        },
        coulomb_friction: 40.0,
        amplifier_lag: 0.62e-3,
        coupled_counts_per_rev: 40_000_000,
    };
    let unsure = Uncertainty {
        torque_noise: 6700.0,
        disturbance: 4.7e5,
        disturbance_time: 1.8,
        friction_share: 0.35,
        boundary_noise: 430.0,
    };
    let rate = Hertz(34.3);
    let edges = ObserverDesign::new(&device, rate, &unsure).with_edges(CLOCK);
    let wide = edges.held().widely_adaptive().build().expect("valid");
    let edges = edges.adaptive().build().expect("valid");
    let mut draws = Draws(3);
    let mut jumps = 0;
    let samples: Vec<Sample> = (0..3000u32)
        .map(|tick| {
            // Jumps build up an unknown torque that overcomes the friction.
            if tick < 300 {
                jumps += draws.within(100_000);
            }
            let count = Count(jumps as u32) + Counts(tick as i32 / 29);
            Sample::new(count)
                .with_coupled(Count(draws.bits() as u32 % 100))
                .with_current(Amps::new(6.0 * draws.unit() as f32))
                .with_edge(Edge {
                    boundary: count,
                    age: ClockTicks(50_000 + tick % 29 * 84_000),
                })
        })
        .collect();
    assert_sound(&edges, samples.iter().copied(), "contradicting edges");
    assert_sound(&wide, samples.iter().copied(), "contradicting edges, wide");
}

/// The covariance of the parameters stays positive definite through irregular, absurd updates:
/// counts that jump, with edges at any instant, or none.
#[test]
fn covariance_of_the_parameters_stays_positive() {
    let rate = Hertz(1000.0);
    let counts = ObserverDesign::new(&CoupledMotor::DCX35L, rate, &UNSURE).adaptive();
    let edges = counts.with_edges(CLOCK).build().expect("valid");
    let counts = counts.build().expect("valid");
    let mut draws = Draws(11);
    let (mut state, mut stamped) = (
        counts.start(&Sample::default()),
        edges.start(&Sample::default()),
    );
    let mut count = 0u32;
    for tick in 0..1_000_000 {
        let jump = if tick % 977 == 0 { 1 << 20 } else { 30 };
        count = count.wrapping_add(draws.within(jump) as u32);
        let mut sample = Sample::new(Count(count))
            .with_coupled(Count(draws.bits() as u32 >> (tick % 32)))
            .with_current(Amps::new(1000.0 * draws.unit() as f32));
        if tick % 5 != 0 {
            sample = sample.with_edge(Edge {
                boundary: Count(count.wrapping_add(draws.bits() as u32 & 1)),
                age: ClockTicks((draws.bits() % 84_000) as u32),
            });
        }
        counts.update(&mut state, &sample);
        edges.update(&mut stamped, &sample);
        for diagonal in [
            state.adaptation().diagonal(),
            stamped.adaptation().diagonal(),
        ] {
            assert!(
                diagonal.iter().all(|d| *d > 0.0 && *d < 1.0),
                "{diagonal:?} at {tick}"
            );
        }
    }
    // Both have learned: D has left the prior.
    for diagonal in [
        state.adaptation().diagonal(),
        stamped.adaptation().diagonal(),
    ] {
        assert!(diagonal.iter().any(|d| *d < 0.05), "{diagonal:?}");
    }
}

/// After a long rest the covariance is not larger than at the start, and one count does not throw
/// the parameters to their ends.
#[test]
fn variances_of_the_parameters_at_rest_stay_below_the_prior() {
    // At 100 Hz 1e5 ticks are 1000 s; the walk of a tenth of the prior in √s would make 3 of it.
    let rate = Hertz(100.0);
    let prior = [0.35f32, 0.6, 0.35].map(|deviation| deviation * deviation);
    let counts = ObserverDesign::new(&CoupledMotor::DCX35L, rate, &UNSURE).adaptive();
    let counts = counts.build().expect("valid");
    let mut state = counts.start(&Sample::default());
    assert_eq!(*state.adaptation().diagonal(), prior);
    // 0.3 A over 0.4 s: the assumed parameters are nearly right.
    let (samples, _) = modelled(rate.0, 3.0, 0.3, CoupledMotor::DCX35L);
    for sample in &samples {
        counts.update(&mut state, sample);
    }
    let before = counts.parameter_errors(&state);
    let adapted = *state.adaptation().diagonal();
    assert!((0..3).all(|i| adapted[i] < prior[i]), "{adapted:?}");
    let rest = samples[samples.len() - 1].with_current(Amps::ZERO);
    for _ in 0..100_000 {
        counts.update(&mut state, &rest);
    }
    let mut moved = rest;
    for _ in 0..20 {
        moved.count = moved.count + Counts(9);
        counts.update(&mut state, &moved.with_current(Amps::new(0.2)));
        let diagonal = state.adaptation().diagonal();
        assert!(
            (0..3).all(|i| diagonal[i] <= prior[i]),
            "{diagonal:?} above {prior:?}"
        );
    }
    assert_ne!(*state.adaptation().diagonal(), adapted);
    let after = counts.parameter_errors(&state);
    assert!((after.damping - before.damping).abs() < 0.3, "{after:?}");
}

/// The variances grow with the time since the last update, rest included: by (0.1)² of those at the start in a
/// second, at the first innovation that is used again.
#[test]
fn variances_grow_by_the_time_since_the_last_update_at_rest_too() {
    let rate = Hertz(100.0);
    let prior = [0.35, 0.6, 0.35].map(|deviation: f64| deviation * deviation);
    let counts = ObserverDesign::new(&CoupledMotor::DCX35L, rate, &UNSURE).adaptive();
    let counts = counts.build().expect("valid");
    let (samples, _) = modelled(rate.0, 3.0, 0.3, CoupledMotor::DCX35L);
    // The variances after the first update that follows this many seconds of rest.
    let after = |seconds: f64| {
        let mut state = counts.start(&Sample::default());
        for sample in &samples {
            counts.update(&mut state, sample);
        }
        let rest = samples[samples.len() - 1].with_current(Amps::ZERO);
        for _ in 0..(seconds * rate.0) as u32 {
            counts.update(&mut state, &rest);
        }
        let before = *state.adaptation().diagonal();
        let mut moved = rest;
        while *state.adaptation().diagonal() == before {
            moved.count = moved.count + Counts(9);
            counts.update(&mut state, &moved.with_current(Amps::new(0.2)));
        }
        state.adaptation().diagonal().map(f64::from)
    };
    let (soon, late) = (after(1.0), after(11.0));
    for i in 0..3 {
        let grown = (late[i] - soon[i]) / prior[i];
        assert!((grown - 0.1).abs() < 0.02, "{i}: {grown}");
    }
}
