//! The observers by their definition (docs/theory/observer.md, docs/theory/adaptive-observer.md), in
//! f64: dense covariances, gains by the plain recursion, no code of the core.

mod correction;
mod learner;

use std::collections::HashMap;

use estimator_core::{CoupledMotor, Sample, Uncertainty};
use nalgebra::{Matrix2, Matrix3, Vector3};

pub(super) use learner::factors;
use learner::{Learner, Span};

#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Kind {
    CountUpdate,
    EdgeUpdate,
    Quantised,
}

/// Gain of one correction, variance of its innovation, and of the velocity before it.
#[derive(Clone, Copy)]
pub(super) struct Gain {
    pub(super) k: Vector3<f64>,
    pub(super) variance: f64,
    pub(super) velocity: f64,
}

pub(super) struct Definition {
    pub(super) kind: Kind,
    pub(super) rate: f64,
    pub(super) counts_per_rad: f64,
    pub(super) beta: f64,
    pub(super) per_amp: f64,
    pub(super) lag: f64,
    pub(super) friction: f64,
    pub(super) ratio: f64,
    pub(super) share: f64,
    pub(super) decay: f64,
    pub(super) white: f64,
    pub(super) boundary: f64,
    /// Ticks added to a gap that does not end with an edge.
    pub(super) unstamped: f64,
    pub(super) a: Matrix3<f64>,
    pub(super) q: Matrix3<f64>,
    pub(super) gains: HashMap<usize, Gain>,
    // The state.
    pub(super) last: Sample,
    pub(super) x: Vector3<f64>,
    pub(super) friction_correction: f64,
    pub(super) mean_direction: f64,
    pub(super) current: f64,
    pub(super) gap: f64,
    pub(super) alone: f64,
    /// Ticks since the correction before the last one.
    pub(super) waited: f64,
    pub(super) offsets: [f64; 4],
    pub(super) covariance: Matrix2<f64>,
    pub(super) sigma: f64,
    pub(super) started: bool,
    pub(super) learner: Option<Learner>,
    /// Whether the state is rounded to f32 at the end of each tick.
    pub(super) rounds: bool,
}

impl Definition {
    pub(super) fn new(
        kind: Kind,
        learns: bool,
        device: &CoupledMotor,
        rate: f64,
        unsure: &Uncertainty,
        first: &Sample,
    ) -> Self {
        let t = 1.0 / rate;
        let counts_per_rad = f64::from(device.motor.counts_per_rev) / std::f64::consts::TAU;
        let per_torque = counts_per_rad * t * t / device.motor.inertia;
        let beta = device.motor.damping * t / device.motor.inertia;
        let phi0 = (-beta).exp();
        // Without damping the limits.
        let (phi1, phi2) = if beta > 0.0 {
            let phi1 = (1.0 - phi0) / beta;
            (phi1, (1.0 - phi1) / beta)
        } else {
            (1.0, 0.5)
        };
        let decay = (-t / unsure.disturbance_time).exp();
        let white = (per_torque * unsure.torque_noise).powi(2) * rate;
        let disturbance = (per_torque * unsure.disturbance).powi(2) * (1.0 - decay * decay);
        let friction = per_torque * device.coulomb_friction;
        Self {
            kind,
            rate,
            counts_per_rad,
            beta,
            per_amp: per_torque * device.motor.torque_constant,
            lag: device.amplifier_lag * rate,
            friction,
            ratio: f64::from(device.motor.counts_per_rev)
                / f64::from(device.coupled_counts_per_rev),
            share: if device.coulomb_friction > 0.0 {
                unsure.friction_share
            } else {
                0.0
            },
            decay,
            white,
            boundary: unsure.boundary_noise,
            unstamped: 3e-3 * rate,
            a: Matrix3::new(1.0, phi1, phi2, 0.0, phi0, phi1, 0.0, 0.0, decay),
            q: Matrix3::new(
                white / 3.0,
                white / 2.0,
                0.0,
                white / 2.0,
                white,
                0.0,
                0.0,
                0.0,
                disturbance,
            ),
            gains: HashMap::new(),
            last: *first,
            x: Vector3::zeros(),
            friction_correction: 0.0,
            mean_direction: 0.0,
            current: f64::from(first.current.get()),
            gap: 0.0,
            alone: 0.0,
            waited: 0.0,
            offsets: [0.0; 4],
            covariance: Matrix2::from_diagonal_element(1.0 / 12.0),
            sigma: 0.3,
            started: false,
            learner: learns.then(|| Learner::new(Span::narrow(friction))),
            rounds: false,
        }
    }

