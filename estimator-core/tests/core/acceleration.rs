//! Accelerations that estimators give.

use estimator_core::{
    AccelerationEstimator, Count, Hertz, Kalman, Model, Sample, SteadyKalman, TableKalmanTriple,
};

/// A constant acceleration of 4 counts a tick², whose positions 2 t² are whole counts: the triple
/// integrator has no lag there, so velocity and acceleration are those of the motion.
fn assert_exact<E>(estimator: &E)
where
    E: AccelerationEstimator,
{
    let name = std::any::type_name::<E>();
    for direction in [1i64, -1] {
        let at = |tick: i64| Sample::new(Count((direction * 2 * tick * tick) as u32));
        let mut state = estimator.start(&at(0));
        assert_eq!(estimator.acceleration(&state).0, 0.0, "{name}");
        for tick in 1..2000 {
            let velocity = estimator.update(&mut state, &at(tick)).0;
            let acceleration = estimator.acceleration(&state).0;
            if tick > 600 {
                let truth = 4.0 * direction as f32;
                assert!(
                    (acceleration / truth - 1.0).abs() < 2e-4,
                    "{name}: {acceleration}"
                );
                let error = velocity - truth * tick as f32;
                assert!(error.abs() < 2e-2, "{name}: off by {error} at {tick}");
            }
        }
    }
}

#[test]
fn constant_acceleration_is_estimated() {
    let model = Model::triple_integrator(4096, Hertz(1000.0), 2e4).unwrap();
    assert_exact(&Kalman::new(&model).unwrap());
    assert_exact(&TableKalmanTriple::<512>::new(&model).unwrap());
    assert_exact(&SteadyKalman::new(&model).unwrap());
}
