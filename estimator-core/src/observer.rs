//! Observer of a motor with known current, coupler and friction, with scheduled gains.

mod bell;
mod bierman;
mod correction;
mod dependence;
mod design;
mod inputs;
mod learned;
mod learning;
mod motion;
mod soft_cells;
mod table;

pub use bell::Bell;
pub use correction::{Cells, Correction, Edges, EdgesState};
pub use design::{Gain, Uncertainty};
pub use inputs::{
    AmplifierCurrent, CurrentSource, HeldHandle, NoCurrent, SlipSource, SmallEncoder,
};
pub use learned::{Learned, LearnedState};
pub use learning::{Deviations, Fixed, Learning};
pub use soft_cells::{SoftCells, SoftCellsState};

use core::borrow::Borrow;

use crate::const_math::limited;
use crate::estimator::VelocityEstimator;
use crate::sample::{Sample, Signals};
use crate::units::{Count, CountsPerTick};
use correction::Path;
use dependence::{Lesson, Tick};
use motion::Motion;

/// [`Observer`] of counts, current and slip.
pub type CountObserver = Observer<AmplifierCurrent, SmallEncoder, Cells, Fixed>;

/// [`CountObserver`] with edge time stamps.
pub type EdgeObserver = Observer<AmplifierCurrent, SmallEncoder, Edges, Fixed>;

/// [`CountObserver`] that hears counts inside their cell too.
pub type SoftObserver = Observer<AmplifierCurrent, SmallEncoder, SoftCells, Fixed>;

/// [`CountObserver`] that learns damping, friction and torque constant.
pub type AdaptiveObserver = Observer<AmplifierCurrent, SmallEncoder, Cells, Learned>;

/// [`AdaptiveObserver`] that hears counts inside their cell too.
pub type AdaptiveSoftObserver = Observer<AmplifierCurrent, SmallEncoder, SoftCells, Learned>;

/// [`AdaptiveObserver`] with edge time stamps.
pub type AdaptiveEdgeObserver = Observer<AmplifierCurrent, SmallEncoder, Edges, Learned>;

/// Largest innovation that moves the velocity, counts: a count that jumps further is wrong.
const LARGEST_INNOVATION: f32 = 65_536.0;

/// Largest part of the friction believed in that an unknown torque may add or take.
const LARGEST_FRICTION_ERROR: f32 = 0.5;

/// Observer of `J dω/dt = Kt i - b (ω - ω_S) - friction + unknown torque`.
///
/// One tick, in counts and ticks (φ0, φ1, φ2 of `β = b T / J`; x from the middle of the newest
/// count's cell):
/// ```text
/// drive      u = (Kt i_mean) s T² / J + β Δ_S + a
/// motion     v' = φ0 v + φ1 (u - f),  x += φ1 v + φ2 (u - f),  f = sign(v) (Tc s T² / J + c)
///            where v' would pass zero, the rotor stops and stays, or leaves again ([motion])
/// unknown    a *= exp(-T / τ)
/// cells      x -= counts since the last tick;  e = what x is outside ±1/2;  none: keep all
/// correction x += e,  v += K_v[n] e,  a += (1 - ρ) K_a[n] e,  c -= ρ K_a[n] e d
/// ```
/// n is the number of ticks since the last correction, and K\[n\] the steady gain of the filter
/// that is corrected once every n ticks, from the Riccati recursion, at compile time: a row for each
/// n to 64, then for every 32nd, to 961. So there is no covariance at run time and nothing that could
/// lose its definiteness. i_mean is the current behind the amplifier's lag, Δ_S the handle's
/// displacement (an exact integral of its velocity), ρ the share of the unknown torque that is taken
/// for friction, d the mean direction of the last 8 ms (at rest, that of the drive), because an
/// innovation is what went wrong over some time: the direction of the moment would make a fast
/// vibration teach a wrong friction. c is within half of the friction believed in.
///
/// What a device lacks is left out by type: [`held`](Self::held) without the small encoder,
/// [`blind`](Self::blind) without current; [`with_edges`](Self::with_edges) adds time stamps,
/// [`soft`](Self::soft) hears counts inside their cell too, by a covariance instead of the table
/// ([`SoftCells`]), [`learning`](Self::learning) learns the parameters.
///
/// Valid for innovations up to 65536 counts; beyond, the position follows and the velocity takes
/// 65536. A displacement beyond ±2^24 counts a tick is rounded.
///
/// ```
/// use estimator_core::*;
/// const UNSURE: Uncertainty = Uncertainty {
///     torque_noise: 5e-6, load: 1e-4, load_time: 0.1, friction_share: 0.7, boundary_noise: 0.0625,
/// };
/// const OBSERVER: CountObserver =
///     preset!(Observer::new(&CoupledMotor::DCX35L, Hertz(1000.0), &UNSURE));
/// let first = Sample::new(Count(0));
/// let mut state = OBSERVER.start(&first);
/// // 80 mA are 3.7 mN·m: below the 4 mN·m of friction, so nothing moves.
/// assert_eq!(OBSERVER.update(&mut state, &first.with_current(Amps::new(0.08))).0, 0.0);
/// // At 0.5 A it knows at once that it does, before the first count.
/// assert!(OBSERVER.update(&mut state, &first.with_current(Amps::new(0.5))).0 > 0.9);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Observer<C, S, M, L> {
    motion: Motion,
    current: C,
    slip: S,
    correction: M,
    learning: L,
    load_decay: f32,
    way_pole: f32,
    friction_share: f32,
}