    /// This definition without the coupled shaft, with errors in the wide range.
    pub(super) fn held_and_wide(mut self) -> Self {
        let load = (self.q[(2, 2)] / (1.0 - self.decay * self.decay)).sqrt();
        let span = Span::wide(self.friction, load, (-self.beta).exp());
        self.learner = Some(Learner::new(span));
        self.ratio = 0.0;
        self
    }

    /// The gain of the filter that is corrected once in so many ticks, of the longest row that is
    /// not longer than this gap, rounded to ticks.
    pub(super) fn gain(&mut self, gap: f64) -> Gain {
        let n = ((gap + 0.5).floor() as usize).max(1);
        let n = if n <= 64 {
            n
        } else {
            (65 + (n - 65) / 32 * 32).min(961)
        };
        let (a, q, r) = (self.a, self.q, self.boundary * self.boundary);
        *self.gains.entry(n).or_insert_with(|| {
            let (mut a_n, mut q_n) = (a, q);
            for _ in 1..n {
                q_n = a * q_n * a.transpose() + q;
                a_n = a * a_n;
            }
            let mut p = q_n;
            loop {
                let k = p.column(0) / (p[(0, 0)] + r);
                let next = a_n * (p - k * p.row(0)) * a_n.transpose() + q_n;
                let moved = (next - p).abs().max() / p.abs().max();
                p = next;
                if moved < 1e-13 {
                    break;
                }
            }
            let variance = p[(0, 0)] + r;
            Gain {
                k: p.column(0) / variance,
                variance,
                velocity: p[(1, 1)],
            }
        })
    }

    /// The motor over a tick: displacement, velocity, direction, what friction acts against, and
    /// whether it rests.
    pub(super) fn motion(&self, v: f64, u: f64, friction: f64) -> (f64, f64, f64, f64, bool) {
        let (phi0, phi1, phi2) = (self.a[(1, 1)], self.a[(0, 1)], self.a[(0, 2)]);
        let sign = |x: f64| if x == 0.0 { 0.0 } else { x.signum() };
        let leaves = if u.abs() > friction { sign(u) } else { 0.0 };
        let direction = if v == 0.0 { leaves } else { v.signum() };
        if direction == 0.0 {
            return (0.0, 0.0, 0.0, sign(u), true);
        }
        let n = u - direction * friction;
        let end = phi0 * v + phi1 * n;
        if end * direction > 0.0 {
            return (phi1 * v + phi2 * n, end, direction, direction, false);
        }
        let part = v / (v - end);
        let stopped = part * v / 2.0;
        if leaves == 0.0 {
            return (stopped, 0.0, direction * part, sign(u), true);
        }
        let left = 1.0 - part;
        let v = left * (u - leaves * friction) / (1.0 + left * (1.0 / phi1 - 1.0));
        let direction = direction * part + leaves * left;
        (stopped + left * v / 2.0, v, direction, direction, false)
    }

    /// Whether this velocity is below 0.5 rad/s.
    pub(super) fn is_slow(&self, v: f64) -> bool {
        v.abs() < 0.5 * self.counts_per_rad / self.rate
    }

