//! The constants of the device.

use estimator_core::Hertz;
use haptic_control::{DesignError, DualStage};

use crate::bench::DEVICE;

/// Every constant of the device, as a way to set it.
const CONSTANTS: [fn(&mut DualStage, f64); 14] = [
    |device, value| device.large.inertia = value,
    |device, value| device.large.torque_constant = value,
    |device, value| device.large.current_limit = value,
    |device, value| device.small.inertia = value,
    |device, value| device.small.torque_constant = value,
    |device, value| device.small.current_limit = value,
    |device, value| device.large.continuous_current = value,
    |device, value| device.small.continuous_current = value,
    |device, value| device.large.winding_time_constant = value,
    |device, value| device.small.winding_time_constant = value,
    |device, value| device.damping = value,
    |device, value| device.amplifier_bandwidth = Hertz(value),
    |device, value| device.large.coulomb_friction = value,
    |device, value| device.small.coulomb_friction = value,
];

#[test]
fn device_constants_must_be_finite_and_positive_and_friction_not_negative() {
    assert_eq!(DEVICE.checked(), Ok(DEVICE));
    let refused = Err(DesignError::Device);
    for (i, set) in CONSTANTS.iter().enumerate() {
        let with = |value| {
            let mut device = DEVICE;
            set(&mut device, value);
            device.checked().map(|_| ())
        };
        for value in [-1e-9, f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
            assert_eq!(with(value), refused.map(|_: DualStage| ()), "{i} {value}");
        }
        let is_friction = i >= 12;
        assert_eq!(with(0.0).is_ok(), is_friction, "{i}");
        assert!(with(1e-9).is_ok(), "{i}");
    }
    let mut device = DEVICE;
    device.large.counts_per_rev = 0;
    assert_eq!(device.checked(), refused);
    device = DEVICE;
    device.small.counts_per_rev = 0;
    assert_eq!(device.checked(), refused);
}

/// A recording is that of the device with its constants and of no other one.
#[test]
fn fingerprint_depends_on_every_constant() {
    let mut devices = vec![DEVICE];
    for set in CONSTANTS {
        let mut device = DEVICE;
        set(&mut device, 0.123);
        devices.push(device);
    }
    for (large, small) in [(1, 0), (0, 1)] {
        let mut device = DEVICE;
        device.large.counts_per_rev += large;
        device.small.counts_per_rev += small;
        devices.push(device);
    }
    for (i, device) in devices.iter().enumerate() {
        for other in &devices[i + 1..] {
            assert_ne!(device.fingerprint(), other.fingerprint(), "{other:?}");
        }
    }
}

#[test]
fn observer_uses_the_same_device() {
    let motor = DEVICE.coupled_motor();
    assert_eq!(motor.motor.counts_per_rev, DEVICE.large.counts_per_rev);
    assert_eq!(motor.motor.inertia, DEVICE.large.inertia);
    assert_eq!(motor.motor.damping, DEVICE.damping);
    assert_eq!(motor.motor.torque_constant, DEVICE.large.torque_constant);
    assert_eq!(motor.coulomb_friction, DEVICE.large.coulomb_friction);
    assert_eq!(motor.coupled_counts_per_rev, DEVICE.small.counts_per_rev);
    // A bandwidth of 2 kHz is a lag of 79.6 us.
    assert!((motor.amplifier_lag * std::f64::consts::TAU * 2000.0 - 1.0).abs() < 1e-12);
}
