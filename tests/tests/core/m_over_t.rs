//! The M/T method against the motion that it knows exactly.

use estimator_core::{ClockTicks, Count, Edge, Hertz, MOverT, Sample, VelocityEstimator};

const CLOCK: Hertz = Hertz(84e6);

/// M/T is exact at a constant velocity, however few counts that is.
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
