//! Boundaries that are learned, and what is not learned.

use super::super::MOverT;
use super::super::draws::draw;
use super::*;
use crate::sample::Edge;
use crate::units::ClockTicks;

mod definition;

const CLOCK: Hertz = Hertz(1e8);
const RATE: Hertz = Hertz(1000.0);
/// Deviations of the boundaries of an electrical turn of three Hall sensors, counts.
const UNEVEN: [f64; 6] = [0.0, 0.15, -0.1, 0.05, -0.15, 0.05];

/// Samples of a motion, counts by time in ticks, of an encoder whose boundary b lies at
/// `b + deviations[b mod 6]`.
fn samples(
    motion: impl Fn(f64) -> f64,
    deviations: [f64; 6],
    ticks: i32,
) -> impl Iterator<Item = Sample> {
    let boundary = move |b: i32| f64::from(b) + deviations[b.rem_euclid(6) as usize];
    let (mut count, mut edge) = (0, None);
    (1..=ticks).map(move |k| {
        let now = f64::from(k);
        let position = motion(now);
        while position >= boundary(count + 1) {
            count += 1;
            edge = Some((count, k));
        }
        while position < boundary(count) {
            edge = Some((count, k));
            count -= 1;
        }
        let mut sample = Sample::new(Count(count as u32));
        if let Some((of, crossed)) = edge {
            // Within the tick of the crossing the motion has one direction.
            let [mut before, mut after] = [f64::from(crossed - 1), f64::from(crossed)];
            for _ in 0..40 {
                let middle = 0.5 * (before + after);
                let is_below = motion(middle) < boundary(of);
                if is_below == (motion(after) < boundary(of)) {
                    after = middle;
                } else {
                    before = middle;
                }
            }
            let age = (now - after) * CLOCK.0 / RATE.0;
            sample = sample.with_edge(Edge {
                boundary: Count(of as u32),
                age: ClockTicks(age as u32),
            });
        }
        sample
    })
}

/// The motion at constant velocity, counts/tick.
fn constant(velocity: f64) -> impl Fn(f64) -> f64 {
    move |t| 0.37 + velocity * t
}

/// Largest error of the last 500 ticks.
fn largest_error<E: VelocityEstimator>(filter: &E, velocity: f64, uneven: [f64; 6]) -> f64 {
    let mut state = filter.start(&Sample::new(Count(0)));
    let errors = samples(constant(velocity), uneven, 20_000).map(|sample| {
        let found = filter.update(&mut state, &sample).0;
        (f64::from(found) - velocity).abs()
    });
    errors.skip(19_500).fold(0.0, f64::max)
}

#[test]
fn uneven_boundaries_are_learned() {
    let even = MOverT::new(CLOCK, RATE).unwrap();
    for velocity in [0.3, 0.9, -0.7123, 1.43] {
        let plain = largest_error(&even, velocity, UNEVEN);
        // 0.25 counts between neighbours of 1 count.
        assert!(plain > 0.1 * velocity.abs(), "{velocity}: {plain}");
        let learned = LearnedMOverT::<12>::new(CLOCK, RATE).unwrap();
        let learned = largest_error(&learned, velocity, UNEVEN);
        assert!(learned < 0.05 * plain, "{velocity}: {plain} to {learned}");
    }
}

#[test]
fn even_boundaries_are_not_disturbed() {
    for velocity in [0.3, -0.7123, 3.3] {
        let learned = LearnedMOverT::<12>::new(CLOCK, RATE).unwrap();
        let error = largest_error(&learned, velocity, [0.0; 6]);
        // The clock resolves 1e-5 ticks.
        assert!(error < 1e-3 * velocity.abs(), "{velocity}: {error}");
    }
}

#[test]
fn velocity_falls_as_a_distance_over_the_time_at_rest() {
    let filter = LearnedMOverT::<12>::new(CLOCK, RATE).unwrap();
    let mut state = filter.start(&Sample::new(Count(0)));
    let mut last = Sample::new(Count(0));
    for sample in samples(constant(0.9), UNEVEN, 3000) {
        filter.update(&mut state, &sample);
        last = sample;
    }
    let rest = Sample::new(last.count);
    let learned = state.offsets;
    for tick in 1..1000 {
        let v = filter.update(&mut state, &rest).0;
        assert!(v <= 1.5 / tick as f32, "{tick}: {v}");
    }
    assert_eq!(state.offsets, learned);
}

fn learned(samples: impl Iterator<Item = Sample>) -> LearnedMOverTState<12> {
    let filter = LearnedMOverT::<12>::new(CLOCK, RATE).unwrap();
    let mut state = filter.start(&Sample::new(Count(0)));
    for sample in samples {
        filter.update(&mut state, &sample);
    }
    state
}

fn largest(offsets: [f32; 12]) -> f32 {
    offsets
        .iter()
        .fold(0.0, |most, offset| most.max(offset.abs()))
}

