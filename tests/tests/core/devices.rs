//! The default device, the edge clock and the rates of control, which several crates describe, each in its
//! own terms.

use estimator_core::{CoupledMotor, Hertz, Imm, MotorModel};
use haptic_control::{DesignError, DualStage, LoopPoles, RstDesign};
use simulation::simulate::RATES_HZ;

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

#[test]
fn rates_of_control_are_the_same() {
    let has_loop = |rate| {
        let design = RstDesign::new(&DualStage::DEFAULT, rate, LoopPoles::DEFAULT);
        design.err() != Some(DesignError::Rate)
    };
    let has_bank = |rate| Imm::new(rate).is_ok();
    let (lowest, highest) = RATES_HZ;
    for rate in [lowest, highest].map(Hertz) {
        assert!(has_loop(rate) && has_bank(rate), "{rate:?}");
    }
    for rate in [lowest.next_down(), highest.next_up()].map(Hertz) {
        assert!(!has_loop(rate) && !has_bank(rate), "{rate:?}");
    }
}
