//! Defects found in public velocity estimators, one test each, by name.
//!
//! | defect | where else it is held off |
//! |---|---|
//! | first sample differenced against a buffer of zeros, or against memory before the buffer | `invariants::velocity_is_zero_after_a_start_at_rest_at_any_count`, `first_step_is_relative_to_the_first_sample` |
//! | reset that forgets the ring's index | `invariants::restart_is_a_fresh_start` |
//! | velocity that never returns to zero at rest | `invariants::velocity_returns_to_zero_at_rest` |
//! | dead zone that hides slow motion | `invariants::slow_motion_has_the_correct_mean_velocity` |
//! | low-pass that sees the wrap | `invariants::wrap_at_any_tick_does_not_change_the_velocity` |
//! | f32 position that loses counts after a few million | `endurance::velocity_is_exact_beyond_a_billion_counts`, `long_ramps_do_not_drift` |
//! | window rule decided by rounding at the band's edge | `foaw_definition` |
//! | innovation covariance taken from the posterior | `kalman_reference` |
//! | covariance that loses symmetry | `endurance::covariance_stays_symmetric_and_positive` |
//! | sample period in ticks where seconds are wanted | `refuses_period_in_ticks` in `refusals` |
//!
//! The tests here are the shortest that show the defect.

use estimator_core::{
    BestFit, Count, CountsPerTick, EndFit, FiniteDifference, Fit, Foaw, Hertz, Kalman, LowPass,
    Model, Pll, Sample, Scale, SteadyKalman, VelocityEstimator,
};

use crate::foaw_definition::defined;

fn at(count: u32) -> Sample {
    Sample::new(Count(count))
}

/// Velocities at all counts but the first.
fn run<E: VelocityEstimator>(estimator: &E, counts: &[u32]) -> Vec<f32> {
    let mut state = estimator.start(&at(counts[0]));
    let update = |count: &u32| estimator.update(&mut state, &at(*count)).0;
    counts[1..].iter().map(update).collect()
}

fn low_pass() -> LowPass<FiniteDifference> {
    LowPass::new(FiniteDifference, Hertz(100.0), Hertz(1000.0)).unwrap()
}

fn foaw<const N: usize, F: Fit>(d: u16) -> Foaw<N, F> {
    Foaw::new(N, d).unwrap()
}

#[test]
fn first_sample_is_not_differenced_against_zeros() {
    // Against zeros the first output would be 5000 counts, or a window's share of them.
    let counts = [5000; 8];
    assert_eq!(run(&FiniteDifference, &counts), [0.0; 7]);
    assert_eq!(run(&low_pass(), &counts), [0.0; 7]);
    assert_eq!(run(&foaw::<4, EndFit>(1), &counts), [0.0; 7]);
    assert_eq!(run(&foaw::<4, BestFit>(1), &counts), [0.0; 7]);
}

#[test]
fn window_does_not_reach_before_the_first_sample() {
    // From a start in motion every window, however short still, sees the one velocity: with the
    // band wide open nothing else ends it. Memory before the buffer would pull it to some other.
    let counts: Vec<u32> = (0..12).map(|tick| 70_000 + 9 * tick).collect();
    assert_eq!(run(&foaw::<8, EndFit>(16_384), &counts), [9.0; 11]);
    assert_eq!(run(&foaw::<8, BestFit>(16_384), &counts), [9.0; 11]);
    let foaw = foaw::<8, EndFit>(16_384);
    let mut state = foaw.start(&at(counts[0]));
    for (tick, count) in counts.iter().enumerate().skip(1) {
        foaw.update(&mut state, &at(*count));
        assert_eq!(state.window(), tick.min(8));
    }
}

#[test]
fn restart_does_not_keep_the_index_of_the_ring() {
    let foaw = foaw::<5, EndFit>(16_384);
    for used in 0..12 {
        // The ring's index stands anywhere when the restart comes.
        let mut state = foaw.start(&at(1));
        for tick in 0..used {
            foaw.update(&mut state, &at(1000 * tick));
        }
        state = foaw.start(&at(40));
        assert_eq!(state.window(), 0);
        for (tick, count) in [42, 44, 46, 48, 50, 52, 54u32].into_iter().enumerate() {
            assert_eq!(foaw.update(&mut state, &at(count)).0, 2.0);
            assert_eq!(state.window(), (tick + 1).min(5));
        }
    }
}

/// The steps that FOAW restarts itself at leave no trace of the old window, either.
#[test]
fn step_beyond_the_range_restarts_the_window() {
    let foaw = foaw::<6, BestFit>(16_384);
    let mut counts = vec![0, 1, 2, 3];
    counts.extend((0..9).map(|tick| 3 + (1 << 15) + 4 * tick));
    let velocities = run(&foaw, &counts);
    assert_eq!(velocities[3], 32_768.0);
    assert_eq!(velocities[4..], [4.0; 8]);
}

