//! Observer of a coupled motor with friction, with scheduled gains.

mod adaptation;
mod adaptive;
mod bierman;
mod correction;
mod count_update;
mod covariance;
mod design;
mod edge_update;
mod gain;
mod gain_table;
mod innovation;
mod inputs;
mod motion;
mod moving_start;
mod plan;
mod quantised_update;
mod range;
mod sensitivity;
mod uncertainty;

pub use adaptation::{Adaptation, Fixed, ParameterErrors};
pub use adaptive::{Adaptive, AdaptiveState};
pub use correction::Correction;
pub use count_update::CountUpdate;
pub use covariance::Covariance;
pub use design::ObserverDesign;
pub use edge_update::{EdgeUpdate, EdgeUpdateState};
pub use gain::Gain;
pub use inputs::{
    AmplifierCurrent, CoupledEncoder, CurrentSource, HeldShaft, NoCurrent, SlipSource,
};
pub use quantised_update::{QuantisedUpdate, QuantisedUpdateState};
pub use range::{Narrow, Range, Wide};
pub use uncertainty::Uncertainty;

use core::borrow::Borrow;

use crate::design::const_math::limited;
use crate::estimator::VelocityEstimator;
use crate::memory::{Memory, memory};
use crate::sample::{Sample, Signals};
use crate::units::{Count, CountsPerTick};
use innovation::Prediction;
use motion::Motion;
use sensitivity::{Tick, Update};

/// [`Observer`] of counts, current and coupled shaft.
pub type CountObserver = Observer<AmplifierCurrent, CoupledEncoder, CountUpdate, Fixed>;

/// [`CountObserver`] with edge time stamps.
pub type EdgeObserver = Observer<AmplifierCurrent, CoupledEncoder, EdgeUpdate, Fixed>;

/// [`CountObserver`] that also uses a count while the prediction agrees with it
/// (truncated-Gaussian update).
pub type QuantisedObserver = Observer<AmplifierCurrent, CoupledEncoder, QuantisedUpdate, Fixed>;

/// [`CountObserver`] that adapts damping, friction and torque constant.
pub type AdaptiveObserver = Observer<AmplifierCurrent, CoupledEncoder, CountUpdate, Adaptive>;

/// [`QuantisedObserver`] that adapts damping, friction and torque constant.
pub type AdaptiveQuantisedObserver =
    Observer<AmplifierCurrent, CoupledEncoder, QuantisedUpdate, Adaptive>;

/// [`EdgeObserver`] that adapts damping, friction and torque constant.
pub type AdaptiveEdgeObserver = Observer<AmplifierCurrent, CoupledEncoder, EdgeUpdate, Adaptive>;

/// [`CountObserver`] for a device without an encoder on the coupled shaft, with a model that may be
/// wrong by a factor of ten: see [`Wide`].
pub type AdaptiveHeldObserver = Observer<AmplifierCurrent, HeldShaft, CountUpdate, Adaptive<Wide>>;

/// [`AdaptiveHeldObserver`] with edge time stamps.
pub type AdaptiveEdgeHeldObserver =
    Observer<AmplifierCurrent, HeldShaft, EdgeUpdate, Adaptive<Wide>>;

/// Largest innovation that changes the velocity, counts: a larger step of the count is a fault.
const LARGEST_INNOVATION: f32 = 65_536.0;

/// Largest friction correction, in parts of the model's friction.
const LARGEST_FRICTION_ERROR: f32 = 0.5;

