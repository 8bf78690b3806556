//! What the observers learn, and what they must not.

use estimator_core::{
    AmplifierCurrent, Amps, ClockTicks, Correction, Count, Counts, CoupledMotor, Device, Edge,
    Hertz, Learned, Observer, Sample, SmallEncoder, Uncertainty, VelocityEstimator,
};

use super::modelled::{modelled, rms};
use super::{CLOCK, UNSURE, at};
use crate::motion::Draws;

/// A device whose damping, friction and torque constant are each off is learned: b, from Kt.
#[test]
fn what_is_off_is_learned() {
    let rate = Hertz(1000.0);
    let believed = CoupledMotor::DCX35L;
    for (damping, inertia, friction) in [(0.7, 1.0, 1.0), (1.3, 1.2, 0.7), (0.8, 0.8, 1.4)] {
        let mut device = believed;
        device.large.damping *= damping;
        device.large.inertia *= inertia;
        device.coulomb_friction *= friction;
        let (samples, truth) = modelled(rate.0, 12.0, 0.3, device);
        let counts = Observer::new(&believed, rate, &UNSURE).expect("valid");
        let edges = counts.with_edges(CLOCK, rate).expect("valid");
        let fixed = at(rate.0);
        let fixed = fixed
            .iter()
            .find(|case| case.name.starts_with("observer, edges at"));
        let fixed = rms(&(fixed.expect("there").run)(&samples), &truth, 6000);

        let estimator = edges.learning(4096, rate).expect("valid");
        let mut state = estimator.start(&samples[0]);
        let mut velocities = Vec::new();
        for sample in &samples[1..] {
            velocities.push(estimator.update(&mut state, sample).0);
        }
        let learned = f64::from(estimator.deviations(&state).damping_ratio());
        assert!(
            (learned / damping - 1.0).abs() < 0.05,
            "{learned} for {damping}"
        );
        let error = rms(&velocities, &truth, 6000);
        assert!(error < 0.5 * fixed, "{error} of {fixed}");
    }
}

/// Who starts in motion has the velocity to find, not parameters: those believed in are right.
#[test]
fn a_start_in_motion_teaches_nothing() {
    let rate = Hertz(10_000.0);
    // Small gains, as one that learns is tuned to.
    let sure = Uncertainty {
        torque_noise: 5.75e-6,
        load: 1.38e-4,
        boundary_noise: 0.0625,
        ..UNSURE
    };
    let counts = Observer::new(&CoupledMotor::DCX35L, rate, &sure).expect("valid");
    started_in_motion(&counts.learning(4096, rate).expect("valid"), rate, 0.003);
    let soft = Observer::soft(&CoupledMotor::DCX35L, rate, &sure).expect("valid");
    // At a count in every tick counts say least of all.
    started_in_motion(&soft.learning(4096, rate).expect("valid"), rate, 0.0045);
}

fn started_in_motion<M: Correction>(
    estimator: &Observer<AmplifierCurrent, SmallEncoder, M, Learned>,
    rate: Hertz,
    bound: f64,
) {
    let (samples, truth) = modelled(rate.0, 4.0, 0.4, CoupledMotor::DCX35L);
    // 0.3 counts a tick are 4.6 rad/s.
    let fast = (0..samples.len() - 2500).filter(|k| truth[*k].abs() > 0.3);
    let starts: Vec<usize> = fast.step_by(500).collect();
    assert!(starts.len() > 20, "{starts:?}");
    for start in starts {
        let samples = &samples[start..start + 2500];
        let mut state = estimator.start(&samples[0]);
        let mut velocities = Vec::new();
        for sample in &samples[1..] {
            velocities.push(estimator.update(&mut state, sample).0);
        }
        let error = rms(&velocities, &truth[start..start + 2500], 200);
        assert!(error < bound, "{error} from tick {start}");
        let learned = estimator.deviations(&state);
        let learned = [learned.damping, learned.friction, learned.torque_constant];
        assert!(
            learned.iter().all(|deviation| deviation.abs() < 0.05),
            "{learned:?} from tick {start}"
        );
    }
}

/// In creep friction hides the rest: a current just above it, and fewer counts than it should
/// give, teach nothing.
#[test]
fn nothing_is_learned_in_creep() {
    let rate = Hertz(1000.0);
    let counts = Observer::new(&CoupledMotor::DCX35L, rate, &UNSURE).expect("valid");
    let estimator = counts.learning(4096, rate).expect("valid");
    let mut state = estimator.start(&Sample::new(Count(7)));
    let fresh = estimator.deviations(&state);
    let mut fastest = 0.0f32;
    for tick in 0..10_000u32 {
        // 4.2 of 4.0 mN.m: 0.22 rad/s, 0.14 counts a tick.
        let sample = Sample::new(Count(7 + tick / 20)).with_current(Amps::new(0.09));
        fastest = fastest.max(estimator.update(&mut state, &sample).0);
    }
    assert!(fastest > 0.02, "{fastest}");
    assert_eq!(estimator.deviations(&state), fresh);
}

