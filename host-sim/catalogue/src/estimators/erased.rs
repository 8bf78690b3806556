//! Estimators of any type behind one.

use std::any::Any;
use std::sync::Arc;

use estimator_core::{
    AccelerationEstimator, Confidence, CountsPerTick, CountsPerTickSquared, Sample, Scale, Signals,
    VelocityEstimator,
};

use super::run::{run, velocities};
use simulation::trace::Trace;

/// An estimator with its parameters, whatever its type.
#[derive(Clone)]
pub struct Estimator(Arc<dyn Erased>);

impl Estimator {
    /// Velocity at each tick of a trace, rad/s. The first tick only starts the estimator and
    /// reads zero.
    #[must_use]
    pub fn run(&self, trace: &Trace) -> Vec<f32> {
        self.0.run(trace)
    }

    /// The same, and the standard deviation that the estimator itself believes its velocity to
    /// have, rad/s; `None` from one that believes nothing.
    #[must_use]
    pub fn run_confident(&self, trace: &Trace) -> (Vec<f32>, Option<Vec<f32>>) {
        self.0.run_confident(trace)
    }

    /// The coupler's damping at each tick of a trace over what is believed, as the estimator
    /// learns it; `None` from one that does not.
    #[must_use]
    pub fn damping_ratio(&self, trace: &Trace) -> Option<Vec<f32>> {
        self.0.damping_ratio(trace)
    }
}

/// A tick at a time: the type that a control loop takes.
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
    /// Whether its model has an acceleration.
    #[must_use]
    pub fn gives_acceleration(&self) -> bool {
        let state = self.start(&Sample::default());
        self.0.acceleration(&state).is_some()
    }
}

/// Zero where [`Estimator::gives_acceleration`] says no.
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
}

trait Erased: Send + Sync {
    fn run(&self, trace: &Trace) -> Vec<f32>;
    fn run_confident(&self, trace: &Trace) -> (Vec<f32>, Option<Vec<f32>>);
    fn damping_ratio(&self, trace: &Trace) -> Option<Vec<f32>>;
    fn start(&self, first: &Sample) -> State;
    fn update(&self, state: &mut State, sample: &Sample) -> CountsPerTick;
    fn acceleration(&self, state: &State) -> Option<CountsPerTickSquared>;
}

/// An estimator with what its counts are worth.
struct Scaled<E: VelocityEstimator> {
    estimator: E,
    scale: Scale,
    says: Says<E>,
}

/// What a state tells beside the velocity.
type Tells<E, T> = fn(&E, &<E as VelocityEstimator>::State) -> T;

/// What it says of the damping.
pub(super) type DampingRatio<E> = Tells<E, f32>;

/// All that an estimator may tell beside the velocity.
struct Says<E: VelocityEstimator> {
    /// What it believes of its own error.
    deviation: Option<Tells<E, CountsPerTick>>,
    damping_ratio: Option<DampingRatio<E>>,
    acceleration: Option<Tells<E, CountsPerTickSquared>>,
}

impl<E: VelocityEstimator> Says<E> {
    const NOTHING: Self = Self {
        deviation: None,
        damping_ratio: None,
        acceleration: None,
    };
}

impl<E: Confidence> Says<E> {
    const DEVIATION: Self = Self {
        deviation: Some(|estimator, state| estimator.variance(state).std_dev()),
        ..Self::NOTHING
    };
}

impl<E> Erased for Scaled<E>
where
    E: VelocityEstimator<State: Send + 'static> + Send + Sync,
{
    fn run(&self, trace: &Trace) -> Vec<f32> {
        velocities(&self.estimator, trace, &self.scale)
    }

    fn run_confident(&self, trace: &Trace) -> (Vec<f32>, Option<Vec<f32>>) {
        let Some(deviation) = self.says.deviation else {
            return (self.run(trace), None);
        };
        let both = run(&self.estimator, trace, [0.0; 2], |state, velocity| {
            [velocity, deviation(&self.estimator, state)].map(|v| v.rad_per_s(&self.scale))
        });
        let (velocity, deviation) = both.into_iter().map(<(f32, f32)>::from).unzip();
        (velocity, Some(deviation))
    }

    fn damping_ratio(&self, trace: &Trace) -> Option<Vec<f32>> {
        let damping_ratio = self.says.damping_ratio?;
        Some(run(&self.estimator, trace, 1.0, |state, _| {
            damping_ratio(&self.estimator, state)
        }))
    }

    fn start(&self, first: &Sample) -> State {
        State(Box::new(self.estimator.start(first)))
    }

    fn update(&self, state: &mut State, sample: &Sample) -> CountsPerTick {
        match (*state.0).as_any_mut().downcast_mut() {
            Some(state) => self.estimator.update(state, sample),
            // The state of another estimator: begin anew, as at a first sample.
            None => {
                *state = self.start(sample);
                CountsPerTick(0.0)
            }
        }
    }

    fn acceleration(&self, state: &State) -> Option<CountsPerTickSquared> {
        let acceleration = self.says.acceleration?;
        let state = (*state.0).as_any().downcast_ref()?;
        Some(acceleration(&self.estimator, state))
    }
}

/// Forgets an estimator's type; a trace still runs with one dynamic call, not one a tick.
pub(super) fn erased<E>(estimator: E, scale: Scale) -> Estimator
where
    E: VelocityEstimator<State: Send + 'static> + Send + Sync + 'static,
{
    saying(estimator, scale, Says::NOTHING)
}

/// The same for one that says how far off it may be.
pub(super) fn confident<E>(estimator: E, scale: Scale) -> Estimator
where
    E: Confidence<State: Send + 'static> + Send + Sync + 'static,
{
    saying(estimator, scale, Says::DEVIATION)
}

/// The same for one that learns the coupler's damping.
pub(super) fn learner<E>(estimator: E, scale: Scale, damping_ratio: DampingRatio<E>) -> Estimator
where
    E: Confidence<State: Send + 'static> + Send + Sync + 'static,
{
    let says = Says {
        damping_ratio: Some(damping_ratio),
        ..Says::DEVIATION
    };
    saying(estimator, scale, says)
}

/// The same for one whose model has an acceleration.
pub(super) fn accelerating<E>(estimator: E, scale: Scale) -> Estimator
where
    E: AccelerationEstimator + Confidence<State: Send + 'static> + Send + Sync + 'static,
{
    let says = Says {
        acceleration: Some(E::acceleration),
        ..Says::DEVIATION
    };
    saying(estimator, scale, says)
}

fn saying<E>(estimator: E, scale: Scale, says: Says<E>) -> Estimator
where
    E: VelocityEstimator<State: Send + 'static> + Send + Sync + 'static,
{
    Estimator(Arc::new(Scaled {
        estimator,
        scale,
        says,
    }))
}
