//! The observers against their definition (docs/theory.md, sections 4.9 and 4.10), in f64: dense
//! covariances, gains by the plain recursion, no code of the core.

use std::collections::HashMap;

use estimator_core::{
    Amps, Confidence, Correction, CoupledMotor, CurrentSource, Device, Hertz, Learning, Observer,
    Sample, SlipSource, Uncertainty, VelocityEstimator,
};
use nalgebra::{Matrix2, Matrix3, Vector3};

use super::modelled::modelled;
use super::{CLOCK, dressed};
use crate::motion::medley;

#[derive(Clone, Copy, Debug, PartialEq)]
enum Kind {
    Cells,
    Edges,
    Soft,
}

/// Gain of one correction, variance of its innovation, and of the velocity before it.
#[derive(Clone, Copy)]
struct Gain {
    k: Vector3<f64>,
    variance: f64,
    velocity: f64,
}

/// What [`Definition`] learns.
struct Learner {
    parameters: Vector3<f64>,
    /// A column each for damping, friction and torque constant.
    sensitivity: Matrix3<f64>,
    p: Matrix3<f64>,
    waiting: f64,
    age: f64,
    /// Whether the start is over, and whether it showed motion.
    over: bool,
    in_motion: bool,
}

const PRIOR: [f64; 3] = [0.35, 0.6, 0.35];
const RANGE: [f64; 3] = [0.6, 0.9, 0.6];

struct Definition {
    kind: Kind,
    rate: f64,
    counts_per_rad: f64,
    beta: f64,
    per_amp: f64,
    lag: f64,
    friction: f64,
    ratio: f64,
    share: f64,
    decay: f64,
    white: f64,
    boundary: f64,
    /// What a gap that no edge ends counts more, ticks.
    unstamped: f64,
    a: Matrix3<f64>,
    q: Matrix3<f64>,
    gains: HashMap<usize, Gain>,
    // The state.
    last: Sample,
    x: Vector3<f64>,
    rub: f64,
    way: f64,
    current: f64,
    gap: f64,
    alone: f64,
    offsets: [f64; 4],
    bell: Matrix2<f64>,
    sigma: f64,
    started: bool,
    learner: Option<Learner>,
}

/// `U D Uᵀ` with a unit upper triangle U: the elements of D, and U.
fn factors(p: &Matrix3<f64>) -> (Vector3<f64>, Matrix3<f64>) {
    let mut u = Matrix3::identity();
    let d2 = p[(2, 2)];
    u[(0, 2)] = p[(0, 2)] / d2;
    u[(1, 2)] = p[(1, 2)] / d2;
    let d1 = p[(1, 1)] - u[(1, 2)].powi(2) * d2;
    u[(0, 1)] = (p[(0, 1)] - u[(0, 2)] * u[(1, 2)] * d2) / d1;
    let d0 = p[(0, 0)] - u[(0, 1)].powi(2) * d1 - u[(0, 2)].powi(2) * d2;
    (Vector3::new(d0, d1, d2), u)
}