/// What must hold of the state of an estimator that learns, whatever the samples.
#[track_caller]
fn assert_sound<M: Correction>(
    estimator: &Observer<AmplifierCurrent, SmallEncoder, M, Learned>,
    samples: impl Iterator<Item = Sample>,
    what: &str,
) {
    let mut state = estimator.start(&Sample::default());
    for (tick, sample) in samples.enumerate() {
        let velocity = estimator.update(&mut state, &sample).0;
        assert!(velocity.is_finite(), "{what}: {velocity} at {tick}");
        let diagonal = state.learning().diagonal();
        assert!(
            diagonal.iter().all(|d| *d > 0.0 && *d <= 0.36),
            "{what}: {diagonal:?} at {tick}"
        );
        let upper = state.learning().upper();
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
                    large: Device {
                        counts_per_rev,
                        ..Device::DCX35L
                    },
                    ..CoupledMotor::DCX35L
                };
                let unsure = Uncertainty {
                    torque_noise,
                    load: 10.0 * torque_noise,
                    boundary_noise: 0.0625,
                    ..UNSURE
                };
                let rate = Hertz(rate);
                let what = format!("{rate:?}, {counts_per_rev} counts, {torque_noise:e}");
                let counts = Observer::new(&device, rate, &unsure).expect("valid");
                let counts = counts.learning(counts_per_rev, rate).expect("valid");
                let edges = counts.with_edges(CLOCK, rate).expect("valid");
                let noise = || {
                    let mut draws = Draws(u64::from(counts_per_rev));
                    (0..300).map(move |_| {
                        let large = Count(draws.bits() as u32);
                        let edge = Edge {
                            boundary: Count(large.0.wrapping_add(draws.bits() as u32 & 1)),
                            age: ClockTicks((draws.bits() % 84_000) as u32),
                        };
                        Sample::new(large)
                            .with_small(Count(draws.bits() as u32))
                            .with_edge(edge)
                    })
                };
                assert_sound(&counts, noise(), &what);
                assert_sound(&edges, noise(), &what);
            }
        }
    }
}

/// The same edge is shown as new over and over: what an innovation says of the parameters then
/// grows with every tick, beyond what f32 can hold.
#[test]
fn covariance_is_sound_with_edges_that_contradict_the_counts() {
    let device = CoupledMotor {
        large: Device {
            counts_per_rev: 3,
            inertia: 1.8e-5,
            damping: 1.7e-5,
            torque_constant: 0.0128,
        },
        coulomb_friction: 40.0,
        amplifier_lag: 0.62e-3,
        small_counts_per_rev: 40_000_000,
    };
    let unsure = Uncertainty {
        torque_noise: 6700.0,
        load: 4.7e5,
        load_time: 1.8,
        friction_share: 0.35,
        boundary_noise: 430.0,
    };
    let rate = Hertz(34.3);
    let counts = Observer::new(&device, rate, &unsure).expect("valid");
    let edges = counts.with_edges(CLOCK, rate).expect("valid");
    let edges = edges.learning(3, rate).expect("valid");
    let mut draws = Draws(3);
    let mut jumps = 0;
    let samples = (0..3000u32).map(|tick| {
        // Jumps build up an unknown torque that overcomes the friction.
        if tick < 300 {
            jumps += draws.within(100_000);
        }
        let large = Count(jumps as u32) + Counts(tick as i32 / 29);
        Sample::new(large)
            .with_small(Count(draws.bits() as u32 % 100))
            .with_current(Amps::new(6.0 * draws.unit() as f32))
            .with_edge(Edge {
                boundary: large,
                age: ClockTicks(50_000 + tick % 29 * 84_000),
            })
    });
    assert_sound(&edges, samples, "contradicting edges");
}

