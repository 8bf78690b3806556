use nalgebra::{DMatrix, DVector, Matrix3, RowVector3};

use super::*;
use recordings::recording::LONGEST_GAP;

/// Rows and edges at uneven instants, of a position that goes forward and back.
fn trace() -> Vec<Event> {
    let shifts = [
        0.0, -1.0, 0.0, -2.0, -3.0, 1.0, -1.0, 0.0, 2.0, 1.0, 0.0, 3.0,
    ];
    let since = [0.0, 1.0, 0.7, 1.3, 1.0, 0.25, 0.75, 2.0, 1.0, 0.1, 0.9, 1.0];
    let event = |(k, (&shift, &since)): (usize, (&f64, &f64))| Event {
        since,
        shift,
        restarts: false,
        kind: if k % 4 == 1 { Kind::Edge } else { Kind::Row },
    };
    shifts.iter().zip(&since).enumerate().map(event).collect()
}

/// Means and variances of the velocity by one least squares over all states: rows of the matrix
/// are the start, the transitions and the observations, each divided by its deviation.
fn batch(events: &[Event], model: Model, observed: impl Fn(&Event) -> (f64, f64)) -> Vec<Smoothed> {
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
        .filter(|(_, event)| event.kind != Kind::Edge);
    let of = |(k, _): (usize, &Event)| Smoothed {
        velocity: mean[3 * k + 1],
        variance: covariance[(3 * k + 1, 3 * k + 1)],
    };
    rows.map(of).collect()
}

#[test]
fn linear_smoother_agrees_with_batch_least_squares() {
    let mut events = trace();
    events[6].kind = Kind::Bad;
    let model = Model {
        jerk: 0.3,
        sensor: 0.01,
        fastest: 3.0,
    };
    let observed = |event: &Event| match event.kind {
        Kind::Row => (0.5, 1.0 / 12.0),
        Kind::Edge => (0.0, 0.01),
        Kind::Bad => (0.0, f64::INFINITY),
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

/// Rows of a constant speed, counts/period, with one longer interval.
fn constant(speed: f64, gap: f64) -> Vec<Event> {
    let (mut position, mut origin) = (0.0_f64, 0.0);
    let event = |k| {
        let since = match k {
            0 => 0.0,
            150 => gap,
            _ => 1.0,
        };
        position += speed * since;
        let shift = origin - position.floor();
        origin = position.floor();
        Event {
            since,
            shift,
            restarts: false,
            kind: Kind::Row,
        }
    };
    (0..300).map(event).collect()
}

#[test]
fn variances_are_positive_at_all_noises_speeds_and_intervals() {
    let sensors = [1e-6, 1e-4, 0.02, 1.0];
    let jerks = [-37.0, -27.0, -15.0, -5.0, 0.0, 7.0].map(f64::exp);
    for speed in [0.3, 8.0, 200.0, 1e5] {
        for gap in [1.0, 10.0, LONGEST_GAP] {
            let events = constant(speed, gap);
            for (sensor, jerk) in sensors.iter().flat_map(|s| jerks.map(|jerk| (*s, jerk))) {
                let model = Model {
                    jerk,
                    sensor,
                    fastest: speed,
                };
                let called = format!("{model:?}, gap {gap}");
                assert!(log_likelihood(&events, model).is_finite(), "{called}");
                for row in smoothed(&events, model).0 {
                    let error = (row.velocity - speed).abs() / row.variance.sqrt();
                    assert!(row.variance > 0.0, "{called}: {row:?}");
                    // The motion is more even than the noises state, except that its position in a
                    // cell depends on that in the cell before.
                    assert!(error < 5.5, "{called}: {row:?}");
                }
            }
        }
    }
}
