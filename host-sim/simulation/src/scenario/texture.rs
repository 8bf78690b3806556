//! Scenario `texture`: the device renders a vibration while the hand moves slowly.

use super::{
    Drive, EncoderCounts, Scenario, draw,
    hand::{Intent, TUNING},
    servo::{Servo, low_pass_share},
};
use crate::device::Device;
use crate::plant::Pose;
use rand_xoshiro::Xoshiro256PlusPlus;
use std::f64::consts::TAU;

/// Amplitude, N.m.
const TORQUE: f64 = 6e-3;
const LOWEST_HZ: f64 = 50.0;
const HIGHEST_HZ: f64 = 300.0;
/// Frequency above which the small motor renders most of the torque, Hz.
const CROSSOVER_HZ: f64 = 100.0;

/// A sine torque whose frequency varies between 50 and 300 Hz. The logarithm of the frequency is a
/// sine with a period of 2 to 4 s.
pub(super) struct Texture {
    intent: Intent,
    servo: Servo,
    period: f64,
    damping: f64,
    share: f64,
    sweep_rad_per_s: f64,
    sweep_phase: f64,
    turns: f64,
    torque: f64,
    slip: f64,
}

impl Texture {
    pub(super) fn new(device: &Device, period_s: f64, mut random: Xoshiro256PlusPlus) -> Self {
        let intent = Intent::about(draw(&mut random, -0.5, 0.5), period_s)
            .sine(&mut random, (0.2, 0.5), (0.2, 0.4))
            .tremor(&mut random);
        Self {
            intent,
            servo: Servo::new(device, period_s, TUNING),
            period: period_s,
            damping: device.stages.damping,
            share: low_pass_share(CROSSOVER_HZ, period_s),
            sweep_rad_per_s: TAU / draw(&mut random, 2.0, 4.0),
            sweep_phase: draw(&mut random, 0.0, TAU),
            turns: draw(&mut random, 0.0, 1.0),
            torque: 0.0,
            slip: 0.0,
        }
    }

    /// Desired torque at the end of tick `k`, N.m.
    fn next_torque(&mut self, k: u64) -> f64 {
        let middle = (k as f64 + 0.5) * self.period;
        let along = 0.5 + 0.5 * (self.sweep_rad_per_s * middle + self.sweep_phase).sin();
        let hz = LOWEST_HZ * (HIGHEST_HZ / LOWEST_HZ).powf(along);
        self.turns = (self.turns + hz * self.period).fract();
        TORQUE * (TAU * self.turns).sin()
    }
}

impl Scenario for Texture {
    fn start(&self) -> Pose {
        self.intent.start()
    }

    fn tick(&mut self, k: u64, seen: EncoderCounts) -> Drive {
        let next_torque = self.next_torque(k);
        let torque = 0.5 * (self.torque + next_torque);
        let next_slip = self.slip + self.share * (next_torque / self.damping - self.slip);
        let currents = self.servo.update(seen, self.slip, next_slip, torque);
        self.torque = next_torque;
        self.slip = next_slip;
        Drive {
            grip: self.intent.grip(k),
            ..Drive::clamped(currents.large_a, currents.small_a)
        }
    }
}

#[cfg(test)]
mod tests {
    use rand_xoshiro::rand_core::SeedableRng;

    use super::*;

    #[test]
    fn frequency_passes_its_whole_range_in_each_sweep() {
        for seed in 1..=5 {
            let period_s = 1e-4;
            let random = Xoshiro256PlusPlus::seed_from_u64(seed);
            let mut texture = Texture::new(&Device::default(), period_s, random);
            let ticks = (TAU / texture.sweep_rad_per_s / period_s) as u64;
            let mut hz = |k: u64| {
                let before = texture.turns;
                texture.next_torque(k);
                (texture.turns - before).rem_euclid(1.0) / period_s
            };
            let frequencies: Vec<f64> = (0..ticks).map(&mut hz).collect();
            let lowest = frequencies.iter().fold(f64::INFINITY, |a, b| a.min(*b));
            let highest = frequencies.iter().fold(0.0, |a: f64, b| a.max(*b));
            assert!((lowest / LOWEST_HZ - 1.0).abs() < 1e-3, "{seed}: {lowest}");
            assert!(
                (highest / HIGHEST_HZ - 1.0).abs() < 1e-3,
                "{seed}: {highest}"
            );
        }
    }
}
