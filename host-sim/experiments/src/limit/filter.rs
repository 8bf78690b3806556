//! The particle filter.

use rand_distr::{Distribution, StandardNormal};
use rand_xoshiro::{Xoshiro256PlusPlus, rand_core::SeedableRng};
use std::f64::consts::TAU;

use catalogue::estimators::Setup;
use simulation::scenario::draw;
use simulation::trace::Trace;

/// Noise of the particles. SI units.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Noise {
    /// White torque, N.m/sqrt(Hz).
    pub torque_noise: f64,
    /// Standard deviation of the slow disturbance torque, N.m.
    pub disturbance: f64,
    /// Correlation time of the slow disturbance torque, s.
    pub disturbance_time: f64,
    /// Standard deviation of a slow friction error, N.m; its correlation time is ten times that of
    /// the disturbance torque.
    pub friction_error: f64,
}

/// One copy of the motor: position in counts from the lower boundary of the newest count, velocity
/// in counts per tick, disturbance torque and friction error in counts per tick².
#[derive(Clone, Copy, Debug, Default)]
struct Particle {
    x: f64,
    v: f64,
    disturbance: f64,
    friction_error: f64,
}

/// Tolerance of a particle's position beyond the quantisation interval, counts, for rounding and the
/// finite number of particles.
const BLUR: f64 = 0.01;

/// Tolerance of a particle's position at a time-stamped edge, counts; it includes the interpolation
/// between two ticks.
const EDGE_BLUR: f64 = 0.015;

/// Standard deviation of the jitter after resampling, relative to that of the particles.
const JITTER: f64 = 0.08;

/// Constants of the model in counts and ticks.
struct Model {
    phi0: f64,
    phi1: f64,
    phi2: f64,
    coupling: f64,
    friction: f64,
    per_amp: f64,
    lag: f64,
    ratio: f64,
    white: f64,
    disturbance: (f64, f64),
    friction_error: (f64, f64),
}

impl Model {
    fn new(setup: &Setup, noise: &Noise) -> Self {
        let t = setup.rate.period_s();
        let device = setup.stages.coupled_motor().motor;
        let beta = (device.damping * t / device.inertia).max(1e-9);
        let phi1 = -(-beta).exp_m1() / beta;
        let per_torque = f64::from(device.counts_per_rev) / TAU * t * t / device.inertia;
        let slow = |torque: f64, time: f64| {
            let decay = (-t / time).exp();
            (decay, per_torque * torque * (1.0 - decay * decay).sqrt())
        };
        Self {
            phi0: (-beta).exp(),
            phi1,
            phi2: (1.0 - phi1) / beta,
            coupling: beta,
            friction: per_torque * setup.stages.large.coulomb_friction,
            per_amp: per_torque * device.torque_constant,
            lag: setup.stages.coupled_motor().amplifier_lag / t,
            ratio: f64::from(device.counts_per_rev) / f64::from(setup.stages.small.counts_per_rev),
            white: per_torque * noise.torque_noise / t.sqrt(),
            disturbance: slow(noise.disturbance, noise.disturbance_time),
            friction_error: slow(noise.friction_error, 10.0 * noise.disturbance_time),
        }
    }

    /// One tick of one particle; `drive` is the acceleration by the current and the handle.
    fn step(&self, p: &mut Particle, drive: f64, random: &mut Xoshiro256PlusPlus) {
        let mut normal = || -> f64 { StandardNormal.sample(random) };
        let (kick, bend) = (self.white * normal(), self.white * normal() / 12_f64.sqrt());
        p.disturbance = self.disturbance.0 * p.disturbance + self.disturbance.1 * normal();
        p.friction_error =
            self.friction_error.0 * p.friction_error + self.friction_error.1 * normal();
        let drive = drive + p.disturbance + kick;
        let friction = (self.friction + p.friction_error).max(0.0);
        let leaving = if drive.abs() > friction {
            drive.signum()
        } else {
            0.0
        };
        let direction = if p.v == 0.0 { leaving } else { p.v.signum() };
        let net = drive - direction * friction;
        let end = self.phi0 * p.v + self.phi1 * net;
        if end * direction > 0.0 {
            p.x += self.phi1 * p.v + self.phi2 * net + bend;
            p.v = end;
            return;
        }
        let part = if p.v == end { 0.0 } else { p.v / (p.v - end) };
        let left = 1.0 - part;
        let away = if leaving == 0.0 {
            0.0
        } else {
            left * (drive - leaving * friction)
        };
        p.x += 0.5 * (part * p.v + left * away);
        p.v = away;
    }
}

