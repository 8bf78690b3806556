//! Scenario `stochastic`: a linear plant under known noise, for which an optimal filter exists.
//!
//! The handle is clamped, and the plant has no friction and no ripple. The equations of the large
//! motor, with `b`, `J`, `Kt` and `tau = 1 / (2 pi bandwidth)` of the device, are
//! ```text
//! J dw = (Kt i - b w) dt + dW        E[dW^2] = TORQUE_INTENSITY_NM2_S dt
//! tau di/dt = u - i                  u held over each tick, N(0, CURRENT_STD_A^2), white
//! ```
//! `u` is the column `current` of the trace, which an estimator reads. `dW / dt` is a random
//! torque, constant over each plant step `h`, of variance `TORQUE_INTENSITY_NM2_S / h`; no
//! estimator reads it. The count is the floor of the angle. Relative to the middle of the count,
//! the angle has an error of variance 1/12 count^2, which is nearly white while the motor moves at
//! least one count a tick.

use super::{Drive, EncoderCounts, Scenario};
use rand_distr::{Distribution, StandardNormal};
use rand_xoshiro::Xoshiro256PlusPlus;

/// Standard deviation of the commanded current, A. Each tick has an independent current.
pub const CURRENT_STD_A: f64 = 0.3;

/// Two-sided spectral density of the white torque on the large shaft, N^2.m^2.s (N^2.m^2/Hz).
pub const TORQUE_INTENSITY_NM2_S: f64 = 1e-9;

pub(super) struct Stochastic {
    random: Xoshiro256PlusPlus,
}

impl Stochastic {
    pub(super) const fn new(random: Xoshiro256PlusPlus) -> Self {
        Self { random }
    }
}

impl Scenario for Stochastic {
    fn torque_intensity(&self) -> f64 {
        TORQUE_INTENSITY_NM2_S
    }

    fn tick(&mut self, _: u64, _: EncoderCounts) -> Drive {
        let draw: f64 = StandardNormal.sample(&mut self.random);
        Drive::clamped(CURRENT_STD_A * draw, 0.0)
    }
}
