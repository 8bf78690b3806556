//! The M/T method against motions for which it is exact.

use estimator_core::{
    ClockTicks, Count, Counts, DesignError, Edge, Hertz, MOverT, Sample, VelocityEstimator,
};

const CLOCK: Hertz = Hertz(84e6);

/// M/T is exact at a constant velocity, also below one count per tick.
#[test]
fn m_over_t_is_exact_on_a_ramp() {
    let rate = Hertz(1000.0);
    let estimator = MOverT::new(CLOCK, rate).expect("valid");
    for velocity in [0.013, -0.3137, 0.9073, -3.7071, 41.3031] {
        let period = CLOCK.0 / rate.0;
        let mut state = estimator.start(&Sample::new(Count(0)));
        let (mut seen, mut last) = (0, 0.0);
        for tick in 1..2000 {
            let t = f64::from(tick);
            let place: f64 = velocity * t + 0.5;
            let count = place.floor();
            // The boundary passed last and when.
            let boundary = if velocity > 0.0 { count } else { count + 1.0 };
            let age = (place - boundary) / velocity * period;
            let mut sample = Sample::new(Count(count as i64 as u32));
            if boundary != if velocity > 0.0 { 0.0 } else { 1.0 } {
                sample = sample.with_edge(Edge {
                    boundary: Count(boundary as i64 as u32),
                    age: ClockTicks(age as u32),
                });
            }
            last = f64::from(estimator.update(&mut state, &sample).0);
            if count as i64 != seen {
                seen = count as i64;
                if (count as i64).abs() > 3 {
                    assert!(
                        (last / velocity - 1.0).abs() < 1e-4,
                        "{last} for {velocity}"
                    );
                }
            }
        }
        // Between edges the bound is never below the velocity itself.
        assert!((last / velocity - 1.0).abs() < 1e-4);
    }
}

/// Without stamps each count is taken half a tick old: on a ramp of one count in three ticks the
/// result is 1/3 exactly, either way.
#[test]
fn counts_without_stamps_are_taken_half_a_tick_old() {
    let estimator = MOverT::new(CLOCK, Hertz(1000.0)).expect("valid");
    for direction in [1i32, -1] {
        let mut state = estimator.start(&Sample::new(Count(50)));
        let mut velocities = Vec::new();
        for tick in 1..30 {
            let sample = Sample::new(Count(50) + Counts(direction * (tick / 3)));
            velocities.push(estimator.update(&mut state, &sample).0 * direction as f32);
        }
        // Before the first count the position is the middle of the quantisation interval: half a
        // count in two and a half ticks.
        assert_eq!(velocities[..5], [0.0, 0.0, 0.2, 0.2, 0.2], "{direction}");
        let third = 1.0 / 3.0;
        assert!(
            velocities[5..].iter().all(|v| *v == third),
            "{velocities:?}"
        );
    }
}

/// Counts with a stamp and without in turn: the time between them is that of the stamp to the
/// middle of the tick, also when the direction turns round between them.
#[test]
fn stamped_and_unstamped_counts_are_mixed() {
    let estimator = MOverT::new(Hertz(100_000.0), Hertz(1000.0)).expect("valid");
    for direction in [1i32, -1] {
        let at = |count: i32| Count(70) + Counts(direction * count);
        let edge = |count: i32, age| Edge {
            // On the way up the boundary is the count's own, on the way down that above it.
            boundary: at(count) + Counts(i32::from(direction < 0)),
            age: ClockTicks(age),
        };
        let mut state = estimator.start(&Sample::new(at(0)));
        let mut velocity = |sample| estimator.update(&mut state, &sample).0 * direction as f32;
        velocity(Sample::new(at(1)).with_edge(edge(1, 25)));
        // From 1/4 of a tick before the last sample to half a tick before this one.
        assert_eq!(velocity(Sample::new(at(3))), 2.0 / 0.75);
        // From half a tick before the last sample to 0.3 of a tick before this one.
        let third = velocity(Sample::new(at(4)).with_edge(edge(4, 30)));
        assert!((third - 1.0 / 1.2).abs() < 1e-6, "{third}");
        // Back over the same boundary: no motion between both edges.
        let back = velocity(Sample::new(at(3)));
        assert_eq!(back, 0.0);
    }
}

