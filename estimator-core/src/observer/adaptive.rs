//! Adaptation of damping, friction and torque constant while the motor runs.

use super::adaptation::{Adaptation, ParameterErrors, StateChange};
use super::bierman::bierman;
use super::gain::Gain;
use super::innovation::Innovation;
use super::inputs::TickInput;
use super::motion::Motion;
use super::moving_start::MovingStart;
use super::range::{Narrow, Range};
use super::sensitivity::{Sensitivity, Tick, Update};
use crate::branch::unlikely;
use crate::memory::{Memory, memory};
use crate::models::linear::counts_per_rad;
use crate::sealed::Sealed;
use crate::units::Hertz;

/// Adaptation of damping, friction and torque constant per inertia by the observer's innovations.
///
/// A relative parameter error p causes errors of position x, velocity v and disturbance a in
/// proportion to a sensitivity s = (s_x, s_v, s_a), which propagates through the observer as these
/// errors do (Friedland 1969):
/// ```text
/// each tick      φ = -β (mean v - v_S), -direction . friction, input    for b, Tc, Kt
///                s_x += φ1 s_v + φ2 (φ + s_a)    s_v = φ0 s_v + φ1 (φ + s_a)    s_a *= decay
/// stuck          s_x += φ1 s_v / 2               s_v = 0
/// innovation e   h = s_x                         s -= K h
///                p = U D Uᵀ                      p += k e, k = P h / (hᵀ P h + c S)
/// ```
/// S is the variance of the innovation without parameter errors. c = 8, because innovations of counts
/// and of a torque that is not quite white are correlated. Edges come as often as the rate is high
/// and are more strongly correlated: the parameters are updated by one edge in 3.5 ms, with c = 2.
///
/// The 3 × 3 covariance P is kept as U (unit upper triangular) and D (diagonal) and updated after
/// Bierman: every new element of D is an old one times a ratio of positive sums, so rounding cannot
/// make P indefinite. Edges that contradict the counts can make s grow without limit. Where
/// hᵀ P h + c S is above 65536², the square of the observer's range, the parameters stay and s
/// restarts at zero, so D cannot underflow. The standard deviations at the start and the limits of the
/// parameter errors are those of the range R, [`Narrow`] or [`Wide`](super::Wide). Each update
/// adds to each variance 0.1² of that at the start for a second since the update before, whether the motor moved or
/// rested meanwhile; no variance exceeds that at the start. Below 0.5 rad/s friction hides the other parameters, and all
/// stay.
///
/// In the range [`Wide`](super::Wide) the model can be unlike the device. Three more rules hold there:
/// ```text
/// each tick      |v| < 0.5 rad/s: friction below 0 is 0
/// innovation e   k = P h / (hᵀ P h + c S + e² / 4)
/// with stamps    e² > 16 S: K_v = max(K_v, 1 / max(1, n)), n ticks after the last innovation
/// ```
/// A friction below zero is the push of a hand in motion, and would be a drive at rest. The variance of an
/// innovation is that of heavy tails (Student's t): a few large ones turn neither p nor P. Where one is beyond
/// four standard deviations, the velocity becomes the mean since the last one.
///
/// If the motor is already moving at start-up, the first innovations are not attributed to parameter
/// errors: the velocity gain is then that of the mean since the start, and p, U and D stay.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(C)]
pub struct Adaptive<R = Narrow> {
    /// Range of the parameter errors.
    range: R,
    /// Velocity below which the parameters stay, counts/tick.
    slowest: f32,
    /// Growth of each element of D in a tick.
    walk: [f32; 3],
    /// [`SPACING`] in ticks.
    spacing: f32,
}

memory!([R: Memory] Adaptive<R> { range, slowest, walk, spacing });

/// State of [`Adaptive`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AdaptiveState {
    parameters: [f32; 3],
    /// Sensitivity to each parameter.
    sensitivity: [Sensitivity; 3],
    /// U: elements 01, 02 and 12.
    upper: [f32; 3],
    diagonal: [f32; 3],
    /// Ticks since D last grew.
    waiting: f32,
    start: MovingStart,
}

impl AdaptiveState {
    /// D: the variance of each parameter given the parameters after it.
    #[must_use]
    pub const fn diagonal(&self) -> &[f32; 3] {
        &self.diagonal
    }

    /// Elements 01, 02 and 12 of U.
    #[must_use]
    pub const fn upper(&self) -> &[f32; 3] {
        &self.upper
    }
}

