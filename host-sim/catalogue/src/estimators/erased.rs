//! One type for estimators of any type.

use std::any::Any;
use std::sync::Arc;

use estimator_core::{
    AccelerationEstimator, Confidence, CountsPerTick, CountsPerTickSquared, Sample, Scale, Signals,
    VelocityEstimator,
};

use super::run::{Over, resume, run, velocities};
use simulation::trace::Trace;

/// An estimator of any type, with its parameters.
#[derive(Clone)]
pub struct Estimator(Arc<dyn Erased>);

impl Estimator {
    /// Velocity at each tick of a trace, rad/s. At the first tick the estimator starts and the
    /// velocity is zero.
    #[must_use]
    pub fn run(&self, trace: &Trace) -> Vec<f32> {
        self.0.run(trace)
    }

    /// What the estimator reports at each tick of a trace from `from` on. `state` is its state after
    /// the tick before, or `None` for a start at `from`, and becomes that after the last tick. A trace
    /// in parts gives the values of the whole trace, if each part begins with a tick of the part
    /// before it.
    #[must_use]
    pub fn resume(&self, state: &mut Option<State>, trace: &Trace, from: usize) -> Reports {
        self.0.resume(state, trace, from)
    }

    /// Ratio of the coupler's learned damping to the assumed one at each tick of a trace; `None` if
    /// the estimator does not learn it.
    #[must_use]
    pub fn damping_ratio(&self, trace: &Trace) -> Option<Vec<f32>> {
        self.0.damping_ratio(trace)
    }
}

/// What an estimator reports, one value per tick.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Reports {
    /// Velocity, rad/s.
    pub velocity: Vec<f32>,
    /// Standard deviation of the velocity, rad/s; `None` if the estimator reports none.
    pub deviation: Option<Vec<f32>>,
    /// Ratio of the coupler's learned damping to the assumed one; `None` if the estimator does not
    /// learn it.
    pub damping_ratio: Option<Vec<f32>>,
    /// Acceleration, rad/s^2; `None` if the estimator gives none.
    pub acceleration: Option<Vec<f32>>,
}

/// A control loop calls the estimator through this trait.
impl VelocityEstimator for Estimator {
    type State = State;
    const NEEDS: Signals = Signals {
        current: true,
        coupled: true,
        edge: true,
    };

    fn start(&self, first: &Sample) -> State {
        self.0.start(first)
    }

    fn update(&self, state: &mut State, sample: &Sample) -> CountsPerTick {
        self.0.update(state, sample)
    }
}

impl Estimator {
    /// Whether the estimator gives an acceleration.
    #[must_use]
    pub fn gives_acceleration(&self) -> bool {
        let state = self.start(&Sample::default());
        self.0.acceleration(&state).is_some()
    }
}

/// The acceleration is zero if [`Estimator::gives_acceleration`] is `false`.
impl AccelerationEstimator for Estimator {
    fn acceleration(&self, state: &State) -> CountsPerTickSquared {
        self.0.acceleration(state).unwrap_or_default()
    }
}

/// State of an [`Estimator`].
pub struct State(Box<dyn ErasedState>);

impl Clone for State {
    fn clone(&self) -> Self {
        self.0.copy()
    }
}

impl PartialEq for State {
    fn eq(&self, other: &Self) -> bool {
        self.0.same(other.0.as_any())
    }
}

trait ErasedState: Any + Send {
    fn copy(&self) -> State;
    fn same(&self, other: &dyn Any) -> bool;
    fn as_any(&self) -> &dyn Any;
    fn as_any_mut(&mut self) -> &mut dyn Any;
    fn into_any(self: Box<Self>) -> Box<dyn Any>;
}

impl<S: Clone + PartialEq + Send + 'static> ErasedState for S {
    fn copy(&self) -> State {
        State(Box::new(self.clone()))
    }

    fn same(&self, other: &dyn Any) -> bool {
        other.downcast_ref() == Some(self)
    }

    fn as_any(&self) -> &dyn Any {
        self
    }

    fn as_any_mut(&mut self) -> &mut dyn Any {
        self
    }

    fn into_any(self: Box<Self>) -> Box<dyn Any> {
        self
    }
}

trait Erased: Send + Sync {
    fn run(&self, trace: &Trace) -> Vec<f32>;
    fn damping_ratio(&self, trace: &Trace) -> Option<Vec<f32>>;
    fn resume(&self, state: &mut Option<State>, trace: &Trace, from: usize) -> Reports;
    fn start(&self, first: &Sample) -> State;
    fn update(&self, state: &mut State, sample: &Sample) -> CountsPerTick;
    fn acceleration(&self, state: &State) -> Option<CountsPerTickSquared>;
}

/// An estimator, the scale of its encoder and the quantities that it reports.
struct Scaled<E: VelocityEstimator> {
    estimator: E,
    scale: Scale,
    outputs: Outputs<E>,
    over: Over<E>,
}

impl<E: VelocityEstimator> Scaled<E> {
    /// The standard deviation after an update over `period`, as `deviation` reads it over a constant
    /// one.
    fn deviation_over(
        &self,
        deviation: Output<E, CountsPerTick>,
        state: &E::State,
        period: Option<f32>,
    ) -> CountsPerTick {
        match (period, self.over.variance) {
            (Some(period), Some(variance)) => variance(&self.estimator, state, period).std_dev(),
            _ => deviation(&self.estimator, state),
        }
    }
}

/// Reads a quantity from the state of an estimator.
type Output<E, T> = fn(&E, &<E as VelocityEstimator>::State) -> T;

/// Reads the ratio of the learned to the assumed damping.
pub(super) type DampingRatio<E> = Output<E, f32>;