/// A stamp that is older than a tick, or of a boundary that does not touch the count's cell, is
/// none, bit for bit.
#[test]
fn stamp_of_another_interval_or_tick_is_not_used() {
    let estimator = MOverT::new(Hertz(100_000.0), Hertz(1000.0)).expect("valid");
    let run = |edge: Option<(i32, u32)>| {
        let mut state = estimator.start(&Sample::new(Count(9)));
        [3, 5, 5, 4, 4, 9, 2].map(|count| {
            let mut sample = Sample::new(Count(count));
            if let Some((above, age)) = edge {
                sample = sample.with_edge(Edge {
                    boundary: Count(count) + Counts(above),
                    age: ClockTicks(age),
                });
            }
            estimator.update(&mut state, &sample).0.to_bits()
        })
    };
    let without = run(None);
    for ignored in [
        (-1, 20),
        (2, 20),
        (-1, 0),
        (2, 99),
        (0, 100),
        (1, 100),
        (0, u32::MAX),
    ] {
        assert_eq!(run(Some(ignored)), without, "{ignored:?}");
    }
    for taken in [(0, 20), (1, 20), (0, 0), (1, 99), (0, 99)] {
        assert_ne!(run(Some(taken)), without, "{taken:?}");
    }
}

/// A stamp at the first sample is where the first interval begins.
#[test]
fn stamp_of_the_first_sample_counts() {
    let estimator = MOverT::new(Hertz(100_000.0), Hertz(1000.0)).expect("valid");
    for (above, moved) in [(0, 2.0), (1, 1.0)] {
        let first = Sample::new(Count(9)).with_edge(Edge {
            boundary: Count(9 + above),
            age: ClockTicks(25),
        });
        let mut state = estimator.start(&first);
        let second = Sample::new(Count(11)).with_edge(Edge {
            boundary: Count(11),
            age: ClockTicks(75),
        });
        // From 0.25 of a tick before the first sample to 0.75 before the second.
        assert_eq!(estimator.update(&mut state, &second).0, moved / 0.5);
        // Two stamps of one instant give no velocity.
        let mut state = estimator.start(&first);
        let same = Sample::new(Count(9)).with_edge(Edge {
            boundary: Count(10 - above),
            age: ClockTicks(125),
        });
        assert_eq!(estimator.update(&mut state, &same).0, 0.0);
    }
}

/// Between edges the velocity is at most one count over the time since the last edge.
#[test]
fn velocity_falls_while_no_edge_comes() {
    let estimator = MOverT::new(Hertz(100_000.0), Hertz(1000.0)).expect("valid");
    for direction in [1i32, -1] {
        let mut state = estimator.start(&Sample::new(Count(9)));
        let mut last = 0.0;
        for tick in 0..5 {
            let sample = Sample::new(Count(9) + Counts(direction * 2 * tick));
            last = estimator.update(&mut state, &sample).0;
        }
        assert_eq!(last, 2.0 * direction as f32);
        let still = Sample::new(Count(9) + Counts(direction * 8));
        // Half a tick old at the last count: 1.5, 2.5, 3.5 ticks then.
        for waited in [1.5, 2.5, 3.5] {
            let velocity = estimator.update(&mut state, &still).0;
            assert_eq!(velocity, direction as f32 / waited);
        }
    }
}

#[test]
fn edge_clock_has_to_be_as_fast_as_the_rate() {
    let refused = |clock, rate| MOverT::new(Hertz(clock), Hertz(rate)).err();
    assert_eq!(refused(1000.0, 1000.0), None);
    for clock in [999.0, 0.0, -1.0, f64::NAN, f64::INFINITY, 1e300] {
        assert_eq!(refused(clock, 1000.0), Some(DesignError::CLOCK), "{clock}");
    }
    for rate in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        assert_eq!(refused(1e6, rate), Some(DesignError::RATE), "{rate}");
    }
}