#[test]
fn acceleration_is_not_taken_for_uneven_boundaries() {
    // From 0.5 to 2 counts/tick.
    let state = learned(samples(|t| 0.37 + 0.5 * t + 2.5e-4 * t * t, [0.0; 6], 3000));
    assert!(state.slope > 1.9, "{}", state.slope);
    // The prediction is behind by the acceleration over the gain of the velocity: 5e-4/0.05 counts for
    // an edge each tick, and four times that for one each two ticks.
    let offset = largest(state.offsets);
    assert!(offset < 0.02, "{offset}");
}

#[test]
fn offset_and_its_step_are_limited() {
    // The first deviation is far above the limit.
    let far = learned(samples(
        constant(0.9),
        [0.45, 0.0, 0.0, 0.0, 0.0, 0.0],
        20_000,
    ));
    assert_eq!(largest(far.offsets), LARGEST_OFFSET);
    // An error of nearly two counts is one of the motion.
    let mut state = learned(samples(constant(0.9), UNEVEN, 20_000));
    let before = state.offsets;
    let error = state.correct(state.predicted + state.slope + 1.9, 1.0);
    state.learn(3, error.expect("the prediction goes on"));
    let step = (state.offsets[3] - before[3]).abs();
    assert!(step <= OFFSET_GAIN * LARGEST_OFFSET + 1e-6, "{step}");
}

#[test]
fn edges_without_stamp_and_edges_far_apart_teach_nothing() {
    let unstamped = samples(constant(0.9), UNEVEN, 5000).map(|sample| Sample::new(sample.count));
    assert_eq!(learned(unstamped).offsets, [0.0; 12]);
    let fast = learned(samples(constant(5.3), UNEVEN, 5000));
    assert_eq!(fast.offsets, [0.0; 12]);
}

#[test]
fn learning_goes_on_after_a_sudden_reversal() {
    let back = |t: f64| 0.37 + 1.9 * (3000.0 - (t - 3000.0).abs());
    // Three ticks before and after are enough for the edges, and too few to learn.
    let short = learned(samples(back, UNEVEN, 3012));
    assert!((short.slope + 1.9).abs() < 0.3, "{}", short.slope);
    let filter = LearnedMOverT::<12>::new(CLOCK, RATE).unwrap();
    let mut state = filter.start(&Sample::new(Count(0)));
    let last = samples(back, UNEVEN, 6000).map(|sample| filter.update(&mut state, &sample).0);
    let worst = last
        .skip(5500)
        .fold(0.0, |most: f32, v| most.max((v + 1.9).abs()));
    let plain = largest_error(&MOverT::new(CLOCK, RATE).unwrap(), -1.9, UNEVEN);
    assert!(f64::from(worst) < 0.05 * plain, "{plain} to {worst}");
}

#[test]
fn velocity_without_an_edge_keeps_its_direction_and_does_not_grow() {
    let filter = LearnedMOverT::<12>::new(CLOCK, RATE).unwrap();
    let mut seed = 4;
    for turns in [7.0, 31.0, 113.0] {
        let mut state = filter.start(&Sample::new(Count(0)));
        let swing = |t: f64| 3.3 + 2.6 * (t / turns).sin();
        let (mut before, mut count) = (0.0f32, Count(0));
        for mut sample in samples(swing, UNEVEN, 5000) {
            if draw(&mut seed) & 3 == 0 {
                sample.edge = None;
            }
            let is_fresh = filter.clock.fresh(&sample).is_some();
            let v = filter.update(&mut state, &sample).0;
            if sample.count == count && !is_fresh {
                assert!(
                    v * before >= 0.0 && v.abs() <= before.abs(),
                    "{before} to {v}"
                );
            }
            (before, count) = (v, sample.count);
        }
    }
}

#[test]
fn velocity_after_a_turn_within_a_tick_is_not_negative() {
    let filter = LearnedMOverT::<12>::new(CLOCK, RATE).unwrap();
    let mut state = filter.start(&Sample::new(Count(0)));
    let edge = |boundary, age| Edge {
        boundary: Count(boundary),
        age: ClockTicks(age),
    };
    let at = Sample::new(Count(1));
    filter.update(&mut state, &at.with_edge(edge(1, 50_000)));
    // Up to the next boundary and back: its offset, which is learned from this edge, is below the edge.
    let v = filter.update(&mut state, &at.with_edge(edge(2, 10_000))).0;
    assert!(v > 0.0 && largest(state.offsets) > 0.0, "{v}");
    assert_eq!(filter.update(&mut state, &at).0, 0.0);
}

#[test]
fn clock_out_of_range_is_refused() {
    let slow = LearnedMOverT::<12>::new(Hertz(10.0), RATE);
    assert_eq!(slow, Err(DesignError::CLOCK));
}
