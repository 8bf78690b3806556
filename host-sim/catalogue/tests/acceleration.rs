//! Accelerations that the estimators report.

use std::f64::consts::TAU;

use catalogue::estimators::{Kind, Setup, sample};
use catalogue::parameters::{Parameters, PlantKind};
use estimator_core::{AccelerationEstimator as _, Signals, VelocityEstimator as _};
use simulation::trace::Trace;

/// An estimator gives counts per tick squared: with C counts per revolution at f Hz, one of them is
/// 2 pi f^2 / C rad/s^2.
#[test]
fn acceleration_of_a_trace_is_that_of_each_tick_in_rad_per_s2() {
    let (rate_hz, counts_per_rev) = (2000.0, 1000);
    let mut setup = Setup::default();
    setup.stages.large.counts_per_rev = counts_per_rev;
    setup.rate.0 = rate_hz;
    let trace = Trace {
        rate_hz,
        counts_large: (0..500).map(|k| k * k / 200).collect(),
        counts_small: Some(vec![0; 500]),
        current: Some(vec![0.1; 500]),
        edges: Some(vec![None; 500]),
        ..Trace::default()
    };
    let unit = TAU * rate_hz * rate_hz / f64::from(counts_per_rev);
    let all = Signals {
        current: true,
        coupled: true,
        edge: true,
    };
    let mut reported = 0;
    for kind in Kind::all() {
        let values = Parameters::default().values(kind, &setup, PlantKind::Friction);
        let estimator = kind.build(&setup, &values).unwrap();
        let values = estimator.resume(&mut None, &trace, 0).acceleration;
        assert_eq!(values.is_some(), kind.gives_acceleration(), "{}", kind.name);
        let Some(values) = values else { continue };
        let mut state = estimator.start(&sample(all, &trace, 0));
        for (k, value) in values.iter().enumerate().skip(1) {
            estimator.update(&mut state, &sample(all, &trace, k));
            let expected = f64::from(estimator.acceleration(&state).0) * unit;
            // Two roundings of an f32.
            let tolerance = 2e-7 * expected.abs();
            assert!(
                (f64::from(*value) - expected).abs() <= tolerance,
                "{}: {k}",
                kind.name
            );
        }
        assert!(values[499] > 0.0, "{}", kind.name);
        reported += 1;
    }
    assert!(reported >= 4, "{reported}");
}