/// Effective number of particles below which their mean is arbitrary.
const FEWEST: f64 = 10.0;

/// Result of the particle filter.
#[derive(Clone, Debug, PartialEq)]
pub struct Filtered {
    /// Velocity at each tick, rad/s: the mean of the particles.
    pub velocities: Vec<f32>,
    /// Share of the ticks with an effective number of particles below 10, 0 to 1.
    pub collapsed: f64,
}

/// Number of equal parts of a run of [`filter`], for progress.
pub const PARTS: usize = 50;

/// Runs the filter over a trace, and calls `done` after each of [`PARTS`] equal parts. Deterministic in `seed`.
#[must_use]
pub fn filter(
    trace: &Trace,
    setup: &Setup,
    noise: &Noise,
    edges: bool,
    particles: usize,
    seed: u64,
    done: &dyn Fn(),
) -> Filtered {
    let model = Model::new(setup, noise);
    let mut random = Xoshiro256PlusPlus::seed_from_u64(seed ^ 0x11_417);
    let rad_s = TAU * setup.rate.0 / f64::from(setup.stages.large.counts_per_rev);
    let mut cloud: Vec<Particle> = (0..particles)
        .map(|i| Particle {
            x: (i as f64 + 0.5) / particles as f64,
            ..Particle::default()
        })
        .collect();
    let mut weights = vec![1.0; particles];
    let mut befores = vec![(0.0, 0.0); particles];
    let mut current = 0.0;
    let mut velocities = vec![0.0; trace.len()];
    let mut collapsed = 0_usize;
    for k in 1..trace.len() {
        let command = trace.current.as_ref().map_or(0.0, |column| column[k - 1]);
        let missing = command - current;
        let left = (-1.0 / model.lag.max(1e-9)).exp();
        let mean = model.lag * (1.0 - left);
        current = command - left * missing;
        let handle = trace.counts_small.as_ref().map_or(0.0, |column| {
            f64::from(column[k].wrapping_sub(column[k - 1]) as i32) * model.ratio
        });
        let drive = model.per_amp * (command - mean * missing) + model.coupling * handle;
        let behind = model.per_amp * missing * (model.lag * (1.0 - mean) - 0.5 * mean);
        let counts =
            f64::from(trace.counts_large[k].wrapping_sub(trace.counts_large[k - 1]) as i32);
        let stamp = trace.edges.as_ref().and_then(|column| column[k]);
        let age = |age_s: f64| age_s * setup.rate.0;
        let stamp = stamp.filter(|stamp| edges && age(stamp.age_s) < 1.0);
        for ((p, weight), before) in cloud.iter_mut().zip(&mut weights).zip(&mut befores) {
            *before = (p.x - counts, p.v);
            model.step(p, drive, &mut random);
            p.x -= counts + behind;
            let outside = (-p.x).max(p.x - 1.0).max(0.0) / BLUR;
            let mut exponent = 0.5 * outside * outside;
            if let Some(stamp) = stamp {
                let passed = 1.0 - age(stamp.age_s);
                let bend = 0.5 * (p.v - before.1);
                let there = before.0 + passed * (p.x - before.0 - bend + bend * passed);
                let boundary = f64::from(stamp.boundary.wrapping_sub(trace.counts_large[k]) as i32);
                let miss = (there - boundary) / EDGE_BLUR;
                exponent += 0.5 * miss * miss;
            }
            *weight *= (-exponent).exp();
        }
        let mut total: f64 = weights.iter().sum();
        let squares: f64 = weights.iter().map(|weight| weight * weight).sum();
        // The effective number is NaN if no particle agrees with the count.
        let has_enough = total * total >= FEWEST * squares && total >= 1e-200;
        collapsed += usize::from(!has_enough);
        if total < 1e-200 {
            // No particle agrees with the count: restart with the velocity of the counts.
            for (i, (p, weight)) in cloud.iter_mut().zip(&mut weights).enumerate() {
                p.x = (i as f64 + 0.5) / particles as f64;
                p.v = counts + draw(&mut random, -1.0, 1.0);
                *weight = 1.0;
            }
            total = particles as f64;
        }
        let moment = |value: &dyn Fn(&Particle) -> f64| {
            let pairs = cloud.iter().zip(&weights);
            pairs.map(|(p, weight)| weight * value(p)).sum::<f64>() / total
        };
        let velocity = moment(&|p| p.v);
        velocities[k] = (velocity * rad_s) as f32;
        let squares: f64 = weights.iter().map(|weight| weight * weight).sum();
        if total * total < 0.5 * particles as f64 * squares {
            let spread = |value: &dyn Fn(&Particle) -> f64| {
                let mean = moment(value);
                moment(&|p| (value(p) - mean).powi(2)).sqrt()
            };
            let spreads = [
                spread(&|p| p.x),
                spread(&|p| p.v),
                spread(&|p| p.disturbance),
                spread(&|p| p.friction_error),
            ];
            cloud = resampled(&cloud, &weights, total, spreads, &mut random);
            weights.fill(1.0);
        }
        // The first tick has no step.
        let parts = |ticks: usize| ticks * PARTS / (trace.len() - 1);
        (parts(k - 1)..parts(k)).for_each(|_| done());
    }
    Filtered {
        velocities,
        collapsed: collapsed as f64 / trace.len().max(1) as f64,
    }
}

