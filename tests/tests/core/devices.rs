//! The default device and the edge clock, which several crates describe, each in its own terms.

use estimator_core::{CoupledMotor, Device};
use haptic_control::DualStage;
use simulation::device;

#[test]
fn default_devices_are_the_same() {
    let (core, control) = (CoupledMotor::DCX35L, DualStage::DEFAULT);
    let host = device::Device::default();
    assert_eq!(core.large, Device::DCX35L);
    assert_eq!(control.coupled_motor(), core);
    assert_eq!(host.coupler.damping_nms_per_rad, control.damping);
    assert_eq!(host.amplifier.bandwidth_hz, control.amplifier.0);
    for (host, control) in [(host.large, control.large), (host.small, control.small)] {
        assert_eq!(host.inertia_kg_m2, control.inertia);
        assert_eq!(host.torque_constant_nm_per_a, control.torque_constant);
        assert_eq!(host.coulomb_nm, control.coulomb);
        assert_eq!(host.counts_per_rev, control.counts_per_rev);
        assert_eq!(host.current_limit_a, control.current_limit);
    }
}

#[test]
fn edge_clocks_are_the_same() {
    let firmware = f64::from(firmware_app::config::TIMER_HZ);
    assert_eq!(simulation::trace::EDGE_CLOCK_HZ, firmware);
    assert_eq!(bench_image::CLOCK.0, firmware);
}
