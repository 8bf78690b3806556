//! Scenario `wall`: a hand pushes into a virtual wall and leaves it again.

use super::{
    Drive, EncoderCounts, Scenario, draw,
    hand::{Intent, TUNING},
    servo::{Servo, displacement, low_pass_share},
};
use crate::device::Device;
use crate::plant::Pose;
use rand_xoshiro::Xoshiro256PlusPlus;
use std::f64::consts::TAU;

/// Stiffness of the wall, N.m/rad.
const STIFFNESS: f64 = 0.30;
/// Angle at which the wall begins, rad.
const SURFACE: f64 = 0.10;
/// Frequency above which the small motor renders most of the torque, Hz.
const CROSSOVER_HZ: f64 = 40.0;

pub(super) struct Wall {
    intent: Intent,
    servo: Servo,
    damping: f64,
    rad_per_count: f64,
    share: f64,
    home: Option<u32>,
    slip: f64,
}

impl Wall {
    pub(super) fn new(device: &Device, period_s: f64, mut random: Xoshiro256PlusPlus) -> Self {
        // The phase is that of a start away from the wall. The centre is before the wall, and the
        // amplitude reaches into it.
        let intent = Intent::about(draw(&mut random, 0.05, 0.10), period_s)
            .sine_from(&mut random, (0.4, 1.2), (0.12, 0.18), (-2.2, -0.9))
            .tremor(&mut random);
        Self {
            intent,
            servo: Servo::new(device, period_s, TUNING),
            damping: device.stages.damping,
            rad_per_count: TAU / f64::from(device.stages.small.counts_per_rev),
            share: low_pass_share(CROSSOVER_HZ, period_s),
            home: None,
            slip: 0.0,
        }
    }
}

impl Scenario for Wall {
    fn start(&self) -> Pose {
        self.intent.start()
    }

    fn tick(&mut self, k: u64, seen: EncoderCounts) -> Drive {
        // The loop knows the initial angle, as a device that was homed before the run.
        let home = *self.home.get_or_insert(seen.small);
        let angle = self.intent.start().angle + displacement(seen.small, home) * self.rad_per_count;
        let torque = -STIFFNESS * (angle - SURFACE).max(0.0);
        let next = self.slip + self.share * (torque / self.damping - self.slip);
        let currents = self.servo.update(seen, self.slip, next, torque);
        self.slip = next;
        Drive {
            grip: self.intent.grip(k),
            ..Drive::clamped(currents.large_a, currents.small_a)
        }
    }
}
