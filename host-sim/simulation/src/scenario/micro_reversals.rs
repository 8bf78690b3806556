//! Scenario `micro-reversals`: reversals of the motion within a few counts.

use super::{Drive, EncoderCounts, Scenario, draw};
use crate::device::Device;
use rand_xoshiro::Xoshiro256PlusPlus;
use std::f64::consts::TAU;

/// Frequencies, Hz. They are whole numbers, so that every second begins and ends at rest.
const FREQUENCIES_HZ: (u32, u32) = (2, 8);
/// Distance between two reversals, counts of the large encoder.
const SPAN_COUNTS: (f64, f64) = (1.0, 8.0);

/// In each second a sine of velocity with drawn frequency f and span s,
/// ```text
/// position = s (1 - cos(2 π f t)) / 2        velocity = π f s sin(2 π f t)
/// ```
/// from the current that the frictionless motor needs for it, `(J dω/dt + b ω) / Kt`, open loop.
pub(super) struct MicroReversals {
    random: Xoshiro256PlusPlus,
    period: f64,
    rad_per_count: f64,
    inertia: f64,
    damping: f64,
    amps_per_nm: f64,
    seconds: u64,
    /// Angular frequency, rad/s, and amplitude of the velocity, rad/s.
    angular: f64,
    amplitude: f64,
}

impl MicroReversals {
    pub(super) fn new(device: &Device, period_s: f64, random: Xoshiro256PlusPlus) -> Self {
        let large = &device.stages.large;
        Self {
            random,
            period: period_s,
            rad_per_count: TAU / f64::from(large.counts_per_rev),
            inertia: large.inertia,
            damping: device.stages.damping,
            amps_per_nm: 1.0 / large.torque_constant,
            seconds: 0,
            angular: 0.0,
            amplitude: 0.0,
        }
    }

    /// Draws the motion of the next second.
    fn next(&mut self) {
        let (low, high) = FREQUENCIES_HZ;
        let hertz = draw(&mut self.random, f64::from(low), f64::from(high + 1)).floor();
        let span = draw(&mut self.random, SPAN_COUNTS.0, SPAN_COUNTS.1) * self.rad_per_count;
        self.seconds += 1;
        self.angular = TAU * hertz;
        self.amplitude = 0.5 * span * self.angular;
    }
}

impl Scenario for MicroReversals {
    fn tick(&mut self, k: u64, _: EncoderCounts) -> Drive {
        // The current is constant over the tick: the value for its middle.
        let t = (k as f64 + 0.5) * self.period;
        while t >= self.seconds as f64 {
            self.next();
        }
        let (sine, cosine) = (self.angular * t).sin_cos();
        let torque = self.amplitude * (self.inertia * self.angular * cosine + self.damping * sine);
        Drive::clamped(torque * self.amps_per_nm, 0.0)
    }
}
