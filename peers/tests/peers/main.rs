//! The comparators against closed forms of the continuous filters that they discretise, and against
//! the properties that their projects describe.

mod edges;
mod filters;
mod loops;

use estimator_core::{ClockTicks, Count, Edge, Hertz, Sample, VelocityEstimator};

/// The clock that stamps edges.
const CLOCK: Hertz = Hertz(84e6);

/// Velocities, counts per tick, of the counts after the first one.
fn over<E: VelocityEstimator>(estimator: &E, counts: &[i64]) -> Vec<f64> {
    let sample = |count: &i64| Sample::new(Count(*count as u32));
    run(estimator, counts.iter().map(sample))
}

fn run<E: VelocityEstimator>(estimator: &E, mut samples: impl Iterator<Item = Sample>) -> Vec<f64> {
    let mut state = estimator.start(&samples.next().expect("a sample"));
    let update = |sample| f64::from(estimator.update(&mut state, &sample).0);
    samples.map(update).collect()
}

/// Rest at count 0, then `speed` counts in each tick.
fn started(speed: i64, ticks: usize) -> Vec<i64> {
    (0..=ticks as i64).map(|k| k * speed).collect()
}

/// Samples of the path `position`, counts over ticks, which is monotone or has its edges apart: counts,
/// and the latest edge found by bisection.
fn stamped(position: impl Fn(f64) -> f64, ticks: usize, rate: Hertz) -> Vec<Sample> {
    let mut edge: Option<(f64, i64)> = None;
    let mut samples = Vec::new();
    for k in 0..=ticks {
        let now = k as f64;
        let count = position(now).floor() as i64;
        if k > 0 {
            let before = position(now - 1.0).floor() as i64;
            if count != before {
                let boundary = if count > before { count } else { count + 1 };
                let side = |t: f64| position(t) >= boundary as f64;
                let (mut low, mut high) = (now - 1.0, now);
                for _ in 0..60 {
                    let middle = 0.5 * (low + high);
                    if side(middle) == side(high) {
                        high = middle;
                    } else {
                        low = middle;
                    }
                }
                edge = Some((high, boundary));
            }
        }
        let sample = Sample::new(Count(count as u32));
        samples.push(match edge {
            None => sample,
            Some((at, boundary)) => sample.with_edge(Edge {
                boundary: Count(boundary as u32),
                age: ClockTicks(((now - at) / rate.0 * CLOCK.0).round() as u32),
            }),
        });
    }
    samples
}

/// Fails where two signals are further apart than `most`.
fn assert_near(found: &[f64], wanted: impl Fn(usize) -> f64, most: f64) {
    for (k, found) in found.iter().enumerate() {
        let wanted = wanted(k);
        assert!((found - wanted).abs() <= most, "{k}: {found} {wanted}");
    }
}