/// Resampling: the same number of particles, drawn by their weights, with a small jitter.
fn resampled(
    cloud: &[Particle],
    weights: &[f64],
    total: f64,
    spreads: [f64; 4],
    random: &mut Xoshiro256PlusPlus,
) -> Vec<Particle> {
    let step = total / cloud.len() as f64;
    let mut wanted = step * draw(random, 0.0, 1.0);
    let (mut sum, mut at) = (weights[0], 0);
    let mut next = Vec::with_capacity(cloud.len());
    for _ in 0..cloud.len() {
        while sum < wanted && at + 1 < cloud.len() {
            at += 1;
            sum += weights[at];
        }
        wanted += step;
        let mut normal = |spread: f64| -> f64 {
            let draw: f64 = StandardNormal.sample(random);
            JITTER * spread * draw
        };
        let p = cloud[at];
        let resting = p.v == 0.0;
        next.push(Particle {
            x: p.x + normal(spreads[0]),
            // A rotor at rest stays at rest.
            v: if resting {
                0.0
            } else {
                p.v + normal(spreads[1])
            },
            disturbance: p.disturbance + normal(spreads[2]),
            friction_error: p.friction_error + normal(spreads[3]),
        });
    }
    next
}

#[cfg(test)]
mod tests {
    use super::*;
    use catalogue::estimators::Setup;
    use simulation::device::Device;

    const QUIET: Noise = Noise {
        torque_noise: 0.0,
        disturbance: 0.0,
        disturbance_time: 1.0,
        friction_error: 0.0,
    };