/// Quantities that an estimator reports besides the velocity.
struct Outputs<E: VelocityEstimator> {
    /// Standard deviation of the velocity.
    deviation: Option<Output<E, CountsPerTick>>,
    damping_ratio: Option<DampingRatio<E>>,
    acceleration: Option<Output<E, CountsPerTickSquared>>,
}

impl<E: VelocityEstimator> Outputs<E> {
    const NONE: Self = Self {
        deviation: None,
        damping_ratio: None,
        acceleration: None,
    };
}

impl<E: Confidence> Outputs<E> {
    const DEVIATION: Self = Self {
        deviation: Some(|estimator, state| estimator.variance(state).std_dev()),
        ..Self::NONE
    };
}

impl<E> Erased for Scaled<E>
where
    E: VelocityEstimator<State: Send + 'static> + Send + Sync,
{
    fn run(&self, trace: &Trace) -> Vec<f32> {
        velocities((&self.estimator, &self.over), trace, &self.scale)
    }

    fn damping_ratio(&self, trace: &Trace) -> Option<Vec<f32>> {
        let damping_ratio = self.outputs.damping_ratio?;
        let subject = (&self.estimator, &self.over);
        Some(run(subject, trace, 1.0, |state, _, _| {
            damping_ratio(&self.estimator, state)
        }))
    }

    fn resume(&self, state: &mut Option<State>, trace: &Trace, from: usize) -> Reports {
        let Outputs {
            deviation,
            damping_ratio,
            acceleration,
        } = self.outputs;
        let rate_hz = trace.rate_hz as f32;
        // The state of another estimator counts as none.
        let own = state
            .take()
            .and_then(|state| state.0.into_any().downcast().ok());
        let mut own = own.map(|state| *state);
        let values = resume(
            (&self.estimator, &self.over),
            &mut own,
            trace,
            from,
            [0.0, 0.0, 1.0, 0.0],
            |state, velocity, period| {
                let deviation = deviation.map_or(CountsPerTick(0.0), |of| {
                    self.deviation_over(of, state, period)
                });
                let ratio = damping_ratio.map_or(1.0, |of| of(&self.estimator, state));
                // A change of the velocity per tick is one per period.
                let change = acceleration.map_or(0.0, |of| of(&self.estimator, state).0);
                let [velocity, deviation, change] = [velocity, deviation, CountsPerTick(change)]
                    .map(|value| value.rad_per_s(&self.scale));
                [velocity, deviation, ratio, change * rate_hz]
            },
        );
        *state = own.map(|state| State(Box::new(state)));
        let column = |index: usize| values.iter().map(|value| value[index]).collect();
        Reports {
            velocity: column(0),
            deviation: deviation.map(|_| column(1)),
            damping_ratio: damping_ratio.map(|_| column(2)),
            acceleration: acceleration.map(|_| column(3)),
        }
    }

    fn start(&self, first: &Sample) -> State {
        State(Box::new(self.estimator.start(first)))
    }

    fn update(&self, state: &mut State, sample: &Sample) -> CountsPerTick {
        match (*state.0).as_any_mut().downcast_mut() {
            Some(state) => self.estimator.update(state, sample),
            // The state is that of another estimator: start as at a first sample.
            None => {
                *state = self.start(sample);
                CountsPerTick(0.0)
            }
        }
    }

    fn acceleration(&self, state: &State) -> Option<CountsPerTickSquared> {
        let acceleration = self.outputs.acceleration?;
        let state = (*state.0).as_any().downcast_ref()?;
        Some(acceleration(&self.estimator, state))
    }
}

/// Erases the type of an estimator that reports only the velocity. A trace takes one dynamic call,
/// not one per tick.
pub(super) fn erased<E>(estimator: E, scale: Scale, over: Over<E>) -> Estimator
where
    E: VelocityEstimator<State: Send + 'static> + Send + Sync + 'static,
{
    with_outputs(estimator, scale, over, Outputs::NONE)
}

/// Erases the type of an estimator that reports the standard deviation.
pub(super) fn confident<E>(estimator: E, scale: Scale, over: Over<E>) -> Estimator
where
    E: Confidence<State: Send + 'static> + Send + Sync + 'static,
{
    with_outputs(estimator, scale, over, Outputs::DEVIATION)
}

/// Erases the type of an estimator that reports the standard deviation and the learned damping.
pub(super) fn learner<E>(
    estimator: E,
    scale: Scale,
    over: Over<E>,
    damping_ratio: DampingRatio<E>,
) -> Estimator
where
    E: Confidence<State: Send + 'static> + Send + Sync + 'static,
{
    let outputs = Outputs {
        damping_ratio: Some(damping_ratio),
        ..Outputs::DEVIATION
    };
    with_outputs(estimator, scale, over, outputs)
}

/// Erases the type of an estimator that reports the standard deviation and the acceleration.
pub(super) fn accelerating<E>(estimator: E, scale: Scale, over: Over<E>) -> Estimator
where
    E: AccelerationEstimator + Confidence<State: Send + 'static> + Send + Sync + 'static,
{
    let outputs = Outputs {
        acceleration: Some(E::acceleration),
        ..Outputs::DEVIATION
    };
    with_outputs(estimator, scale, over, outputs)
}

fn with_outputs<E>(estimator: E, scale: Scale, over: Over<E>, outputs: Outputs<E>) -> Estimator
where
    E: VelocityEstimator<State: Send + 'static> + Send + Sync + 'static,
{
    Estimator(Arc::new(Scaled {
        estimator,
        scale,
        outputs,
        over,
    }))
}
