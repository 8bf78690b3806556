//! The default device and the edge clock, which several crates describe, each in its own terms.

use estimator_core::{CoupledMotor, MotorModel};
use haptic_control::DualStage;

#[test]
fn default_devices_are_the_same() {
    let (core, control) = (CoupledMotor::DCX35L, DualStage::DEFAULT);
    assert_eq!(core.motor, MotorModel::DCX35L);
    assert_eq!(control.coupled_motor(), core);
    assert_eq!(simulation::device::Device::default().stages, control);
    assert_eq!(firmware_app::config::DEVICE, control);
}

#[test]
fn edge_clocks_are_the_same() {
    let firmware = f64::from(firmware_app::config::TIMER_HZ);
    assert_eq!(simulation::trace::EDGE_CLOCK_HZ, firmware);
    assert_eq!(bench_image::CLOCK.0, firmware);
}
