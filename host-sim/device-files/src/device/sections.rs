//! The sections and keys of a device file.

use estimator_core::Hertz;
use haptic_control::{DualStage, Motor};
use serde::{Deserialize, Serialize};

use super::{Device, Disc, Hand, Handle, Interval, Reference, Ripple};

/// A device file.
#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub(super) struct File {
    large: MotorSection,
    small: MotorSection,
    coupler: Coupler,
    amplifier: Amplifier,
    hand: Hand,
    handle: Handle,
    interval: Interval,
    disc: Disc,
    reference: Reference,
}

/// A motor. Each key is optional because the defaults of the two motors differ.
#[derive(Clone, Copy, Serialize, Deserialize)]
#[serde(deny_unknown_fields, expecting = "a section with a motor's keys")]
struct MotorSection {
    inertia_kg_m2: Option<f64>,
    torque_constant_nm_per_a: Option<f64>,
    coulomb_nm: Option<f64>,
    coulomb_ripple: Option<f64>,
    torque_ripple: Option<f64>,
    ripple_per_rev: Option<f64>,
    counts_per_rev: Option<u32>,
    current_limit_a: Option<f64>,
    continuous_current_a: Option<f64>,
    winding_time_constant_s: Option<f64>,
}

/// The coupler: torque is damping times slip velocity.
#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
struct Coupler {
    /// Damping of the cold coupler, N.m.s/rad.
    damping_nms_per_rad: f64,
    fall_at_60_s: f64,
}

/// Both current amplifiers, a first-order lag each.
#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
struct Amplifier {
    /// Frequency at -3 dB, Hz.
    bandwidth_hz: f64,
}

impl MotorSection {
    fn of(motor: &Motor, ripple: &Ripple) -> Self {
        Self {
            inertia_kg_m2: Some(motor.inertia),
            torque_constant_nm_per_a: Some(motor.torque_constant),
            coulomb_nm: Some(motor.coulomb_friction),
            coulomb_ripple: Some(ripple.friction),
            torque_ripple: Some(ripple.torque),
            ripple_per_rev: Some(ripple.per_rev),
            counts_per_rev: Some(motor.counts_per_rev),
            current_limit_a: Some(motor.current_limit),
            continuous_current_a: Some(motor.continuous_current),
            winding_time_constant_s: Some(motor.winding_time_constant),
        }
    }

    /// Replaces the defaults by the values of this section.
    fn over(self, motor: &Motor, ripple: &Ripple) -> (Motor, Ripple) {
        let motor = Motor {
            inertia: self.inertia_kg_m2.unwrap_or(motor.inertia),
            torque_constant: self
                .torque_constant_nm_per_a
                .unwrap_or(motor.torque_constant),
            coulomb_friction: self.coulomb_nm.unwrap_or(motor.coulomb_friction),
            counts_per_rev: self.counts_per_rev.unwrap_or(motor.counts_per_rev),
            current_limit: self.current_limit_a.unwrap_or(motor.current_limit),
            continuous_current: self
                .continuous_current_a
                .unwrap_or(motor.continuous_current),
            winding_time_constant: self
                .winding_time_constant_s
                .unwrap_or(motor.winding_time_constant),
        };
        let ripple = Ripple {
            friction: self.coulomb_ripple.unwrap_or(ripple.friction),
            torque: self.torque_ripple.unwrap_or(ripple.torque),
            per_rev: self.ripple_per_rev.unwrap_or(ripple.per_rev),
        };
        (motor, ripple)
    }
}

impl Default for File {
    fn default() -> Self {
        Device::default().into()
    }
}

impl Default for Coupler {
    fn default() -> Self {
        File::default().coupler
    }
}

impl Default for Amplifier {
    fn default() -> Self {
        File::default().amplifier
    }
}

impl From<Device> for File {
    fn from(device: Device) -> Self {
        let stages = &device.stages;
        Self {
            large: MotorSection::of(&stages.large, &device.large_ripple),
            small: MotorSection::of(&stages.small, &device.small_ripple),
            coupler: Coupler {
                damping_nms_per_rad: stages.damping,
                fall_at_60_s: device.fall_at_60_s,
            },
            amplifier: Amplifier {
                bandwidth_hz: stages.amplifier_bandwidth.0,
            },
            hand: device.hand,
            handle: device.handle,
            interval: device.interval,
            disc: device.disc,
            reference: device.reference,
        }
    }
}

impl From<File> for Device {
    fn from(file: File) -> Self {
        let default = Self::default();
        let (large, large_ripple) = file
            .large
            .over(&default.stages.large, &default.large_ripple);
        let (small, small_ripple) = file
            .small
            .over(&default.stages.small, &default.small_ripple);
        Self {
            stages: DualStage {
                large,
                small,
                damping: file.coupler.damping_nms_per_rad,
                amplifier_bandwidth: Hertz(file.amplifier.bandwidth_hz),
            },
            large_ripple,
            small_ripple,
            fall_at_60_s: file.coupler.fall_at_60_s,
            hand: file.hand,
            handle: file.handle,
            interval: file.interval,
            disc: file.disc,
            reference: file.reference,
        }
    }
}