/// Nor does a state that was restarted differ from one that began there.
#[test]
fn restarted_window_equals_a_fresh_one() {
    let foaw = foaw::<6, EndFit>(16_384);
    let landed = 3 + (1 << 15);
    let mut restarted = foaw.start(&at(0));
    for count in [1, 2, 3, landed] {
        foaw.update(&mut restarted, &at(count));
    }
    let mut fresh = foaw.start(&at(landed));
    for tick in 1..12 {
        let sample = at(landed + tick * tick);
        foaw.update(&mut restarted, &sample);
        assert_ne!(restarted, fresh);
        foaw.update(&mut fresh, &sample);
        assert_eq!(restarted, fresh, "after {tick} ticks");
    }
}

#[test]
fn velocity_returns_to_zero_at_rest() {
    // 10 counts a tick, then none: exactly nothing after a window of rest.
    let mut counts: Vec<u32> = (0..40).map(|tick| 10 * tick).collect();
    counts.extend([390; 400]);
    assert!(
        run(&FiniteDifference, &counts)[39..]
            .iter()
            .all(|v| *v == 0.0)
    );
    assert!(
        run(&foaw::<16, EndFit>(1), &counts)[39 + 16..]
            .iter()
            .all(|v| *v == 0.0)
    );
    assert!(
        run(&foaw::<16, BestFit>(1), &counts)[39 + 16..]
            .iter()
            .all(|v| *v == 0.0)
    );
    // exp(-2 π 0.1) a tick: 4 ticks divide by more than ten.
    assert!(
        run(&low_pass(), &counts)[39 + 40..]
            .iter()
            .all(|v| v.abs() < 1e-9)
    );
}

#[test]
fn slow_motion_is_not_suppressed_by_a_dead_zone() {
    // One count in 50 ticks is no standstill.
    let counts: Vec<u32> = (0..2001).map(|tick| tick / 50).collect();
    let sum = |velocities: Vec<f32>| velocities.iter().copied().map(f64::from).sum::<f64>();
    // 40 counts were counted: so many is the sum of the velocities, within the last half count.
    assert!((sum(run(&FiniteDifference, &counts)) - 40.0).abs() < 1e-9);
    assert!((sum(run(&low_pass(), &counts)) - 40.0).abs() < 1.0);
    assert!((sum(run(&foaw::<16, EndFit>(1), &counts)) - 40.0).abs() < 1.0);
    assert!((sum(run(&foaw::<16, BestFit>(1), &counts)) - 40.0).abs() < 1.0);
    let pll = Pll::new(Hertz(60.0), Hertz(1000.0)).unwrap();
    assert!((sum(run(&pll, &counts)) - 40.0).abs() < 1.0);
}

#[test]
fn low_pass_is_not_disturbed_by_the_wrap() {
    // 3 counts a tick through 2^32: a filter of the position would swing by 2^32 counts.
    let counts: Vec<u32> = (0..60u32).map(|tick| (3 * tick).wrapping_sub(90)).collect();
    let velocities = run(&low_pass(), &counts);
    assert!(
        velocities.iter().all(|v| (0.0..=3.0).contains(v)),
        "{velocities:?}"
    );
    assert!((velocities[58] - 3.0).abs() < 1e-5);
    // A 16-bit counter wraps 65 536 times as often.
    let mut wide = Count(0xFFF0);
    let filter = low_pass();
    let mut state = filter.start(&Sample::new(wide));
    for tick in 1..60u16 {
        wide = wide.extended(0xFFF0u16.wrapping_add(3 * tick));
        let v = filter.update(&mut state, &Sample::new(wide)).0;
        assert_eq!(v, velocities[usize::from(tick) - 1]);
    }
}

#[test]
fn position_keeps_every_count_beyond_a_few_million() {
    // An f32 position has steps of 64 counts at 1e9. One count must stay one count, for estimators
    // that started there and for those that moved there.
    let model = Model::triple_integrator(4096, Hertz(1000.0), 2e4).unwrap();
    let kalman = Kalman::new(&model).unwrap();
    let steady = SteadyKalman::new(&model).unwrap();
    let pll = Pll::new(Hertz(60.0), Hertz(1000.0)).unwrap();
    for (from, journey) in [
        (0, 0),
        (1_000_000_000, 0),
        (0, 50_000),
        (4_000_000_000, 300),
    ] {
        let mut counts: Vec<u32> = (0..=journey).map(|tick| from + 20_000 * tick).collect();
        let there = from + 20_000 * journey;
        counts.extend([there; 600]);
        counts.extend((1..=400).map(|tick| there + tick));
        let last = counts.len() - 2;
        assert_eq!(run(&FiniteDifference, &counts)[last], 1.0);
        assert_eq!(run(&foaw::<15, EndFit>(1), &counts)[last], 1.0);
        for velocity in [
            run(&kalman, &counts)[last],
            run(&steady, &counts)[last],
            run(&pll, &counts)[last],
        ] {
            assert!((velocity - 1.0).abs() < 1e-5, "{velocity} at {there}");
        }
    }
}