impl Definition {
    fn new(
        kind: Kind,
        learns: bool,
        device: &CoupledMotor,
        rate: f64,
        unsure: &Uncertainty,
        first: &Sample,
    ) -> Self {
        let t = 1.0 / rate;
        let counts_per_rad = f64::from(device.large.counts_per_rev) / std::f64::consts::TAU;
        let per_torque = counts_per_rad * t * t / device.large.inertia;
        let beta = device.large.damping * t / device.large.inertia;
        let phi0 = (-beta).exp();
        // Without damping the limits.
        let (phi1, phi2) = if beta > 0.0 {
            let phi1 = (1.0 - phi0) / beta;
            (phi1, (1.0 - phi1) / beta)
        } else {
            (1.0, 0.5)
        };
        let decay = (-t / unsure.load_time).exp();
        let white = (per_torque * unsure.torque_noise).powi(2) * rate;
        let load = (per_torque * unsure.load).powi(2) * (1.0 - decay * decay);
        let learner = Learner {
            parameters: Vector3::zeros(),
            sensitivity: Matrix3::zeros(),
            p: Matrix3::from_diagonal(&Vector3::from(PRIOR.map(|sigma| sigma * sigma))),
            waiting: 0.0,
            age: 0.0,
            over: false,
            in_motion: false,
        };
        Self {
            kind,
            rate,
            counts_per_rad,
            beta,
            per_amp: per_torque * device.large.torque_constant,
            lag: device.amplifier_lag * rate,
            friction: per_torque * device.coulomb_friction,
            ratio: f64::from(device.large.counts_per_rev) / f64::from(device.small_counts_per_rev),
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
                load,
            ),
            gains: HashMap::new(),
            last: *first,
            x: Vector3::zeros(),
            rub: 0.0,
            way: 0.0,
            current: f64::from(first.current.get()),
            gap: 0.0,
            alone: 0.0,
            offsets: [0.0; 4],
            bell: Matrix2::from_diagonal_element(1.0 / 12.0),
            sigma: 0.3,
            started: false,
            learner: learns.then_some(learner),
        }
    }

    /// The gain of the filter that is corrected once in so many ticks, of the longest row that is
    /// not longer than this gap, rounded to ticks.
    fn gain(&mut self, gap: f64) -> Gain {
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
    fn motion(&self, v: f64, u: f64, friction: f64) -> (f64, f64, f64, f64, bool) {
        let (phi0, phi1, phi2) = (self.a[(1, 1)], self.a[(0, 1)], self.a[(0, 2)]);
        let leaves = if u.abs() > friction { u.signum() } else { 0.0 };
        let sign = |x: f64| if x == 0.0 { 0.0 } else { x.signum() };
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

    /// Innovation, age, part of it that the position takes, gap, and gain, if there is one.
    fn innovation(
        &mut self,
        from: f64,
        lead: f64,
        gained: f64,
        rests: bool,
        sample: &Sample,
    ) -> Option<(f64, f64, f64, f64, Gain)> {
        let x = from + lead;
        let outside = (x.abs() > 0.5).then_some(if x > 0.0 { 0.5 - x } else { -0.5 - x });
        match self.kind {
            Kind::Cells => {
                self.gap += 1.0;
                let e = outside?;
                let gap = std::mem::take(&mut self.gap);
                Some((e, 0.0, 1.0, gap, self.gain(gap)))
            }
            Kind::Edges => {
                self.gap += 1.0;
                self.alone += 1.0;
                let edge = sample.edge.and_then(|edge| {
                    let age = f64::from(edge.age.0) * self.rate / CLOCK.0;
                    let above = (edge.boundary - sample.large).0;
                    (age < 1.0 && (0..=1).contains(&above)).then_some((edge.boundary.0, above, age))
                });
                let Some((boundary, above, age)) = edge else {
                    let e = outside?;
                    let gap = std::mem::take(&mut self.alone) + self.unstamped;
                    return Some((e, 0.0, 1.0, 0.0, self.gain(gap)));
                };
                let gap = self.gap - age;
                (self.gap, self.alone) = (age, age);
                let f = 1.0 - age;
                let there = from + lead * f - gained * f * (1.0 - f) / 2.0;
                let offset = &mut self.offsets[boundary as usize % 4];
                let e = f64::from(above) - 0.5 + *offset - there;
                *offset = (*offset - 0.02 * e).clamp(-0.25, 0.25);
                let gain = self.gain(gap);
                Some((e, age, gain.k[0], gap, gain))
            }
            Kind::Soft => {
                self.gap += 1.0;
                if rests && outside.is_none() {
                    // p stays, g = 0, s = w.
                    self.bell = Matrix2::new(self.bell[(0, 0)], 0.0, 0.0, self.white);
                    return None;
                }
                let (phi0, phi1) = (self.a[(1, 1)], self.a[(0, 1)]);
                let a = Matrix2::new(1.0, phi1, 0.0, phi0);
                let w = self.white;
                let q = Matrix2::new(w / 3.0, w / 2.0, w / 2.0, w);
                self.bell = a * self.bell * a.transpose() + q;
                let p = self.bell[(0, 0)];
                let g = self.bell[(0, 1)] / p;
                let s = self.bell[(1, 1)] - g * g * p;
                self.started |= s < 64.0 * w;
                let r = self.boundary * self.boundary;
                let variance = p + r;
                self.sigma = (self.sigma + variance / self.sigma) / 2.0;
                let blur = r / (self.sigma * self.sigma);
                let h = 3.0 * self.sigma;
                let y = x.abs() - 0.5;
                let (inwards, kept) = if y < -h {
                    return None;
                } else if y > h {
                    (y, 0.0)
                } else if h > x.abs() + 0.5 {
                    (x.abs() * (1.0 - 0.5 / h), 0.5 / h)
                } else {
                    ((y + h) * (y + h) / (4.0 * h), (h - y) / (2.0 * h))
                };
                let e = -inwards * x.signum() * (1.0 - blur);
                let left = kept + (1.0 - kept) * blur;
                let p = p * left;
                self.bell = Matrix2::new(p, g * p, g * p, s + g * g * p);
                // From above, so that Newton's next step falls to the root.
                self.sigma *= 0.5 + 0.5 * left;
                if kept == 0.0 {
                    self.sigma = 1.25 * self.boundary;
                }
                let steady = self.gain(1.0).k;
                let load = if self.started {
                    g * steady[2] / steady[1]
                } else {
                    0.0
                };
                let k = Vector3::new(1.0 - blur, g, load);
                let gap = if outside.is_some() {
                    std::mem::take(&mut self.gap)
                } else {
                    0.0
                };
                let gap = if self.started { gap } else { 0.0 };
                Some((
                    e,
                    0.0,
                    1.0,
                    gap,
                    Gain {
                        k,
                        variance,
                        velocity: f64::NAN,
                    },
                ))
            }
        }
    }

    fn update(&mut self, sample: &Sample) -> f64 {
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
        let believed_push = push;
        let handle = self.ratio * f64::from((sample.small - self.last.small).0);
        let counts = f64::from((sample.large - self.last.large).0);
        self.last = *sample;

        let v = self.x[1];
        let mut slip = self.beta * handle;
        let mut friction = self.friction;
        if let Some(learner) = &self.learner {
            let p = learner.parameters;
            push *= 1.0 + p[2];
            behind *= 1.0 + p[2];
            slip += self.beta * p[0] * (handle - v);
            friction *= 1.0 + p[1];
        }
        let (moved, after, direction, against, rests) =
            self.motion(v, push + slip + self.x[2], friction + self.rub);
        if let Some(learner) = &mut self.learner {
            let force = Vector3::new(
                self.beta * (handle - (v + after) / 2.0),
                -direction * self.friction,
                believed_push,
            );
            for j in 0..3 {
                let s = learner.sensitivity.column(j).into_owned();
                let next = if rests {
                    Vector3::new(s[0] + self.a[(0, 1)] * s[1] / 2.0, 0.0, self.decay * s[2])
                } else {
                    let b = Vector3::new(self.a[(0, 2)], self.a[(0, 1)], 0.0);
                    self.a * s + b * force[j]
                };
                learner.sensitivity.set_column(j, &next);
            }
        }
        self.way += (1.0 - (-1.0 / (8e-3 * self.rate)).exp()) * (against - self.way);
        let (from, lead) = (self.x[0] - counts, moved - behind);
        self.x = Vector3::new(from + lead, after, self.x[2] * self.decay);
        if let Some(found) = self.innovation(from, lead, after - v, rests, sample) {
            self.correct(found);
        }
        self.x[1]
    }

    /// Variance of the velocity, by what is not known of the parameters too.
    fn variance(&mut self) -> f64 {
        let known = match self.kind {
            Kind::Soft => self.bell[(1, 1)],
            // The row of the whole ticks since the last correction or edge, rounded down.
            Kind::Cells | Kind::Edges => self.gain(self.gap.floor()).velocity,
        };
        let learned = self.learner.as_ref().map_or(0.0, |learner| {
            let s = learner.sensitivity.row(1);
            (s * learner.p * s.transpose())[(0, 0)]
        });
        known + learned
    }

    fn correct(&mut self, (e, age, position, gap, gain): (f64, f64, f64, f64, Gain)) {
        let within = e.clamp(-65_536.0, 65_536.0);
        let mut k = gain.k;
        let starting = self
            .learner
            .as_mut()
            .and_then(|l| l.starting(e, gap, k[1], self.x[1]));
        if let Some(velocity) = starting {
            k = Vector3::new(k[0], velocity, 0.0);
        }
        let to_position = position + age * k[1];
        self.x[0] += to_position * e;
        self.x[1] += k[1] * within;
        self.x[2] += (1.0 - self.share) * k[2] * within;
        self.rub -= self.share * k[2] * within * self.way;
        self.rub = self.rub.clamp(-0.5 * self.friction, 0.5 * self.friction);
        let slow = self.x[1].abs() < 0.5 * self.counts_per_rad / self.rate;
        let edges = self.kind == Kind::Edges;
        let rate = self.rate;
        let Some(learner) = &mut self.learner else {
            return;
        };
        let k = Vector3::new(to_position, k[1], k[2]);
        let h = (learner.sensitivity.row(0) - learner.sensitivity.row(1) * age).transpose();
        learner.sensitivity -= k * h.transpose();
        learner.waiting += gap;
        let early = edges && learner.waiting < 3.5e-3 * rate;
        if starting.is_some() || gap == 0.0 || early || slow {
            return;
        }
        let (mut d, u) = factors(&learner.p);
        for j in 0..3 {
            let walk = (0.1 * PRIOR[j]).powi(2) * learner.waiting / rate;
            d[j] = (d[j] + walk).min(PRIOR[j] * PRIOR[j]);
        }
        learner.waiting = 0.0;
        let p = u * Matrix3::from_diagonal(&d) * u.transpose();
        let caution = if edges { 2.0 } else { 8.0 };
        let to_p = p * h;
        let k = to_p / (h.dot(&to_p) + caution * gain.variance);
        learner.p = p - k * to_p.transpose();
        let mut change = Vector3::zeros();
        for j in 0..3 {
            let before = learner.parameters[j];
            learner.parameters[j] = (before + k[j] * within).clamp(-RANGE[j], RANGE[j]);
            change[j] = learner.parameters[j] - before;
        }
        self.x += learner.sensitivity * change;
    }
}

impl Learner {
    /// The gain of the velocity instead of `gain`, if this innovation belongs to a start in motion.
    fn starting(&mut self, e: f64, gap: f64, gain: f64, v: f64) -> Option<f64> {
        if self.over || gap == 0.0 {
            return None;
        }
        self.age += gap;
        if self.age >= 1.0 / gain {
            self.over = true;
            return None;
        }
        if !self.in_motion {
            if e.abs() <= 0.5 + 0.6 * v.abs() * gap {
                return None;
            }
            self.in_motion = true;
            self.age = gap;
        }
        Some(1.0 / self.age.max(1.0))
    }
}

fn other_device() -> CoupledMotor {
    CoupledMotor {
        large: Device {
            counts_per_rev: 2000,
            inertia: 2.3e-5,
            damping: 1.7e-3,
            torque_constant: 0.061,
        },
        coulomb_friction: 2.1e-3,
        amplifier_lag: 0.9e-3,
        small_counts_per_rev: 3000,
    }
}

/// The same, but for constants that are all off: there is something to learn.
fn believed(device: &CoupledMotor) -> CoupledMotor {
    CoupledMotor {
        large: Device {
            damping: 0.7 * device.large.damping,
            torque_constant: 1.2 * device.large.torque_constant,
            ..device.large
        },
        coulomb_friction: 1.3 * device.coulomb_friction,
        ..*device
    }
}

const SURE: Uncertainty = Uncertainty {
    torque_noise: 8e-6,
    load: 2.5e-4,
    load_time: 0.07,
    friction_share: 0.6,
    boundary_noise: 0.05,
};

fn samples(rate: f64, device: &CoupledMotor) -> Vec<(&'static str, Vec<Sample>)> {
    let whole = modelled(rate, 1.2, 0.4, *device).0;
    let in_motion = whole[(0.15 * rate) as usize..].to_vec();
    let bare: Vec<Sample> = whole.iter().map(|s| Sample { edge: None, ..*s }).collect();
    // Rest, a push below friction, and the motion again.
    let mut rests = whole[..(0.2 * rate) as usize].to_vec();
    let last = *rests.last().expect("not empty");
    let push = last.with_current(Amps::new(0.01));
    rests.resize(rests.len() + (0.1 * rate) as usize, push);
    vec![
        ("modelled", whole),
        ("in motion", in_motion),
        ("without edges", bare),
        ("rest", rests),
        ("medley", dressed(&medley(), 5, rate, 1)),
    ]
}

/// Largest differences of velocity, its variance and the parameters, relative where they are large.
fn largest_difference<C, S, M, L>(
    estimator: &Observer<C, S, M, L>,
    definition: &mut Definition,
    samples: &[Sample],
) -> [f64; 3]
where
    C: CurrentSource,
    S: SlipSource,
    M: Correction,
    L: Learning,
{
    let mut state = estimator.start(&samples[0]);
    let mut off = [0.0f64; 3];
    for sample in &samples[1..] {
        let (ours, exact) = (
            estimator.update(&mut state, sample).0,
            definition.update(sample),
        );
        off[0] = off[0].max((f64::from(ours) - exact).abs() / (1.0 + exact.abs()));
        let (ours, exact) = (estimator.variance(&state).0, definition.variance());
        off[1] = off[1].max((f64::from(ours) - exact).abs() / exact);
        let ours = estimator.deviations(&state);
        let ours = [ours.damping, ours.friction, ours.torque_constant];
        let exact = definition
            .learner
            .as_ref()
            .map_or([0.0; 3], |learner| learner.parameters.into());
        for (ours, exact) in ours.iter().zip(exact) {
            off[2] = off[2].max((f64::from(*ours) - exact).abs());
        }
    }
    off
}

/// Roundings of 6e-8 over the some 100 ticks that an observer remembers. The medley has speeds of
/// thousands of counts a tick, and what is left of their roundings is seen at rest.
#[track_caller]
fn assert_rounding(off: [f64; 3], samples: &str, what: &str) {
    let allowed = if samples == "medley" {
        [2e-3, 1e-3, 5e-4]
    } else {
        [1e-5, 1e-4, 1e-4]
    };
    let within = (0..3).all(|i| off[i] <= allowed[i]);
    assert!(within, "{what}, {samples}: {off:?}");
}

#[test]
fn observers_are_their_definition() {
    for rate in [1000.0, 8000.0] {
        let hertz = Hertz(rate);
        let device = other_device();
        let belief = believed(&device);
        let n = belief.large.counts_per_rev;
        let counts = Observer::new(&belief, hertz, &SURE).expect("valid");
        let soft = Observer::soft(&belief, hertz, &SURE).expect("valid");
        let edges = counts.with_edges(CLOCK, hertz).expect("valid");
        let learns = (
            counts.learning(n, hertz).expect("valid"),
            soft.learning(n, hertz).expect("valid"),
            edges.learning(n, hertz).expect("valid"),
        );
        for (name, samples) in samples(rate, &device) {
            let new =
                |kind, learns| Definition::new(kind, learns, &belief, rate, &SURE, &samples[0]);
            for (what, off) in [
                (
                    "counts",
                    largest_difference(&counts, &mut new(Kind::Cells, false), &samples),
                ),
                (
                    "soft",
                    largest_difference(&soft, &mut new(Kind::Soft, false), &samples),
                ),
                (
                    "edges",
                    largest_difference(&edges, &mut new(Kind::Edges, false), &samples),
                ),
                (
                    "counts, learning",
                    largest_difference(&learns.0, &mut new(Kind::Cells, true), &samples),
                ),
                (
                    "soft, learning",
                    largest_difference(&learns.1, &mut new(Kind::Soft, true), &samples),
                ),
                (
                    "edges, learning",
                    largest_difference(&learns.2, &mut new(Kind::Edges, true), &samples),
                ),
            ] {
                assert_rounding(off, name, &format!("{what} at {rate} Hz"));
            }
        }
    }
}

/// Without the small encoder, and without current, friction and damping: the same equations.
#[test]
fn observers_without_an_input_are_their_definition() {
    for rate in [1000.0, 8000.0] {
        let hertz = Hertz(rate);
        let device = other_device();
        let unknown = CoupledMotor {
            large: Device {
                damping: 0.0,
                ..device.large
            },
            coulomb_friction: 0.0,
            ..device
        };
        let counts = Observer::new(&device, hertz, &SURE).expect("valid");
        // A motor without friction knows no share of it, whatever it is asked for.
        let smooth = CoupledMotor {
            coulomb_friction: 0.0,
            ..device
        };
        let smooth_counts = Observer::new(&smooth, hertz, &SURE).expect("valid");
        let wide = Uncertainty { load: 2e-2, ..SURE };
        let blind = Observer::blind(&device, hertz, CLOCK, &wide).expect("valid");
        for (name, samples) in samples(rate, &device) {
            let new = |kind, device, unsure| {
                let mut definition =
                    Definition::new(kind, false, device, rate, unsure, &samples[0]);
                definition.ratio = 0.0;
                definition
            };
            let what = format!("held at {rate} Hz");
            let off = largest_difference(
                &counts.held(),
                &mut new(Kind::Cells, &device, &SURE),
                &samples,
            );
            assert_rounding(off, name, &what);
            let mut definition = new(Kind::Cells, &smooth, &SURE);
            let off = largest_difference(&smooth_counts.held(), &mut definition, &samples);
            assert_rounding(off, name, &format!("without friction at {rate} Hz"));
            let mut definition = new(Kind::Edges, &unknown, &wide);
            definition.per_amp = 0.0;
            definition.unstamped = 0.0;
            let off = largest_difference(&blind, &mut definition, &samples);
            assert_rounding(off, name, &format!("blind at {rate} Hz"));
        }
    }
}

/// Gains by the gap, as far as the table goes and beyond.
#[test]
fn gains_are_those_of_the_filter_corrected_once_in_so_many_ticks() {
    for rate in [1000.0, 8000.0] {
        let device = other_device();
        let observer = Observer::new(&device, Hertz(rate), &SURE).expect("valid");
        let first = Sample::default();
        let mut definition = Definition::new(Kind::Cells, false, &device, rate, &SURE, &first);
        for ticks in [
            1, 2, 3, 31, 63, 64, 65, 66, 96, 97, 500, 929, 960, 961, 962, 5000,
        ] {
            let (ours, exact) = (observer.gain(ticks), definition.gain(ticks as f64));
            let ours = [ours.position, ours.velocity, ours.load, ours.variance];
            let exact = [exact.k[0], exact.k[1], exact.k[2], exact.variance];
            for (ours, exact) in ours.iter().zip(exact) {
                assert!(
                    (f64::from(*ours) / exact - 1.0).abs() < 1e-6,
                    "{ticks} ticks at {rate} Hz: {ours} {exact}"
                );
            }
        }
    }
}

/// The factors of both covariances that are kept at run time.
#[test]
fn covariances_are_those_of_the_definition() {
    let rate = 1000.0;
    let hertz = Hertz(rate);
    let belief = believed(&other_device());
    let soft = Observer::soft(&belief, hertz, &SURE).expect("valid");
    let learns = soft
        .learning(belief.large.counts_per_rev, hertz)
        .expect("valid");
    let (_, samples) = samples(rate, &other_device()).swap_remove(0);
    let mut definition = Definition::new(Kind::Soft, true, &belief, rate, &SURE, &samples[0]);
    let mut state = learns.start(&samples[0]);
    let mut off = 0.0f64;
    for sample in &samples[1..] {
        learns.update(&mut state, sample);
        definition.update(sample);
        let bell = definition.bell;
        let coupling = bell[(0, 1)] / bell[(0, 0)];
        let left = bell[(1, 1)] - coupling * bell[(0, 1)];
        let learner = definition.learner.as_ref().expect("learns");
        let (d, u) = factors(&learner.p);
        let exact = [
            bell[(0, 0)],
            left,
            coupling,
            d[0],
            d[1],
            d[2],
            u[(0, 1)],
            u[(0, 2)],
            u[(1, 2)],
        ];
        let ([p, s], g) = (
            state.correction().bell().diagonal(),
            state.correction().bell().coupling(),
        );
        let [d0, d1, d2] = *state.learning().diagonal();
        let [u01, u02, u12] = *state.learning().upper();
        for (ours, exact) in [p, s, g, d0, d1, d2, u01, u02, u12].iter().zip(exact) {
            off = off.max((f64::from(*ours) - exact).abs() / (1e-3 + exact.abs()));
        }
    }
    assert!(off < 1e-3, "{off}");
    assert!(state.learning().upper().iter().all(|u| u.abs() > 1e-3));
}