    #[test]
    fn friction_and_friction_error_brake_a_particle() {
        let setup = Setup::of(&Device::default(), 1e3);
        let model = Model::new(&setup, &QUIET);
        let unknown = 0.3 * model.friction;
        let mut random = Xoshiro256PlusPlus::seed_from_u64(1);
        for direction in [1.0, -1.0] {
            let mut p = Particle {
                v: direction * 50.0,
                friction_error: unknown,
                ..Particle::default()
            };
            model.step(&mut p, 0.0, &mut random);
            // dw/dt = -(b w + friction) / J over a tick of 1 ms; the unknown part lasts 10 s.
            let beta = setup.stages.damping * 1e-3 / setup.stages.large.inertia;
            let brake = model.friction + unknown * (-1e-4_f64).exp();
            let end = 50.0 * (-beta).exp() - brake * (1.0 - (-beta).exp()) / beta;
            assert!((p.v - direction * end).abs() < 1e-9, "{} {end}", p.v);
        }
    }

    #[test]
    fn lagging_current_causes_no_drift() {
        // An amplifier lag of one tick, no friction, no damping: the motion has a closed form.
        let mut setup = Setup::of(&Device::default(), 1e3).frictionless();
        setup.stages.amplifier_bandwidth.0 = 1e3 / TAU;
        setup.stages.damping = 0.0;
        let per_amp = f64::from(setup.stages.large.counts_per_rev) / TAU
            * 1e-6
            * setup.stages.large.torque_constant
            / setup.stages.large.inertia;
        let ticks = 400_u32;
        // A triangle of 50 A, whose slope is 0.5 A a tick.
        let command = |k: u32| 0.5 * (50.0 - (f64::from(k % 200) - 100.0).abs());
        let left = (-1.0_f64).exp();
        let (mut x, mut v, mut i) = (0.5, 0.0, 0.0);
        let (mut counts, mut truth) = (vec![0_u32], vec![0.0]);
        for k in 0..ticks - 1 {
            // i(s) = command - missing e^-s, integrated once and twice from s = 0 to 1.
            let missing = command(k) - i;
            x += v + per_amp * (0.5 * command(k) - missing * left);
            v += per_amp * (command(k) - missing * (1.0 - left));
            i = command(k) - left * missing;
            counts.push((x as i64) as u32);
            truth.push(v * TAU * 1e3 / f64::from(setup.stages.large.counts_per_rev));
        }
        let trace = Trace {
            rate_hz: 1e3,
            counts_large: counts,
            counts_small: None,
            current: Some((0..ticks).map(command).collect()),
            edges: None,
            true_omega: None,
            known: None,
            true_damping: None,
            periods: None,
        };
        let noise = Noise {
            torque_noise: 6e-6,
            ..QUIET
        };
        let found = filter(&trace, &setup, &noise, false, 500, 1, &|| ()).velocities;
        let squares = found.iter().zip(&truth).skip(20);
        let squares = squares.map(|(found, truth)| (f64::from(*found) - truth).powi(2));
        let rms = (squares.sum::<f64>() / f64::from(ticks - 20)).sqrt();
        // The opposite sign of the lag causes an error of 0.16 of the slope in counts per tick.
        let wrong = 0.16 * per_amp * 0.5 * TAU * 1e3 / f64::from(setup.stages.large.counts_per_rev);
        assert!(rms < 0.2 * wrong, "{rms} rad/s, of {wrong}");
    }

    #[test]
    fn progress_has_its_parts_in_every_run() {
        let setup = Setup::of(&Device::default(), 1e3);
        for ticks in [2, 30, 173] {
            let trace = Trace {
                rate_hz: 1e3,
                counts_large: vec![0; ticks],
                counts_small: None,
                current: None,
                edges: None,
                true_omega: None,
                known: None,
                true_damping: None,
                periods: None,
            };
            let calls = std::cell::Cell::new(0);
            let _ = filter(&trace, &setup, &QUIET, false, 10, 1, &|| {
                calls.set(calls.get() + 1);
            });
            assert_eq!(calls.get(), PARTS, "{ticks}");
        }
    }
}