/// Observer of `J dω/dt = Kt i - b (ω - ω_S) - friction + disturbance torque`.
///
/// One tick, in counts and ticks, with φ0, φ1, φ2 of `β = b T / J`. x is the position from the
/// middle of the quantisation interval of the newest count.
/// ```text
/// drive       u = (Kt i_mean) s T² / J + β Δ_S + a
/// motion      v' = φ0 v + φ1 (u - f),  x += φ1 v + φ2 (u - f),  f = sign(v) (Tc s T² / J + c)
///             where v' would pass zero, the rotor stops and stays, or leaves again
/// disturbance a *= exp(-T / τ)
/// innovation  x -= counts since the last tick;  e = distance of x to ±1/2, none inside
/// correction  x += e,  v += K_v[n] e,  a += (1 - ρ) K_a[n] e,  c -= ρ K_a[n] e d
/// ```
/// * K\[n\] is the steady gain of a filter that is corrected once every n ticks, where n is the
///   number of ticks since the last correction. It comes from the Riccati recursion at compile time:
///   a row for each n to 64, then for every 32nd, to 961. No covariance is kept at run time.
/// * i_mean is the mean current behind the amplifier's lag, Δ_S the displacement of the coupled
///   shaft, which is the exact integral of its velocity.
/// * a is the disturbance torque, c the friction correction, at most half of the model's friction, and
///   ρ the share of the disturbance that corrects the friction.
/// * d is the mean direction of motion over the last 8 ms, at rest the direction of the drive. An
///   innovation is the result of the recent motion; with the present direction a fast vibration
///   would give a wrong friction correction.
///
/// The type parameters leave out what a device does not measure: the current source C
/// ([`AmplifierCurrent`], [`NoCurrent`]), the slip source S ([`CoupledEncoder`], [`HeldShaft`]), the
/// correction M ([`CountUpdate`], [`QuantisedUpdate`], [`EdgeUpdate`]) and the adaptation L
/// ([`Fixed`], [`Adaptive`] in the range [`Narrow`] or [`Wide`]). An [`ObserverDesign`] constructs an observer of any parts.
///
/// Valid for innovations up to 65536 counts; beyond, the position follows and the velocity is
/// corrected by 65536. A displacement beyond ±2^24 counts/tick is rounded.
///
/// ```
/// use estimator_core::*;
/// const UNCERTAINTY: Uncertainty = Uncertainty {
///     torque_noise: 5e-6,
///     disturbance: 1e-4,
///     disturbance_time: 0.1,
///     friction_share: 0.7,
///     boundary_noise: 0.0625,
/// };
/// const OBSERVER: CountObserver =
///     preset!(Observer::new(&CoupledMotor::DCX35L, Hertz(1000.0), &UNCERTAINTY));
/// let first = Sample::new(Count(0));
/// let mut state = OBSERVER.start(&first);
/// // 80 mA give 3.7 mN·m, less than the friction of 4 mN·m: the rotor stays.
/// assert_eq!(OBSERVER.update(&mut state, &first.with_current(Amps::new(0.08))).0, 0.0);
/// // 0.5 A accelerate it: the velocity changes before the first count does.
/// assert!(OBSERVER.update(&mut state, &first.with_current(Amps::new(0.5))).0 > 0.9);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(C)]
pub struct Observer<C, S, M, L> {
    motion: Motion,
    current: C,
    slip: S,
    correction: M,
    adaptation: L,
    disturbance_decay: f32,
    direction_pole: f32,
    friction_share: f32,
}

memory!([C: Memory, S: Memory, M: Memory, L: Memory] Observer<C, S, M, L> { motion, current, slip, correction, adaptation, disturbance_decay, direction_pole, friction_share });

/// State of an [`Observer`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ObserverState<C, S, M, L> {
    anchor: Count,
    position: f32,
    velocity: f32,
    /// Disturbance torque and friction correction, counts/tick².
    disturbance: f32,
    friction_correction: f32,
    /// Recent mean of the direction that friction acts against, -1 to 1.
    mean_direction: f32,
    current: C,
    slip: S,
    correction: M,
    adaptation: L,
}

impl<C, S, M, L> ObserverState<C, S, M, L> {
    /// State of the correction.
    #[must_use]
    pub const fn correction(&self) -> &M {
        &self.correction
    }

    /// State of the adaptation.
    #[must_use]
    pub const fn adaptation(&self) -> &L {
        &self.adaptation
    }
}

impl<C, S, M, L: Adaptation> Observer<C, S, M, L> {
    /// The relative parameter errors estimated so far; zero without adaptation.
    #[must_use]
    pub fn parameter_errors<A, B, D>(
        &self,
        state: &ObserverState<A, B, D, L::State>,
    ) -> ParameterErrors {
        self.adaptation.parameter_errors(&state.adaptation)
    }
}

impl<C, S, M: Correction, L: Adaptation> Observer<C, S, M, L> {
    /// Variance of the velocity, including that due to the uncertainty of the parameters.
    pub(crate) fn velocity_variance<A, B>(
        &self,
        state: &ObserverState<A, B, M::State, L::State>,
    ) -> f32 {
        let known = self.correction.velocity_variance(&state.correction);
        known + self.adaptation.velocity_variance(&state.adaptation)
    }
}

