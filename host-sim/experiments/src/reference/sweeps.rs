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

/// The state before the first observation: at rest in the middle of the cell, with deviations as large
/// as the fastest motion.
fn start(model: Model) -> Moments {
    let spread = 4.0 * model.fastest.max(1.0).powi(2);
    let mut covariance = [[0.0; 3]; 3];
    covariance[0][0] = 1.0;
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

/// Logarithm of the likelihood of the observations, each given those before it.
pub(super) fn log_likelihood(events: &[Event], model: Model) -> f64 {
    let mut state = start(model);
    let mut sum = 0.0;
    for event in events {
        state = state.predicted(event.since, model.jerk, event.shift);
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
    let mut before = Vec::with_capacity(events.len());
    let mut velocities = Vec::new();
    let mut sites = vec![Site::default(); events.len()];
    for _ in 0..CYCLES {
        before.clear();
        let mut state = start(model);
        for (event, later) in events.iter().zip(&later) {
            state = state.predicted(event.since, model.jerk, event.shift);
            before.push(state);
            state = state.with(factor(event, &state.joined(later)));
        }
        velocities.clear();
        let mut message = Message::default();
        for (k, event) in events.iter().enumerate().rev() {
            later[k] = message;
            let others = before[k].joined(&message);
            let site = factor(event, &others);
            sites[k] = site;
            if event.kind == Kind::Row {
                let all = others.with(site);
                velocities.push(Smoothed {
                    velocity: all.mean[1],
                    variance: all.covariance[1][1].max(0.0),
                });
            }
            message = message
                .with(site)
                .before(event.since, model.jerk, event.shift);
        }
    }
    velocities.reverse();
    (velocities, sites)
}

#[cfg(test)]
mod tests {
    use nalgebra::{DMatrix, DVector, Matrix3, RowVector3};

    use super::*;

    /// Rows and edges at uneven instants, of a position that goes forward and back.
    fn trace() -> Vec<Event> {
        let shifts = [
            0.0, -1.0, 0.0, -2.0, -3.0, 1.0, -1.0, 0.0, 2.0, 1.0, 0.0, 3.0,
        ];
        let since = [0.0, 1.0, 0.7, 1.3, 1.0, 0.25, 0.75, 2.0, 1.0, 0.1, 0.9, 1.0];
        let event = |(k, (&shift, &since)): (usize, (&f64, &f64))| Event {
            since,
            shift,
            kind: if k % 4 == 1 { Kind::Edge } else { Kind::Row },
        };
        shifts.iter().zip(&since).enumerate().map(event).collect()
    }

    /// Means and variances of the velocity by one least squares over all states: rows of the matrix
    /// are the start, the transitions and the observations, each divided by its deviation.
    fn batch(
        events: &[Event],
        model: Model,
        observed: impl Fn(&Event) -> (f64, f64),
    ) -> Vec<Smoothed> {
        let n = events.len();
        let mut information = DMatrix::<f64>::zeros(3 * n, 3 * n);
        let mut vector = DVector::<f64>::zeros(3 * n);
        let first = start(model);
        let prior = Matrix3::from_fn(|i, j| first.covariance[i][j])
            .try_inverse()
            .unwrap();
        information.view_mut((0, 0), (3, 3)).copy_from(&prior);
        let mean = nalgebra::Vector3::from(first.mean);
        vector.rows_mut(0, 3).copy_from(&(prior * mean));
        // Positions from the origin of the first event.
        let mut origin = 0.0;
        for (k, event) in events.iter().enumerate() {
            origin -= event.shift;
            let (z, variance) = observed(event);
            let h = RowVector3::new(1.0, 0.0, 0.0);
            let mut block = information.view_mut((3 * k, 3 * k), (3, 3));
            block += h.transpose() * h / variance;
            vector[3 * k] += (z + origin) / variance;
            if k == 0 {
                continue;
            }
            let t = event.since;
            let a = Matrix3::new(1.0, t, t * t / 2.0, 0.0, 1.0, t, 0.0, 0.0, 1.0);
            // Van Loan by quadrature: the integral of A(s) b b' A(s)'.
            let mut q = Matrix3::zeros();
            let steps = 2000;
            for i in 0..steps {
                let s = t * (f64::from(i) + 0.5) / f64::from(steps);
                let b = nalgebra::Vector3::new(s * s / 2.0, s, 1.0);
                q += b * b.transpose() * (model.jerk * t / f64::from(steps));
            }
            let w = q.try_inverse().unwrap();
            for (i, left) in [(3 * (k - 1), -a.transpose()), (3 * k, Matrix3::identity())] {
                for (j, right) in [(3 * (k - 1), -a), (3 * k, Matrix3::identity())] {
                    let mut block = information.view_mut((i, j), (3, 3));
                    block += left * w * right;
                }
            }
        }
        let covariance = information.try_inverse().unwrap();
        let mean = &covariance * vector;
        let rows = events
            .iter()
            .enumerate()
            .filter(|(_, event)| event.kind == Kind::Row);
        let of = |(k, _): (usize, &Event)| Smoothed {
            velocity: mean[3 * k + 1],
            variance: covariance[(3 * k + 1, 3 * k + 1)],
        };
        rows.map(of).collect()
    }

    #[test]
    fn linear_smoother_agrees_with_batch_least_squares() {
        let events = trace();
        let model = Model {
            jerk: 0.3,
            sensor: 0.01,
            fastest: 3.0,
        };
        let observed = |event: &Event| match event.kind {
            Kind::Row => (0.5, 1.0 / 12.0),
            Kind::Edge => (0.0, 0.01),
        };
        let (velocities, _) = smoothed_by(&events, model, |event, _| {
            let (z, variance) = observed(event);
            Site {
                precision: 1.0 / variance,
                information: z / variance,
            }
        });
        let expected = batch(&events, model, observed);
        assert_eq!(velocities.len(), expected.len());
        for (got, expected) in velocities.iter().zip(&expected) {
            // The quadrature of the process noise has a relative error of 1e-6.
            assert!(
                (got.velocity - expected.velocity).abs() < 1e-4,
                "{got:?} {expected:?}"
            );
            assert!(
                (got.variance / expected.variance - 1.0).abs() < 1e-4,
                "{got:?} {expected:?}"
            );
        }
    }

    #[test]
    fn further_cycles_change_little() {
        let model = Model {
            jerk: 0.3,
            sensor: 0.01,
            fastest: 3.0,
        };
        let events = trace();
        let (velocities, sites) = smoothed(&events, model);
        // The batch solution with the final factors is a further cycle.
        let k = std::cell::Cell::new(0);
        let of = |_: &Event| {
            let site = sites[k.replace(k.get() + 1)];
            (site.information / site.precision, 1.0 / site.precision)
        };
        for (got, expected) in velocities.iter().zip(batch(&events, model, of)) {
            let sd = expected.variance.sqrt();
            assert!(
                (got.velocity - expected.velocity).abs() < 0.05 * sd,
                "{got:?} {expected:?}"
            );
            assert!(
                (got.variance.sqrt() / sd - 1.0).abs() < 0.05,
                "{got:?} {expected:?}"
            );
        }
    }
}