/// Standard deviation of the random walk of a parameter in a second, rest included, in parts of [`Range::PRIOR`].
const WALK: f64 = 0.1;

/// Largest relative error of the damping that does not indicate a moving start.
const EXPLAINED: f32 = 0.6;

/// Square of the largest innovation that a model in the range [`Wide`](super::Wide) explains, in
/// parts of its variance.
const OUTLIER: f32 = 16.0;

/// Part of an innovation's square that is added to its variance in the range [`Wide`](super::Wide).
const SURPRISE: f32 = 0.25;

/// Velocity below which the parameters stay, rad/s.
const SLOWEST: f64 = 0.5;

/// Factor c of an innovation's variance: innovations of counts and of a torque that is not quite
/// white are correlated.
const CAUTION: f32 = 8.0;

/// Time between two updates of the parameters where every tick may have an innovation, s: the
/// innovations between them are strongly correlated.
const SPACING: f64 = 3.5e-3;

/// [`CAUTION`] for innovations that are [`SPACING`] apart.
const DENSE_CAUTION: f32 = 2.0;

impl<R: Range> Adaptive<R> {
    /// The adaptation for an encoder of `counts_per_rev` at this control rate; both are above 0.
    pub(super) const fn new(range: R, counts_per_rev: u32, rate: Hertz) -> Self {
        let per_rad = counts_per_rad(counts_per_rev);
        let mut walk = [0.0; 3];
        let mut i = 0;
        while i < 3 {
            let step = WALK * R::PRIOR[i] as f64;
            walk[i] = (step * step / rate.0) as f32;
            i += 1;
        }
        Self {
            range,
            slowest: (SLOWEST * per_rad / rate.0) as f32,
            walk,
            spacing: (SPACING * rate.0) as f32,
        }
    }
}

impl<R> Sealed for Adaptive<R> {}

impl<R: Range> Adaptation for Adaptive<R> {
    type State = AdaptiveState;
    /// Sensitivity to each parameter.
    type Sensitivity = [Sensitivity; 3];

    fn start(&self) -> AdaptiveState {
        AdaptiveState {
            parameters: [0.0; 3],
            sensitivity: [Sensitivity::default(); 3],
            upper: [0.0; 3],
            diagonal: R::PRIOR.map(|std_dev| std_dev * std_dev),
            waiting: 0.0,
            start: MovingStart::new(),
        }
    }

    fn parameter_errors(&self, state: &AdaptiveState) -> ParameterErrors {
        let [damping, friction, torque_constant] = state.parameters;
        ParameterErrors {
            damping,
            friction,
            torque_constant,
        }
    }

    /// `s_vᵀ U D Uᵀ s_v`.
    fn velocity_variance(&self, state: &AdaptiveState) -> f32 {
        let [a, b, c] = state.sensitivity.map(|s| s.velocity);
        let [u01, u02, u12] = state.upper;
        let y = [a, u01 * a + b, u02 * a + u12 * b + c];
        let [d0, d1, d2] = state.diagonal;
        d0 * y[0] * y[0] + d1 * y[1] * y[1] + d2 * y[2] * y[2]
    }

    #[inline(always)]
    fn drive(
        &self,
        state: &AdaptiveState,
        motion: &Motion,
        input: TickInput,
        coupled: f32,
        velocity: f32,
    ) -> TickInput {
        let [damping, _, torque_constant] = state.parameters;
        let slip = coupled + damping * (coupled - velocity);
        TickInput {
            mean: input.mean + torque_constant * input.mean + motion.coupling * slip,
            lag: input.lag + torque_constant * input.lag,
        }
    }

    #[inline(always)]
    fn friction(
        &self,
        state: &AdaptiveState,
        motion: &Motion,
        correction: f32,
        velocity: f32,
    ) -> f32 {
        let learned = motion.friction + state.parameters[1] * self.range.friction(motion);
        let friction = learned + correction;
        // In motion a friction below zero is that of a hand that pushes. At rest it would be a drive.
        if R::LARGE && friction < 0.0 && velocity.abs() < self.slowest {
            0.0
        } else {
            friction
        }
    }

