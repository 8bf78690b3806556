//! Damping, friction and torque constant, learned while the motor runs.

use super::bierman::bierman;
use super::correction::Innovation;
use super::dependence::{Dependence, Lesson, Tick};
use super::design::Gain;
use super::inputs::Push;
use super::learning::{Deviations, Learning, Shift};
use super::motion::Motion;
use crate::branch::unlikely;
use crate::const_math::limited;
use crate::design_error::DesignError;
use crate::units::Hertz;

/// Damping, friction and torque constant per inertia, learned from the observer's innovations.
///
/// A parameter that is off shows in position x, velocity v and unknown torque a, in proportion to
/// a sensitivity s = (s_x, s_v, s_a) that goes through the observer as they do (Friedland 1969):
/// ```text
/// each tick      φ = -β (mean v - v_S), -direction . friction, push     for b, Tc, Kt
///                s_x += φ1 s_v + φ2 (φ + s_a)    s_v = φ0 s_v + φ1 (φ + s_a)    s_a *= decay
/// stuck          s_x += φ1 s_v / 2               s_v = 0
/// innovation e   h = s_x                         s -= K h
///                p = U D Uᵀ                      p += k e, k = P h / (hᵀ P h + c S)
/// ```
/// S is the variance of the innovation without errors of parameters, c = 8 because innovations of
/// a dead zone and of a torque that is not quite white are not independent. Edges come as often as
/// the rate is high and say much the same: from one in 3.5 ms the parameters are learned, with
/// c = 2. The 3 × 3 covariance is kept
/// as U (unit upper triangular) and D (diagonal) and updated after Bierman: every new D is an old
/// one times a ratio of positive sums, so it cannot lose its definiteness by rounding. Edges that
/// contradict the counts can make s grow without limit: where hᵀ P h + c S is above 65536², the
/// observer's range, nothing is learned and s begins at zero again, so D cannot underflow. P
/// starts at 35, 60 and 35 %, walks by a tenth of that in a second of motion, and never exceeds
/// it. Deviations stay within ±60 % (friction: ±90 %). Nothing is learned below 0.5 rad/s, where
/// friction hides everything else.
///
/// Who starts in motion believes to be at rest. Learned from, that would be a parameter's error; and
/// the gains of one that learns are small. It shows in an innovation beyond what the first cell and
/// parameters at the ends of their range explain, `|e| > 1/2 + 0.6 |v| n`, at an age below 1 / K_v.
/// From there, and for as long, the velocity is the mean since, carried on by what drives it:
/// ```text
/// K_v = 1 / max(1, age)      K_a = 0      p, U and D stay
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Learned {
    /// Velocity below which nothing is learned, counts a tick.
    slowest: f32,
    /// Growth of each D a tick.
    walk: [f32; 3],
    /// [`SPACING`] in ticks.
    spacing: f32,
}

/// State of [`Learned`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LearnedState {
    parameters: [f32; 3],
    /// Of position, velocity and unknown torque, for each parameter.
    sensitivity: [Dependence; 3],
    /// U: elements 01, 02 and 12.
    upper: [f32; 3],
    diagonal: [f32; 3],
    /// Ticks since D last grew.
    waiting: f32,
    start: Start,
    /// Ticks from the start to the last correction; of one in motion, from where that showed.
    age: f32,
}

/// How it started.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Start {
    /// At rest, as far as is known.
    AtRest,
    /// In motion.
    InMotion,
    /// Long ago.
    Over,
}

impl LearnedState {
    /// D: the variances of the parameters but for what they share.
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

/// Standard deviations before anything was learned.
const PRIOR: [f32; 3] = [0.35, 0.6, 0.35];

/// Largest deviations.
const LARGEST: [f32; 3] = [0.6, 0.9, 0.6];

/// How far the first cell's middle may be from where the rotor starts, counts.
const CELL: f32 = 0.5;

/// Part of [`PRIOR`] that a parameter walks in a second.
const WALK: f64 = 0.1;

/// Velocity below which nothing is learned, rad/s.
const SLOWEST: f64 = 0.5;

/// How much less an innovation counts than its variance says: innovations of a dead zone and of
/// a torque that is not quite white are not independent.
const CAUTION: f32 = 8.0;

/// Time between two innovations that are learned from where every tick may have one, s: those
/// between them would say much the same again, as often as the rate is high.
const SPACING: f64 = 3.5e-3;

/// [`CAUTION`] for innovations so far apart.
const DENSE_CAUTION: f32 = 2.0;

impl Learned {
    pub(super) const fn new(counts_per_rev: u32, rate: Hertz) -> Result<Self, DesignError> {
        if !rate.is_positive() {
            return Err(DesignError::RATE);
        }
        if counts_per_rev == 0 {
            return Err(DesignError::COUNTS_PER_REV);
        }
        let per_rad = counts_per_rev as f64 / (2.0 * core::f64::consts::PI);
        let mut walk = [0.0; 3];
        let mut i = 0;
        while i < 3 {
            let step = WALK * PRIOR[i] as f64;
            walk[i] = (step * step / rate.0) as f32;
            i += 1;
        }
        Ok(Self {
            slowest: (SLOWEST * per_rad / rate.0) as f32,
            walk,
            spacing: (SPACING * rate.0) as f32,
        })
    }
}

impl Learning for Learned {
    type State = LearnedState;
    /// Of position, velocity and unknown torque on each parameter.
    type Dependence = [Dependence; 3];

