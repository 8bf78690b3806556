//! What the observers learn, and what they must not.

use estimator_core::{
    AmplifierCurrent, Amps, ClockTicks, Correction, Count, CoupledMotor, Edge, Hertz, Learned,
    Observer, Sample, SmallEncoder, Uncertainty, VelocityEstimator,
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