#[test]
fn window_at_the_limit_of_the_band_is_not_decided_by_rounding() {
    // Samples next to a line through both ends, with one between them moved: d counts off the
    // line it is inside, one count more and it is not. With slopes that are no whole number, and
    // with large ones, a product or a quotient in f32 decides many of these wrongly.
    let mut ties = 0;
    for d in [1u16, 5] {
        let foaw = foaw::<128, EndFit>(d);
        for interval in (2..=15i64).chain([49, 98, 126]) {
            for rise in (-40..40).chain(30_000 * interval..30_000 * interval + 20) {
                // The moved sample lies where the line meets a whole count.
                for moved in (1..interval).filter(|j| j * rise % interval == 0) {
                    for off in [i64::from(d), -i64::from(d), i64::from(d) + 1] {
                        let line = |age: i64| -(2 * rise * age + interval).div_euclid(2 * interval);
                        let y = |age: i64| line(age) + if age == moved { off } else { 0 };
                        let newest_first: Vec<i64> = (0..=interval).map(y).collect();
                        let (_, length) = defined::<EndFit>(&newest_first, i128::from(d));
                        let counts: Vec<u32> =
                            newest_first.iter().rev().map(|y| *y as u32).collect();
                        let mut state = foaw.start(&at(counts[0]));
                        for count in &counts[1..] {
                            foaw.update(&mut state, &at(*count));
                        }
                        assert_eq!(state.window(), length, "d = {d}: {newest_first:?}");
                        let is_tie = off.abs() == i64::from(d) && length as i64 == interval;
                        ties += usize::from(is_tie);
                    }
                }
            }
        }
    }
    assert!(ties > 2000, "only {ties} windows end at a tie");
}

#[test]
fn innovation_covariance_is_that_of_the_prediction() {
    // By hand, one tick from the start: P = diag(1/12, 1024, 1) becomes A P A' + Q with
    // P_00 = 1/12 + 1024 + 1/4 + q/20 and P_10 = 1024 + 1/2 + q/8; S = P_00 + 1/12. Taken from
    // before the prediction, S would be 1/6 and the gain six thousand.
    let model = Model::triple_integrator(4096, Hertz(1000.0), 2e4).unwrap();
    let jerk = 2e4 * 4096.0 / std::f64::consts::TAU * 1000f64.powf(-2.5);
    let q = jerk * jerk;
    let s = 2.0 / 12.0 + 1024.0 + 0.25 + q / 20.0;
    let expected = (1024.5 + q / 8.0) / s * 3.0;
    let velocity = f64::from(run(&Kalman::new(&model).unwrap(), &[10, 13])[0]);
    assert!(
        (velocity / expected - 1.0).abs() < 1e-6,
        "{velocity} for {expected}"
    );
}

#[test]
fn covariance_stays_symmetric() {
    let model = Model::triple_integrator(4096, Hertz(11_600.0), 2e4).unwrap();
    let kalman = Kalman::new(&model).unwrap();
    let mut state = kalman.start(&at(0));
    for tick in 0..200_000u32 {
        kalman.update(&mut state, &at(tick.wrapping_mul(0x9E37_79B9) >> 20));
        let p = kalman.covariance(&state);
        assert_eq!((p[0][1], p[0][2], p[1][2]), (p[1][0], p[2][0], p[2][1]));
    }
}

#[test]
fn rate_is_in_hertz_and_its_period_in_seconds() {
    // 1 count a tick of 1 ms with 4096 counts a turn: 1000 / 4096 turns a second.
    let velocity = CountsPerTick(1.0).rad_per_s(&Scale::new(4096, Hertz(1000.0)).unwrap());
    let turns = f64::from(velocity) / std::f64::consts::TAU;
    assert!((turns - 1000.0 / 4096.0).abs() < 1e-7);
    assert_eq!(Hertz(1000.0).period_s(), 1e-3);
    // A clock of 168 MHz has 168 000 ticks in it; the type for those does not pass for a rate,
    // which `refuses_period_in_ticks` in the package `refusals` shows.
}