    fn start(&self) -> LearnedState {
        LearnedState {
            parameters: [0.0; 3],
            sensitivity: [Dependence::default(); 3],
            upper: [0.0; 3],
            diagonal: PRIOR.map(|deviation| deviation * deviation),
            waiting: 0.0,
            start: Start::AtRest,
            age: 0.0,
        }
    }

    fn deviations(&self, state: &LearnedState) -> Deviations {
        let [damping, friction, torque_constant] = state.parameters;
        Deviations {
            damping,
            friction,
            torque_constant,
        }
    }

    /// `s_vᵀ U D Uᵀ s_v`.
    fn velocity_variance(&self, state: &LearnedState) -> f32 {
        let [a, b, c] = state.sensitivity.map(|s| s.velocity);
        let [u01, u02, u12] = state.upper;
        let y = [a, u01 * a + b, u02 * a + u12 * b + c];
        let [d0, d1, d2] = state.diagonal;
        d0 * y[0] * y[0] + d1 * y[1] * y[1] + d2 * y[2] * y[2]
    }

    #[inline(always)]
    fn drive(
        &self,
        state: &LearnedState,
        motion: &Motion,
        push: Push,
        handle: f32,
        velocity: f32,
    ) -> Push {
        let [damping, _, torque_constant] = state.parameters;
        let slip = handle + damping * (handle - velocity);
        Push {
            mean: push.mean + torque_constant * push.mean + motion.coupling * slip,
            behind: push.behind + torque_constant * push.behind,
        }
    }

    #[inline(always)]
    fn friction(&self, state: &LearnedState, motion: &Motion) -> f32 {
        motion.friction + state.parameters[1] * motion.friction
    }

    #[inline(always)]
    fn starting(
        &self,
        state: &mut LearnedState,
        innovation: &Innovation,
        gain: &Gain,
        velocity: f32,
    ) -> Option<Gain> {
        let gap = innovation.gap;
        if state.start == Start::Over || gap == 0.0 {
            return None;
        }
        state.age += gap;
        if state.age * gain.velocity >= 1.0 {
            state.start = Start::Over;
            return None;
        }
        if state.start == Start::AtRest {
            let explained = CELL + LARGEST[0] * velocity.abs() * gap;
            if innovation.error.abs() <= explained {
                return None;
            }
            state.start = Start::InMotion;
            state.age = gap;
        }
        let age = state.age;
        Some(Gain {
            velocity: if age > 1.0 { 1.0 / age } else { 1.0 },
            load: 0.0,
            ..*gain
        })
    }

    #[inline(always)]
    fn follow(&self, state: &LearnedState, tick: &Tick<'_>) -> [Dependence; 3] {
        let Tick { motion, step, .. } = tick;
        let mean = 0.5 * (tick.before + step.velocity);
        let regressors = [
            motion.coupling * (tick.handle - mean),
            -step.direction * motion.friction,
            tick.push.mean,
        ];
        let [damping, friction, torque_constant] = state.sensitivity;
        [
            damping.after(regressors[0], tick),
            friction.after(regressors[1], tick),
            torque_constant.after(regressors[2], tick),
        ]
    }

    #[inline(always)]
    fn keep(&self, state: &mut LearnedState, dependence: [Dependence; 3]) {
        state.sensitivity = dependence;
    }

    #[inline(always)]
    fn learn(
        &self,
        state: &mut LearnedState,
        dependence: [Dependence; 3],
        lesson: &Lesson<'_>,
    ) -> Option<Shift> {
        let Lesson {
            innovation, gain, ..
        } = lesson;
        let h = [
            dependence[0].then(innovation),
            dependence[1].then(innovation),
            dependence[2].then(innovation),
        ];
        let after = [
            dependence[0].corrected(lesson, h[0]),
            dependence[1].corrected(lesson, h[1]),
            dependence[2].corrected(lesson, h[2]),
        ];
        state.sensitivity = after;
        let waiting = state.waiting + innovation.gap;
        state.waiting = waiting;
        let early = lesson.dense && waiting < self.spacing;
        let slow = lesson.velocity.abs() < self.slowest;
        if lesson.starting || innovation.gap == 0.0 || early || slow {
            return None;
        }
        state.waiting = 0.0;
        let grown = |i: usize| {
            let grown = state.diagonal[i] + self.walk[i] * waiting;
            let prior = PRIOR[i] * PRIOR[i];
            if grown < prior { grown } else { prior }
        };
        let caution = if lesson.dense { DENSE_CAUTION } else { CAUTION };
        let mut diagonal = [grown(0), grown(1), grown(2)];
        let r = caution * gain.variance;
        let Some(k) = bierman(&mut state.upper, &mut diagonal, h, r) else {
            unlikely();
            // Known to be zero or as an array, it would be cleared by a loop, of which the bound on an
            // update's instructions knows no end.
            let zero = core::hint::black_box(0.0);
            let none = Dependence {
                position: zero,
                velocity: zero,
                load: zero,
            };
            let [damping, friction, torque_constant] = &mut state.sensitivity;
            (*damping, *friction, *torque_constant) = (none, none, none);
            return None;
        };
        state.diagonal = diagonal;
        let mut change = |i: usize| {
            let before = state.parameters[i];
            state.parameters[i] = limited(before + k[i] * lesson.error, LARGEST[i]);
            state.parameters[i] - before
        };
        let change = [change(0), change(1), change(2)];
        let sum = |of: fn(&Dependence) -> f32| {
            of(&after[0]) * change[0] + of(&after[1]) * change[1] + of(&after[2]) * change[2]
        };
        Some(Shift {
            position: sum(|s| s.position),
            velocity: sum(|s| s.velocity),
            load: sum(|s| s.load),
        })
    }
}