    pub(super) fn update(&mut self, sample: &Sample) -> f64 {
        let command = f64::from(sample.current.get());
        let difference = command - self.current;
        let (left, missing) = if self.lag > 0.0 {
            let left = (-1.0 / self.lag).exp();
            (left, self.lag * (1.0 - left))
        } else {
            (0.0, 0.0)
        };
        self.current = command - left * difference;
        let mut push = self.per_amp * (command - missing * difference);
        let mut behind = self.per_amp * (self.lag * (1.0 - missing) - missing / 2.0) * difference;
        let assumed_push = push;
        let coupled = self.ratio * f64::from((sample.coupled - self.last.coupled).0);
        let counts = f64::from((sample.count - self.last.count).0);
        self.last = *sample;

        let v = self.x[1];
        let mut slip = self.beta * coupled;
        let mut friction = self.friction;
        if let Some(learner) = &self.learner {
            let p = learner.parameters;
            push *= 1.0 + p[2];
            behind *= 1.0 + p[2];
            slip += self.beta * p[0] * (coupled - v);
            friction += learner.span.friction * p[1];
        }
        friction += self.friction_correction;
        let wide = self.learner.as_ref().is_some_and(|l| l.span.wide);
        if wide && self.is_slow(v) {
            friction = friction.max(0.0);
        }
        let (moved, after, direction, against, rests) =
            self.motion(v, push + slip + self.x[2], friction);
        if let Some(learner) = &mut self.learner {
            let force = Vector3::new(
                self.beta * (coupled - (v + after) / 2.0),
                -direction * learner.span.friction,
                assumed_push,
            );
            // A motor that moved before the tick is stopped by the model alone.
            let rests = rests && !(wide && v != 0.0);
            let damping = if wide {
                self.beta * learner.parameters[0]
            } else {
                0.0
            };
            for j in 0..3 {
                let s = learner.sensitivity.column(j).into_owned();
                let next = if rests {
                    Vector3::new(s[0] + self.a[(0, 1)] * s[1] / 2.0, 0.0, self.decay * s[2])
                } else {
                    let b = Vector3::new(self.a[(0, 2)], self.a[(0, 1)], 0.0);
                    self.a * s + b * (force[j] - damping * s[1])
                };
                learner.sensitivity.set_column(j, &next);
            }
        }
        self.mean_direction +=
            (1.0 - (-1.0 / (8e-3 * self.rate)).exp()) * (against - self.mean_direction);
        let (from, lead) = (self.x[0] - counts, moved - behind);
        self.x = Vector3::new(from + lead, after, self.x[2] * self.decay);
        if let Some(found) = self.innovation(from, lead, after - v, rests, sample) {
            self.correct(found);
        }
        if self.rounds {
            self.round();
        }
        self.x[1]
    }

    /// Rounds the state to f32.
    fn round(&mut self) {
        let rounded = |value: f64| f64::from(value as f32);
        self.x = self.x.map(rounded);
        self.friction_correction = rounded(self.friction_correction);
        self.mean_direction = rounded(self.mean_direction);
        self.current = rounded(self.current);
        self.offsets = self.offsets.map(rounded);
        self.covariance = self.covariance.map(rounded);
        self.sigma = rounded(self.sigma);
        if let Some(learner) = &mut self.learner {
            learner.parameters = learner.parameters.map(rounded);
            learner.sensitivity = learner.sensitivity.map(rounded);
            learner.p = learner.p.map(rounded);
        }
    }

    /// Variance of the velocity, by what is not known of the parameters too.
    pub(super) fn variance(&mut self) -> f64 {
        let known = match self.kind {
            Kind::Quantised => self.covariance[(1, 1)],
            // The row of the whole ticks since the last correction or edge, rounded down.
            Kind::CountUpdate | Kind::EdgeUpdate => self.gain(self.gap.floor()).velocity,
        };
        let errors = self.learner.as_ref().map_or(0.0, |learner| {
            let s = learner.sensitivity.row(1);
            (s * learner.p * s.transpose())[(0, 0)]
        });
        known + errors
    }
}