/// State of an [`Observer`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ObserverState<C, S, M, L> {
    anchor: Count,
    position: f32,
    velocity: f32,
    /// Unknown torque, counts a tick²: what pushes, and what rubs.
    load: f32,
    rub: f32,
    /// Recent mean of what friction acts against, -1 to 1.
    way: f32,
    current: C,
    slip: S,
    correction: M,
    learning: L,
}

impl<C, S, M, L> ObserverState<C, S, M, L> {
    /// What is carried of the corrections.
    #[must_use]
    pub const fn correction(&self) -> &M {
        &self.correction
    }

    /// What is carried of the parameters.
    #[must_use]
    pub const fn learning(&self) -> &L {
        &self.learning
    }
}

impl<C, S, M, L: Learning> Observer<C, S, M, L> {
    /// What the observer has learned of its parameters.
    #[must_use]
    pub fn deviations<A, B, D>(&self, state: &ObserverState<A, B, D, L::State>) -> Deviations {
        self.learning.deviations(&state.learning)
    }
}

impl<C, S, M: Correction, L: Learning> Observer<C, S, M, L> {
    /// Variance of the velocity, by what is not known of the parameters too.
    pub(crate) fn velocity_variance<A, B>(
        &self,
        state: &ObserverState<A, B, M::State, L::State>,
    ) -> f32 {
        let known = self.correction.velocity_variance(&state.correction);
        known + self.learning.velocity_variance(&state.learning)
    }
}

impl<C, S, M, L> VelocityEstimator for Observer<C, S, M, L>
where
    C: CurrentSource,
    S: SlipSource,
    M: Correction,
    L: Learning,
{
    type State = ObserverState<C::State, S::State, M::State, L::State>;
    type Output = CountsPerTick;
    const NEEDS: Signals = C::NEEDS.or(S::NEEDS).or(M::NEEDS);

    fn start(&self, first: &Sample) -> Self::State {
        ObserverState {
            anchor: first.large,
            position: 0.0,
            velocity: 0.0,
            load: 0.0,
            rub: 0.0,
            way: 0.0,
            current: self.current.start(first),
            slip: self.slip.start(first),
            correction: self.correction.start(),
            learning: self.learning.start(),
        }
    }

    #[inline(always)]
    fn update(&self, state: &mut Self::State, sample: &Sample) -> CountsPerTick {
        let push = self.current.push(&mut state.current, sample);
        let handle = self.slip.moved(&mut state.slip, sample);
        let before = state.velocity;
        let driven = self
            .learning
            .drive(&state.learning, &self.motion, push, handle, before);
        let friction = self.learning.friction(&state.learning, &self.motion) + state.rub;
        let drive = driven.mean + state.load;
        let step = self.motion.step(before, drive, friction);
        let dependence = self.learning.follow(
            &state.learning,
            &Tick {
                motion: &self.motion,
                push,
                handle,
                before,
                step: &step,
                load_decay: self.load_decay,
            },
        );
        let load = state.load * self.load_decay;
        let way = step.against + self.way_pole * (state.way - step.against);
        state.way = way;

        let counts = (sample.large - state.anchor).to_f32();
        state.anchor = sample.large;
        let path = Path {
            from: state.position - counts,
            lead: step.moved - driven.behind,
            gained: step.velocity - before,
            rests: step.stuck,
        };
        let position = path.from + path.lead;
        let found = self
            .correction
            .innovation(&mut state.correction, path, sample);
        let Some((innovation, gain)) = found else {
            state.position = position;
            state.velocity = step.velocity;
            state.load = load;
            self.learning.keep(&mut state.learning, dependence);
            return CountsPerTick(step.velocity);
        };
        let gain = gain.borrow();
        let starting =
            self.learning
                .starting(&mut state.learning, &innovation, gain, step.velocity);
        let gain = starting.as_ref().unwrap_or(gain);
        let error = limited(innovation.error, LARGEST_INNOVATION);
        // The age is zero without time stamps: then the compiler drops it.
        let carried = innovation.position + innovation.age * gain.velocity;
        let mut position = position + carried * innovation.error;
        let mut velocity = step.velocity + gain.velocity * error;
        let unknown = gain.load * error;
        let rubbing = self.friction_share * unknown;
        let mut load = load + unknown - rubbing;
        let limit = LARGEST_FRICTION_ERROR * self.motion.friction;
        state.rub = limited(state.rub - rubbing * way, limit);
        let lesson = Lesson {
            innovation: &innovation,
            gain,
            error,
            dense: M::DENSE,
            starting: starting.is_some(),
            position: carried,
            velocity,
        };
        let shift = self
            .learning
            .learn(&mut state.learning, dependence, &lesson);
        if let Some(shift) = shift {
            position += shift.position;
            velocity += shift.velocity;
            load += shift.load;
        }
        state.position = position;
        state.velocity = velocity;
        state.load = load;
        CountsPerTick(velocity)
    }
}
