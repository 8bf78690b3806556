//! The evaluation loop: the large motor tracks a desired slip velocity, and the small motor adds
//! the desired torque that the coupler does not transmit.
//!
//! The loop reads the reference encoder (20000 counts) and the small encoder once a tick. The feed
//! forward consists of coupler torque, inertia and Coulomb friction. The feedback is proportional
//! to the difference between the desired and the measured slip velocity. The measured velocities
//! are finite differences through a first-order low-pass.

use super::EncoderCounts;
use crate::device::Device;
use std::f64::consts::TAU;

/// Cut-off of the low-pass on measured velocities, Hz.
const CUTOFF_HZ: f64 = 150.0;

/// Largest proportional gain, relative to the inertia over a period. At 2 an error returns with the opposite sign and
/// its full size; the delay of the measured velocity and the integral action lower that limit.
const LARGEST_GAIN: f64 = 1.0;

/// Parameters of a loop.
#[derive(Clone, Copy, Debug)]
pub(super) struct Tuning {
    /// Bandwidth of the slip loop, Hz, below [`CUTOFF_HZ`]. It is lower where the control rate is below 2 pi times
    /// this bandwidth.
    pub(super) bandwidth_hz: f64,
    /// Integral gain: rate at which an error of the slip angle decreases, 1/s.
    pub(super) integral_per_s: f64,
    /// Velocity from which Coulomb friction is fed forward in full, rad/s.
    pub(super) coulomb_at_rad_s: f64,
}

#[derive(Debug)]
pub(super) struct Servo {
    period: f64,
    damping: f64,
    inertia: f64,
    coulomb: f64,
    amps_per_nm_large: f64,
    amps_per_nm_small: f64,
    rad_per_reference: f64,
    rad_per_small: f64,
    gain: f64,
    tuning: Tuning,
    share: f64,
    last: Option<EncoderCounts>,
    last_slip: f64,
    error: f64,
    lag_angle: f64,
    small_omega: f64,
}

/// Currents for the next tick.
#[derive(Clone, Copy, Debug)]
pub(super) struct Currents {
    pub(super) large_a: f64,
    pub(super) small_a: f64,
}

impl Servo {
    pub(super) fn new(device: &Device, period_s: f64, tuning: Tuning) -> Self {
        Self {
            period: period_s,
            damping: device.stages.damping,
            inertia: device.stages.large.inertia,
            coulomb: device.stages.large.coulomb_friction,
            amps_per_nm_large: 1.0 / device.stages.large.torque_constant,
            amps_per_nm_small: 1.0 / device.stages.small.torque_constant,
            rad_per_reference: TAU / f64::from(device.reference.counts_per_rev),
            rad_per_small: TAU / f64::from(device.stages.small.counts_per_rev),
            gain: device.stages.large.inertia
                * (TAU * tuning.bandwidth_hz).min(LARGEST_GAIN / period_s),
            tuning,
            share: low_pass_share(CUTOFF_HZ, period_s),
            last: None,
            last_slip: 0.0,
            error: 0.0,
            lag_angle: 0.0,
            small_omega: 0.0,
        }
    }

    /// One tick: the currents for the desired slip velocity at this tick and at the next one
    /// (rad/s) and the desired torque on the handle (N.m).
    pub(super) fn update(
        &mut self,
        seen: EncoderCounts,
        slip: f64,
        next_slip: f64,
        torque: f64,
    ) -> Currents {
        self.measure(seen, slip);
        let mean = 0.5 * (slip + next_slip);
        let omega = self.small_omega + mean;
        let friction = self.coulomb * (omega / self.tuning.coulomb_at_rad_s).clamp(-1.0, 1.0);
        let drive = self.damping * mean
            + self.inertia * (next_slip - slip) / self.period
            + friction
            + self.gain * (self.error + self.tuning.integral_per_s * self.lag_angle);
        let delivered = self.damping * (mean - self.error);
        Currents {
            large_a: drive * self.amps_per_nm_large,
            small_a: (torque - delivered) * self.amps_per_nm_small,
        }
    }

    fn measure(&mut self, seen: EncoderCounts, slip: f64) {
        if let Some(last) = self.last {
            let large = displacement(seen.reference, last.reference) * self.rad_per_reference;
            let small = displacement(seen.small, last.small) * self.rad_per_small;
            let missed = 0.5 * (self.last_slip + slip) * self.period - (large - small);
            self.lag_angle += missed;
            self.error += self.share * (missed / self.period - self.error);
            self.small_omega += self.share * (small / self.period - self.small_omega);
        }
        self.last = Some(seen);
        self.last_slip = slip;
    }
}

/// Displacement from the count `from` to the count `to`, which wrap modulo 2^32.
pub(super) fn displacement(to: u32, from: u32) -> f64 {
    f64::from(to.wrapping_sub(from) as i32)
}

/// Weight of the newest sample in a first-order low-pass.
pub(super) fn low_pass_share(cutoff_hz: f64, period_s: f64) -> f64 {
    -(-TAU * cutoff_hz * period_s).exp_m1()
}
