//! Saturation of the large motor's current, and its effect on the state of the velocity loop.

use estimator_core::{Amps, Hertz};
use haptic_control::{
    Compensated, ContinuousStage, CurrentScale, Currents, DualStage, LoopPoles, NewtonMetres,
    RadPerS, RstDesign,
};

/// Currents behind so many ticks at the limit against a large motor that is held: the wanted torque
/// turns round.
fn turned(saturated: u32) -> Vec<f32> {
    let device = DualStage::DEFAULT;
    let design = RstDesign::new(&device, Hertz(1e3), LoopPoles::DEFAULT).unwrap();
    let stage = ContinuousStage::new(&device, &design, 1e3);
    let held = RadPerS(0.0);
    let following = Compensated::following(held);
    let mut state = stage.start(held);
    let mut current = |torque: f32| {
        let driven = stage.update(&mut state, NewtonMetres(torque), held, held, &following);
        driven.current.get()
    };
    for _ in 0..saturated {
        current(0.1);
    }
    assert_eq!(f64::from(current(0.1)), device.large.current_limit);
    (0..200).map(|_| current(-0.1)).collect()
}

/// The loop is given the limited current, so that time at the limit does not change its state.
#[test]
fn time_at_the_limit_does_not_wind_up() {
    let [short, long] = [300, 6000].map(turned);
    for (tick, (short, long)) in short.iter().zip(&long).enumerate() {
        assert!((short - long).abs() < 1e-3, "{tick}: {short} A, {long} A");
    }
    let last = f64::from(*long.last().unwrap());
    assert_eq!(last, -DualStage::DEFAULT.large.current_limit);
}

/// The loop is told what the limit removes, without the current that is fed forward.
#[test]
fn limit_that_removes_little_changes_the_current_by_little() {
    let device = DualStage::DEFAULT;
    let design = RstDesign::new(&device, Hertz(1e3), LoopPoles::DEFAULT).unwrap();
    let stage = ContinuousStage::new(&device, &design, 1e3);
    // Both motors turn at one speed, so that the regulator has no error.
    let speed = RadPerS(50.0);
    let following = Compensated::following(speed);
    let mut state = stage.start(speed);
    let mut currents = |ticks: u32, largest: Amps| {
        let bounds = Currents {
            large: largest,
            small: Amps::ZERO,
        };
        stage.scale(&mut state, CurrentScale::FULL.bounded(bounds));
        let mut current = |_| {
            let driven = stage.update(&mut state, NewtonMetres(0.0), speed, speed, &following);
            driven.current.get()
        };
        (0..ticks).map(&mut current).collect::<Vec<_>>()
    };
    let even = *currents(500, Amps::new(6.0)).last().unwrap();
    let removed = 1e-3;
    let limited = currents(500, Amps::new(even - removed));
    assert!(limited.iter().all(|current| *current <= even - removed));
    for current in limited.into_iter().chain(currents(500, Amps::new(6.0))) {
        assert!((current - even).abs() < 2.0 * removed, "{current} {even}");
    }
}