/// The covariance of the parameters stays positive definite through irregular, absurd updates:
/// counts that jump, with edges at any instant, or none.
#[test]
fn learned_covariance_stays_positive() {
    let rate = Hertz(1000.0);
    let counts = Observer::new(&CoupledMotor::DCX35L, rate, &UNSURE).expect("valid");
    let counts = counts.learning(4096, rate).expect("valid");
    let edges = counts.with_edges(CLOCK, rate).expect("valid");
    let mut draws = Draws(11);
    let (mut state, mut stamped) = (
        counts.start(&Sample::default()),
        edges.start(&Sample::default()),
    );
    let mut large = 0u32;
    for tick in 0..1_000_000 {
        let jump = if tick % 977 == 0 { 1 << 20 } else { 30 };
        large = large.wrapping_add(draws.within(jump) as u32);
        let mut sample = Sample::new(Count(large))
            .with_small(Count(draws.bits() as u32 >> (tick % 32)))
            .with_current(Amps::new(1000.0 * draws.unit() as f32));
        if tick % 5 != 0 {
            sample = sample.with_edge(Edge {
                boundary: Count(large.wrapping_add(draws.bits() as u32 & 1)),
                age: ClockTicks((draws.bits() % 84_000) as u32),
            });
        }
        counts.update(&mut state, &sample);
        edges.update(&mut stamped, &sample);
        for diagonal in [state.learning().diagonal(), stamped.learning().diagonal()] {
            assert!(
                diagonal.iter().all(|d| *d > 0.0 && *d < 1.0),
                "{diagonal:?} at {tick}"
            );
        }
    }
    // Both have learned: D has left the prior.
    for diagonal in [state.learning().diagonal(), stamped.learning().diagonal()] {
        assert!(diagonal.iter().any(|d| *d < 0.05), "{diagonal:?}");
    }
}

/// After a long rest the covariance is not larger than at the start, and one count does not throw
/// the parameters to their ends.
#[test]
fn rest_does_not_make_parameters_less_sure_than_at_the_start() {
    // At 100 Hz 1e5 ticks are 1000 s; the walk of a tenth of the prior in √s would make 3 of it.
    let rate = Hertz(100.0);
    let prior = [0.35f32, 0.6, 0.35].map(|deviation| deviation * deviation);
    let counts = Observer::new(&CoupledMotor::DCX35L, rate, &UNSURE).expect("valid");
    let counts = counts.learning(4096, rate).expect("valid");
    let mut state = counts.start(&Sample::default());
    assert_eq!(*state.learning().diagonal(), prior);
    // 0.3 A over 0.4 s: the parameters believed in are nearly right.
    let (samples, _) = modelled(rate.0, 3.0, 0.3, CoupledMotor::DCX35L);
    for sample in &samples {
        counts.update(&mut state, sample);
    }
    let before = counts.deviations(&state);
    let learned = *state.learning().diagonal();
    assert!((0..3).all(|i| learned[i] < prior[i]), "{learned:?}");
    let rest = samples[samples.len() - 1].with_current(Amps::ZERO);
    for _ in 0..100_000 {
        counts.update(&mut state, &rest);
    }
    let mut moved = rest;
    for _ in 0..20 {
        moved.large = moved.large + Counts(9);
        counts.update(&mut state, &moved.with_current(Amps::new(0.2)));
        let diagonal = state.learning().diagonal();
        assert!(
            (0..3).all(|i| diagonal[i] <= prior[i]),
            "{diagonal:?} above {prior:?}"
        );
    }
    assert_ne!(*state.learning().diagonal(), learned);
    let after = counts.deviations(&state);
    assert!((after.damping - before.damping).abs() < 0.3, "{after:?}");
}

/// Where every tick may have an edge, parameters are learned from one in 3.5 ms: the others would
/// say much the same again.
#[test]
fn edges_teach_once_in_3_5_ms() {
    for rate in [5_000.0, 10_000.0, 20_000.0] {
        let hertz = Hertz(rate);
        let seconds = 2.0;
        let (samples, truth) = modelled(rate, seconds, 0.4, CoupledMotor::DCX35L);
        let counts = Observer::new(&CoupledMotor::DCX35L, hertz, &UNSURE).expect("valid");
        let edges = counts.with_edges(CLOCK, hertz).expect("valid");
        let edges = edges.learning(4096, hertz).expect("valid");
        let mut state = edges.start(&samples[0]);
        let (mut lessons, mut before) = (0, *state.learning().diagonal());
        for sample in &samples[1..] {
            edges.update(&mut state, sample);
            lessons += u32::from(*state.learning().diagonal() != before);
            before = *state.learning().diagonal();
        }
        // Above 5 rad/s there is an edge a millisecond or more.
        let fast = 5.0 * 4096.0 / std::f64::consts::TAU / rate;
        let moving = truth.iter().filter(|v| v.abs() > fast).count() as f64 / rate;
        let lessons = f64::from(lessons);
        assert!(lessons <= seconds / 3.5e-3 + 1.0, "{lessons} at {rate} Hz");
        // A lesson waits for the next edge after 3.5 ms: within a millisecond.
        assert!(
            lessons >= moving / 4.5e-3,
            "{lessons} in {moving} s at {rate} Hz"
        );
    }
}
