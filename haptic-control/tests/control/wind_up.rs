//! Saturation of the large motor's current, and its effect on the state of the velocity loop.

use estimator_core::Hertz;
use haptic_control::{
    Compensated, ContinuousStage, DualStage, LoopPoles, NewtonMetres, RadPerS, RstDesign,
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
