//! One estimator over one trace.

use estimator_catalogue::{UpdateOver, VarianceOver};
use estimator_core::{
    Amps, ClockTicks, Count, CountsPerTick, Edge, Sample, Scale, Signals, VelocityEstimator,
};

use simulation::trace::{EDGE_CLOCK_HZ, EdgeStamp, Trace};

/// Signals of a trace.
#[must_use]
pub(super) fn available(trace: &Trace) -> Signals {
    Signals {
        current: trace.current.is_some(),
        coupled: trace.counts_small.is_some(),
        edge: trace.edges.is_some(),
    }
}

/// The functions of an estimator over varying periods; `None` for one that assumes a constant period.
pub(super) struct Over<E: VelocityEstimator> {
    pub(super) update: Option<UpdateOver<E>>,
    pub(super) variance: Option<VarianceOver<E>>,
}

impl<E: VelocityEstimator> Over<E> {
    /// A constant period is assumed.
    pub(super) const NONE: Self = Self {
        update: None,
        variance: None,
    };
}

/// An estimator that runs over a trace.
type Subject<'a, E> = (&'a E, &'a Over<E>);

/// The velocity at each tick, rad/s.
pub(super) fn velocities<E>(subject: Subject<E>, trace: &Trace, scale: &Scale) -> Vec<f32>
where
    E: VelocityEstimator,
{
    run(subject, trace, 0.0, |_, velocity, _| {
        velocity.rad_per_s(scale)
    })
}

/// The results of `read` after each tick. At the first tick the estimator starts and the result is
/// `first`.
pub(super) fn run<E, T>(
    subject: Subject<E>,
    trace: &Trace,
    first: T,
    read: impl Fn(&E::State, CountsPerTick, Option<f32>) -> T,
) -> Vec<T>
where
    E: VelocityEstimator,
    T: Clone,
{
    resume(subject, &mut None, trace, 0, first, read)
}

/// The results of `read` after each tick from `from` on, with the state after the tick before it.
/// Without a state, the estimator starts at tick `from` and the result there is `first`. `read` also
/// has the period before the tick, in control periods, where the trace has periods and the estimator
/// takes them.
pub(super) fn resume<E, T>(
    (estimator, over): Subject<E>,
    state: &mut Option<E::State>,
    trace: &Trace,
    from: usize,
    first: T,
    read: impl Fn(&E::State, CountsPerTick, Option<f32>) -> T,
) -> Vec<T>
where
    E: VelocityEstimator,
    T: Clone,
{
    let mut values = vec![first; trace.len() - from];
    let mut ticks = (from..trace.len()).zip(&mut values);
    let mut after = match state.take() {
        Some(state) => state,
        None => match ticks.next() {
            Some((k, _)) => estimator.start(&sample(E::NEEDS, trace, k)),
            None => return values,
        },
    };
    let over = trace.periods.as_deref().zip(over.update);
    for (k, value) in ticks {
        let sample = sample(E::NEEDS, trace, k);
        *value = match over {
            Some((periods, update)) => {
                let period = periods[k];
                let velocity = update(estimator, &mut after, &sample, period);
                read(&after, velocity, Some(period))
            }
            None => {
                let velocity = estimator.update(&mut after, &sample);
                read(&after, velocity, None)
            }
        };
    }
    *state = Some(after);
    values
}

/// Sample at tick `k` with the signals `needs`. `needs` is a constant where this function is
/// inlined, so columns that the estimator does not need are not read.
#[inline(always)]
#[must_use]
pub fn sample(needs: Signals, trace: &Trace, k: usize) -> Sample {
    let mut sample = Sample::new(Count(trace.counts_large[k]));
    if needs.current {
        // The current of a trace acts from its tick on, that of a sample until its tick.
        if let (Some(current), Some(before)) = (&trace.current, k.checked_sub(1)) {
            sample.current = Amps::new(current[before] as f32);
        }
    }
    if let (true, Some(counts)) = (needs.coupled, &trace.counts_small) {
        sample.coupled = Count(counts[k]);
    }
    if let (true, Some(edges)) = (needs.edge, &trace.edges) {
        sample.edge = edges[k].map(edge);
    }
    sample
}

fn edge(stamp: EdgeStamp) -> Edge {
    Edge {
        boundary: Count(stamp.boundary),
        // A float-to-integer cast saturates.
        age: ClockTicks((stamp.age_s * EDGE_CLOCK_HZ).round() as u32),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// An estimator that reads all signals and returns them.
    struct Spy;

    impl VelocityEstimator for Spy {
        type State = ();
        const NEEDS: Signals = Signals {
            current: true,
            coupled: true,
            edge: true,
        };

        fn start(&self, first: &Sample) {
            assert_eq!(first.current, Amps::ZERO);
        }

        fn update(&self, (): &mut (), sample: &Sample) -> CountsPerTick {
            let edge = sample.edge.map_or(0.0, |edge| edge.age.0 as f32 / 84.0);
            CountsPerTick(sample.current.get() + sample.coupled.0 as f32 + edge)
        }
    }

    #[test]
    fn a_sample_holds_the_current_applied_before_it() {
        let stamp = |age_s| Some(EdgeStamp { age_s, boundary: 1 });
        let trace = Trace {
            rate_hz: 1000.0,
            counts_large: vec![0, 0, 0],
            counts_small: Some(vec![0, 100, 200]),
            current: Some(vec![1.0, 2.0, 4.0]),
            edges: Some(vec![None, None, stamp(1000e-6)]),
            ..Trace::default()
        };
        let unit = Scale {
            rad_per_s_per_count_per_tick: 1.0,
        };
        assert_eq!(
            velocities((&Spy, &Over::NONE), &trace, &unit),
            [0.0, 101.0, 1202.0]
        );
    }
}