impl<C, S, M, L> VelocityEstimator for Observer<C, S, M, L>
where
    C: CurrentSource,
    S: SlipSource,
    M: Correction,
    L: Adaptation,
{
    type State = ObserverState<C::State, S::State, M::State, L::State>;
    const NEEDS: Signals = C::NEEDS.or(S::NEEDS).or(M::NEEDS);

    fn start(&self, first: &Sample) -> Self::State {
        ObserverState {
            anchor: first.count,
            position: 0.0,
            velocity: 0.0,
            disturbance: 0.0,
            friction_correction: 0.0,
            mean_direction: 0.0,
            current: self.current.start(first),
            slip: self.slip.start(first),
            correction: self.correction.start(),
            adaptation: self.adaptation.start(),
        }
    }

    #[inline(always)]
    fn update(&self, state: &mut Self::State, sample: &Sample) -> CountsPerTick {
        CountsPerTick(self.advance(state, sample).velocity)
    }
}

/// Velocities of an observer at one tick, counts/tick.
pub(crate) struct Advance {
    /// After the correction.
    pub(crate) velocity: f32,
    /// Change over the tick before the correction.
    pub(crate) predicted_change: f32,
}

impl<C, S, M, L> Observer<C, S, M, L>
where
    C: CurrentSource,
    S: SlipSource,
    M: Correction,
    L: Adaptation,
{
    /// Advances the state by one tick.
    #[inline(always)]
    pub(crate) fn advance(
        &self,
        state: &mut <Self as VelocityEstimator>::State,
        sample: &Sample,
    ) -> Advance {
        let input = self.current.input(&mut state.current, sample);
        let coupled = self.slip.displacement(&mut state.slip, sample);
        let before = state.velocity;
        let driven = self
            .adaptation
            .drive(&state.adaptation, &self.motion, input, coupled, before);
        let friction = self.adaptation.friction(
            &state.adaptation,
            &self.motion,
            state.friction_correction,
            before,
        );
        let drive = driven.mean + state.disturbance;
        let step = self.motion.step(before, drive, friction);
        let sensitivity = self.adaptation.propagate(
            &state.adaptation,
            &Tick {
                motion: &self.motion,
                input,
                coupled,
                before,
                step: &step,
                disturbance_decay: self.disturbance_decay,
            },
        );
        let disturbance = state.disturbance * self.disturbance_decay;
        let direction = step.against + self.direction_pole * (state.mean_direction - step.against);
        state.mean_direction = direction;

        let counts = (sample.count - state.anchor).to_f32();
        state.anchor = sample.count;
        let prediction = Prediction {
            from: state.position - counts,
            displacement: step.moved - driven.lag,
            velocity_change: step.velocity - before,
            stuck: step.stuck,
        };
        let position = prediction.from + prediction.displacement;
        let found = self
            .correction
            .innovation(&mut state.correction, prediction, sample);
        let Some((innovation, gain)) = found else {
            state.position = position;
            state.velocity = step.velocity;
            state.disturbance = disturbance;
            self.adaptation.store(&mut state.adaptation, sensitivity);
            return Advance {
                velocity: step.velocity,
                predicted_change: step.velocity - before,
            };
        };
        let gain = gain.borrow();
        let unexplained = self.adaptation.unexplained(
            &mut state.adaptation,
            &innovation,
            gain,
            step.velocity,
            M::DENSE,
        );
        let gain = unexplained.as_ref().unwrap_or(gain);
        let error = limited(innovation.error, LARGEST_INNOVATION);
        // The age is zero without time stamps: then the compiler drops it.
        let position_gain = innovation.position_gain + innovation.age * gain.velocity;
        let mut position = position + position_gain * innovation.error;
        let mut velocity = step.velocity + gain.velocity * error;
        let change = gain.disturbance * error;
        let friction_change = self.friction_share * change;
        let mut disturbance = disturbance + change - friction_change;
        let limit = LARGEST_FRICTION_ERROR * self.motion.friction;
        state.friction_correction = limited(
            state.friction_correction - friction_change * direction,
            limit,
        );
        let update = Update {
            innovation: &innovation,
            gain,
            error,
            dense: M::DENSE,
            unexplained: unexplained.is_some(),
            position_gain,
            velocity,
        };
        let change = self
            .adaptation
            .update(&mut state.adaptation, sensitivity, &update);
        if let Some(change) = change {
            position += change.position;
            velocity += change.velocity;
            disturbance += change.disturbance;
        }
        state.position = position;
        state.velocity = velocity;
        state.disturbance = disturbance;
        Advance {
            velocity,
            predicted_change: step.velocity - before,
        }
    }
}
