//! Scenarios with a clamped handle: the evaluation loop tracks a slip velocity over time.

use super::{
    Drive, EncoderCounts, Scenario,
    servo::{Servo, Tuning},
};
use crate::device::Device;

/// A slip velocity over time, the reference of the evaluation loop.
pub(super) trait Profile {
    /// Parameters of the loop that tracks this profile.
    const TUNING: Tuning = Tuning {
        bandwidth_hz: 30.0,
        integral_per_s: 0.0,
        coulomb_at_rad_s: 0.02,
    };

    /// Slip velocity at `t` (s), rad/s. Callers pass increasing `t`.
    fn slip(&mut self, t: f64) -> f64;
}

/// A slip profile and the loop that tracks it.
pub(super) struct Follow<P> {
    profile: P,
    servo: Servo,
    period: f64,
    slip: f64,
    damping_b: f64,
    fall_per_s: f64,
}

/// The scenario that tracks `profile` from rest.
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
    /// The same profile on a coupler whose damping falls linearly by `fall_at_60_s` of its initial
    /// value within 60 s and is constant afterwards. The loop keeps the initial value.
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

#[cfg(test)]
mod tests {
    use super::*;

    /// A slip of 2 rad/s that rises by 5 rad/s each second.
    struct Ramp;

    impl Profile for Ramp {
        fn slip(&mut self, t: f64) -> f64 {
            2.0 + 5.0 * t
        }
    }

    const PERIOD_S: f64 = 1e-3;

    const STILL: EncoderCounts = EncoderCounts {
        reference: 0,
        small: 0,
    };

    /// The torque on the handle is the damping times the mean slip of the tick, so that the small motor
    /// adds what the lag of the large one leaves.
    #[test]
    fn each_tick_asks_for_the_slip_of_its_ends_and_the_torque_of_their_mean() {
        let device = Device::default();
        let damping = device.stages.damping;
        let mut follow = follow(Ramp, &device, PERIOD_S);
        let mut servo = Servo::new(&device, PERIOD_S, Ramp::TUNING);
        for (k, [slip, next, mean]) in [
            [0.0, 2.005, 1.0025],
            [2.005, 2.01, 2.0075],
            [2.01, 2.015, 2.0125],
        ]
        .into_iter()
        .enumerate()
        {
            let drive = follow.tick(k as u64, STILL);
            let expected = servo.update(STILL, slip, next, damping * mean);
            let [large, small] = [
                drive.large_a - expected.large_a,
                drive.small_a - expected.small_a,
            ];
            assert!(
                large.abs() < 1e-12 && small.abs() < 1e-12,
                "tick {k}: {large} {small}"
            );
            assert_eq!(drive.damping_part, 1.0);
        }
    }

    #[test]
    fn damping_falls_until_60_s() {
        let mut follow = follow(Ramp, &Device::default(), PERIOD_S).heating(0.3);
        for (k, part) in [
            (0, 1.0 - 0.005 * 0.0005),
            (1, 1.0 - 0.005 * 0.0015),
            (29_999, 1.0 - 0.005 * 29.9995),
            (60_000, 0.7),
            (500_000, 0.7),
        ] {
            let drive = follow.tick(k, STILL);
            assert!(
                (drive.damping_part - part).abs() < 1e-12,
                "{k}: {}",
                drive.damping_part
            );
        }
    }
}
