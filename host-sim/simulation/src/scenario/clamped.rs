//! A wanted slip over time, followed by the loop while the handle is clamped.

use super::{
    Drive, EncoderCounts, Scenario,
    servo::{Servo, Tuning},
};
use crate::device::Device;

/// Slip wanted over time.
pub(super) trait Profile {
    /// How the loop is tuned for it.
    const TUNING: Tuning = Tuning {
        bandwidth_hz: 30.0,
        integral_per_s: 0.0,
        coulomb_at_rad_s: 0.02,
    };

    /// Slip at `t`, rad/s; called with growing `t`.
    fn slip(&mut self, t: f64) -> f64;
}

/// A profile with its loop.
pub(super) struct Follow<P> {
    profile: P,
    servo: Servo,
    period: f64,
    slip: f64,
    damping_b: f64,
    fall_per_s: f64,
}

/// Follows `profile` from rest.
pub(super) fn follow<P: Profile>(profile: P, device: &Device, period_s: f64) -> Follow<P> {
    Follow {
        profile,
        servo: Servo::new(device, period_s, P::TUNING),
        period: period_s,
        slip: 0.0,
        damping_b: device.stages.damping,
        fall_per_s: 0.0,
    }
}

impl<P> Follow<P> {
    /// The coupler loses this part of its damping in 60 s, and then no more; the loop does not
    /// know.
    pub(super) fn heating(self, fall_at_60_s: f64) -> Self {
        Self {
            fall_per_s: fall_at_60_s / 60.0,
            ..self
        }
    }
}

impl<P: Profile> Scenario for Follow<P> {
    fn tick(&mut self, k: u64, seen: EncoderCounts) -> Drive {
        let next = self.profile.slip((k + 1) as f64 * self.period);
        let mean = 0.5 * (self.slip + next);
        let torque = self.damping_b * mean;
        let currents = self.servo.update(seen, self.slip, next, torque);
        self.slip = next;
        let middle = ((k as f64 + 0.5) * self.period).min(60.0);
        Drive {
            damping_part: 1.0 - self.fall_per_s * middle,
            ..Drive::clamped(currents.large_a, currents.small_a)
        }
    }
}
