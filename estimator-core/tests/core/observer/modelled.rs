//! A motor that obeys the observers' model, and observers that know it.

use estimator_core::{Amps, ClockTicks, Count, CoupledMotor, Edge, Sample};

use super::{CLOCK, at};

/// A motor that obeys the observer's own model, in f64 and small steps: friction, coupler, lag.
struct Motor {
    device: CoupledMotor,
    angle: f64,
    omega: f64,
    current: f64,
}

impl Motor {
    fn step(&mut self, command: f64, coupled: f64, dt: f64) {
        let device = &self.device;
        if device.amplifier_lag > 0.0 {
            self.current += (command - self.current) * (1.0 - (-dt / device.amplifier_lag).exp());
        } else {
            self.current = command;
        }
        let push = device.motor.torque_constant * self.current
            - device.motor.damping * (self.omega - coupled);
        let friction = device.coulomb_friction;
        let direction = if self.omega == 0.0 { push } else { self.omega };
        if self.omega == 0.0 && push.abs() <= friction {
            return;
        }
        let next = self.omega + dt * (push - friction * direction.signum()) / device.motor.inertia;
        self.omega = if next * direction < 0.0 { 0.0 } else { next };
        self.angle += dt * self.omega;
    }
}

/// Samples and true velocity (counts a tick) of a motor under a swinging current of both signs,
/// over a handle that swings too.
pub(super) fn modelled(
    rate: f64,
    seconds: f64,
    first: f64,
    device: CoupledMotor,
) -> (Vec<Sample>, Vec<f64>) {
    modelled_over(0.3, rate, seconds, first, device)
}

/// The same over a handle that swings by `swing` rad; 0 for a clamped one.
pub(super) fn modelled_over(
    swing: f64,
    rate: f64,
    seconds: f64,
    first: f64,
    device: CoupledMotor,
) -> (Vec<Sample>, Vec<f64>) {
    let per_rad = f64::from(device.motor.counts_per_rev) / std::f64::consts::TAU;
    let per_small = f64::from(device.coupled_counts_per_rev) / std::f64::consts::TAU;
    let mut motor = Motor {
        device,
        angle: first / per_rad,
        omega: 0.0,
        current: 0.0,
    };
    let steps = (2e5 / rate) as u32;
    let dt = 1.0 / rate / f64::from(steps);
    let coupled = |t: f64| swing * (7.0 * t).sin();
    let (mut samples, mut truth) = (Vec::new(), Vec::new());
    let (mut last, mut command) = (None, 0.0);
    for tick in 0..(rate * seconds) as u32 {
        let t = f64::from(tick) / rate;
        let count = (motor.angle * per_rad).floor() as i64;
        let mut sample = Sample::new(Count(count as u32))
            .with_coupled(Count((coupled(t) * per_small).round() as i64 as u32))
            .with_current(Amps::new(command as f32));
        if let Some((instant, boundary)) = last {
            let age: f64 = (t - instant) * CLOCK.0;
            sample = sample.with_edge(Edge {
                boundary: Count(boundary as u32),
                age: ClockTicks(age as u32),
            });
        }
        samples.push(sample);
        truth.push(motor.omega * per_rad / rate);
        command = 0.35 * (11.0 * t).sin() + 0.2 * (3.0 * t).sin();
        for step in 0..steps {
            let since = t + f64::from(step) * dt;
            let before = motor.angle * per_rad;
            motor.step(command, swing * 7.0 * (7.0 * since).cos(), dt);
            let after = motor.angle * per_rad;
            if after.floor() != before.floor() {
                let boundary = after.floor().max(before.floor());
                let part = (boundary - before) / (after - before);
                last = Some((since + part * dt, boundary as i64));
            }
        }
    }
    (samples, truth)
}

pub(super) fn rms(estimates: &[f32], truth: &[f64], from: usize) -> f64 {
    let errors = estimates.iter().zip(&truth[1..]).skip(from);
    let squares: Vec<f64> = errors.map(|(v, w)| (f64::from(*v) - w).powi(2)).collect();
    (squares.iter().sum::<f64>() / squares.len() as f64).sqrt()
}

/// With a model that is right, what is left is the observer's own: a few thousandths of a count a
/// tick, through stops and reversals. Finite difference is off by 0.3 to 0.4.
#[test]
fn motor_that_obeys_the_model_is_followed() {
    for (rate, bound) in [(1000.0, 0.02), (10_000.0, 0.002)] {
        let (samples, truth) = modelled(rate, 4.0, 0.4, CoupledMotor::DCX35L);
        let from = (0.3 * rate) as usize;
        for case in at(rate) {
            let knows = case.needs.current && case.needs.coupled;
            if knows {
                let error = rms(&(case.run)(&samples), &truth, from);
                assert!(error < bound, "{}: {error}", case.name);
            }
        }
    }
}