    #[inline(always)]
    fn unexplained(
        &self,
        state: &mut AdaptiveState,
        innovation: &Innovation,
        gain: &Gain,
        velocity: f32,
        dense: bool,
    ) -> Option<Gain> {
        let start = state.start.gain(innovation, gain, velocity, EXPLAINED);
        if !(R::LARGE && dense) || start.is_some() {
            return start;
        }
        let beyond = innovation.error * innovation.error > OUTLIER * gain.variance;
        let waited = innovation.waited;
        let mean = if waited > 1.0 { 1.0 / waited } else { 1.0 };
        (beyond && mean > gain.velocity).then_some(Gain {
            velocity: mean,
            ..*gain
        })
    }

    #[inline(always)]
    fn propagate(&self, state: &AdaptiveState, tick: &Tick<'_>) -> [Sensitivity; 3] {
        let Tick { motion, step, .. } = tick;
        let mean = 0.5 * (tick.before + step.velocity);
        let regressors = [
            motion.coupling * (tick.coupled - mean),
            -step.direction * self.range.friction(motion),
            tick.input.mean,
        ];
        let rests = step.stuck && !(R::LARGE && tick.before != 0.0);
        let propagated = |i: usize| {
            let sensitivity = state.sensitivity[i];
            let regressor = if R::LARGE {
                let damping = motion.coupling * state.parameters[0];
                regressors[i] - damping * sensitivity.velocity
            } else {
                regressors[i]
            };
            sensitivity.propagated(regressor, rests, tick)
        };
        [propagated(0), propagated(1), propagated(2)]
    }

    #[inline(always)]
    fn store(&self, state: &mut AdaptiveState, sensitivity: [Sensitivity; 3]) {
        state.sensitivity = sensitivity;
    }

    #[inline(always)]
    fn update(
        &self,
        state: &mut AdaptiveState,
        sensitivity: [Sensitivity; 3],
        update: &Update<'_>,
    ) -> Option<StateChange> {
        let Update {
            innovation, gain, ..
        } = update;
        let h = [
            sensitivity[0].at_edge(innovation),
            sensitivity[1].at_edge(innovation),
            sensitivity[2].at_edge(innovation),
        ];
        let after = [
            sensitivity[0].corrected(update, h[0]),
            sensitivity[1].corrected(update, h[1]),
            sensitivity[2].corrected(update, h[2]),
        ];
        state.sensitivity = after;
        let gap = if R::LARGE {
            innovation.waited
        } else {
            innovation.gap
        };
        let waiting = state.waiting + gap;
        state.waiting = waiting;
        // In the narrow range nothing but a start is unexplained, and the flag is at hand.
        let starting = if R::LARGE {
            state.start.is_moving()
        } else {
            update.unexplained
        };
        let early = update.dense && waiting < self.spacing;
        let slow = update.velocity.abs() < self.slowest;
        if starting || gap == 0.0 || early || slow {
            return None;
        }
        state.waiting = 0.0;
        let grown = |i: usize| {
            let grown = state.diagonal[i] + self.walk[i] * waiting;
            let prior = R::PRIOR[i] * R::PRIOR[i];
            if grown < prior { grown } else { prior }
        };
        let caution = if update.dense { DENSE_CAUTION } else { CAUTION };
        let mut diagonal = [grown(0), grown(1), grown(2)];
        let caution = caution * gain.variance;
        let r = if R::LARGE {
            caution + SURPRISE * update.error * update.error
        } else {
            caution
        };
        let Some(k) = bierman(&mut state.upper, &mut diagonal, h, r) else {
            unlikely();
            // A loop would clear a known zero or an array, and the bound on the instructions of an
            // update cannot bound that loop.
            let zero = core::hint::black_box(0.0);
            let none = Sensitivity {
                position: zero,
                velocity: zero,
                disturbance: zero,
            };
            let [damping, friction, torque_constant] = &mut state.sensitivity;
            (*damping, *friction, *torque_constant) = (none, none, none);
            return None;
        };
        state.diagonal = diagonal;
        let mut change = |i: usize| {
            let before = state.parameters[i];
            state.parameters[i] = self.range.limited(i, before + k[i] * update.error);
            state.parameters[i] - before
        };
        let change = [change(0), change(1), change(2)];
        let sum = |of: fn(&Sensitivity) -> f32| {
            of(&after[0]) * change[0] + of(&after[1]) * change[1] + of(&after[2]) * change[2]
        };
        Some(StateChange {
            position: sum(|s| s.position),
            velocity: sum(|s| s.velocity),
            disturbance: sum(|s| s.disturbance),
        })
    }
}
