//! Forward and backward sweeps over the observations of a recording.
//!
//! Each observation is replaced by a Gaussian factor of the position. That of a stamped edge has the
//! boundary as mean and the sensor noise as variance. That of a row is chosen such that mean and
//! variance of the position, given all other factors, are those of the count's exact likelihood
//! (expectation propagation). With the factors fixed, the forward sweep is a Kalman filter and the
//! backward sweep the information filter of the two-filter smoother, which gives the estimates of the
//! Rauch-Tung-Striebel smoother.

use std::f64::consts::PI;

use super::cell::{Site, observe};
use super::events::{Event, Kind};
use super::state::{Message, Moments};

/// Number of times that all factors are computed: forward and backward in turn.
const CYCLES: usize = 2;

/// Noises and largest speed, in counts and periods.
#[derive(Clone, Copy, Debug)]
pub(super) struct Model {
    /// Spectral density of the jerk, counts^2/period^5.
    pub jerk: f64,
    /// Variance of the sensor, counts^2.
    pub sensor: f64,
    /// Largest displacement in a period, counts.
    pub fastest: f64,
}

/// Velocity at a row, counts/period.
#[derive(Clone, Copy, Debug)]
pub(super) struct Smoothed {
    pub velocity: f64,
    pub variance: f64,
}

/// The state before the first observation: at rest in the middle of its cell, with a deviation of a count
/// and ten times the sensor's, and with deviations of the motion as large as the fastest one.
fn start(model: Model) -> Moments {
    let spread = 4.0 * model.fastest.max(1.0).powi(2);
    let mut covariance = [[0.0; 3]; 3];
    covariance[0][0] = 1.0 + 100.0 * model.sensor;
    covariance[1][1] = spread;
    covariance[2][2] = spread;
    Moments {
        mean: [0.5, 0.0, 0.0],
        covariance,
    }
}

/// The factor of an observation for a position of this mean and variance, and the logarithm of the
/// observation's likelihood.
fn factor(kind: Kind, position: &Moments, sensor: f64) -> (Site, f64) {
    let (mean, variance) = (position.mean[0], position.covariance[0][0].max(1e-15));
    match kind {
        Kind::Row => observe(mean, variance, sensor),
        Kind::Bad => (Site::default(), 0.0),
        Kind::Edge => {
            let total = variance + sensor;
            let log = -0.5 * (mean * mean / total + (2.0 * PI * total).ln());
            let site = Site {
                precision: 1.0 / sensor,
                information: 0.0,
            };
            (site, log)
        }
    }
}

/// The state at `event` without its observation, from the state at the event before.
fn predicted(state: &Moments, event: &Event, model: Model) -> Moments {
    match event.restarts {
        true => start(model),
        false => state.predicted(event.since, model.jerk, event.shift),
    }
}

/// What `event` and later ones say of the state at the event before, from the message with the
/// observation of `event`.
fn before(message: &Message, event: &Event, model: Model) -> Message {
    match event.restarts {
        true => Message::default(),
        false => message.before(event.since, model.jerk, event.shift),
    }
}

/// Logarithm of the likelihood of the observations, each given those before it.
pub(super) fn log_likelihood(events: &[Event], model: Model) -> f64 {
    let mut state = start(model);
    let mut sum = 0.0;
    for event in events {
        state = predicted(&state, event, model);
        let (site, log) = factor(event.kind, &state, model.sensor);
        sum += log;
        state = state.with(site);
    }
    sum
}

/// Velocities at the rows, and the factors of the observations.
pub(super) fn smoothed(events: &[Event], model: Model) -> (Vec<Smoothed>, Vec<Site>) {
    smoothed_by(events, model, |event, position| {
        factor(event.kind, position, model.sensor).0
    })
}

/// As [`smoothed`], with the factor that `factor` gives to an event whose position has these moments
/// without the event itself.
fn smoothed_by(
    events: &[Event],
    model: Model,
    factor: impl Fn(&Event, &Moments) -> Site,
) -> (Vec<Smoothed>, Vec<Site>) {
    let mut later = vec![Message::default(); events.len()];
    let mut earlier = Vec::with_capacity(events.len());
    let mut velocities = Vec::new();
    let mut sites = vec![Site::default(); events.len()];
    for _ in 0..CYCLES {
        earlier.clear();
        let mut state = start(model);
        for (event, later) in events.iter().zip(&later) {
            state = predicted(&state, event, model);
            earlier.push(state);
            state = state.with(factor(event, &state.joined(later)));
        }
        velocities.clear();
        let mut message = Message::default();
        for (k, event) in events.iter().enumerate().rev() {
            later[k] = message;
            let others = earlier[k].joined(&message);
            let site = factor(event, &others);
            sites[k] = site;
            if event.kind != Kind::Edge {
                let all = others.with(site);
                velocities.push(Smoothed {
                    velocity: all.mean[1],
                    // Not f64::max, which hides a NaN.
                    variance: all.covariance[1][1].clamp(0.0, f64::INFINITY),
                });
            }
            message = before(&message.with(site), event, model);
        }
    }
    velocities.reverse();
    (velocities, sites)
}

#[cfg(test)]
mod tests;
