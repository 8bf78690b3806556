//! The interface of a scenario.

use crate::plant::{Grip, Pose};

/// The counts that a scenario's own loop reads at a tick. The count of an encoder that the loop
/// does not read is zero.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct EncoderCounts {
    /// Reference encoder on the large motor, counts modulo 2^32.
    pub(crate) reference: u32,
    /// Small encoder, counts modulo 2^32.
    pub(crate) small: u32,
}

/// The inputs of the plant over one tick.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Drive {
    /// Command to the large motor, A.
    pub(crate) large_a: f64,
    /// Command to the small motor, A.
    pub(crate) small_a: f64,
    /// Grip of the hand or the clamp on the handle.
    pub(crate) grip: Grip,
    /// Damping b of the coupler, as a fraction of the device's.
    pub(crate) damping_part: f64,
}

impl Drive {
    /// Currents, with the handle clamped and the coupler's damping as the device has it.
    pub(crate) const fn clamped(large_a: f64, small_a: f64) -> Self {
        Self {
            large_a,
            small_a,
            grip: Grip::Clamped,
            damping_part: 1.0,
        }
    }
}

/// State of one run of a scenario.
pub(crate) trait Scenario {
    /// Pose of the handle at the start.
    fn start(&self) -> Pose {
        Pose::default()
    }

    /// Intensity of a white torque on the large shaft, N^2.m^2.s (two-sided spectral density).
    fn torque_intensity(&self) -> f64 {
        0.0
    }

    /// The inputs over tick `k`, from the counts at its start. Callers pass `k` = 0, 1, 2, ...
    fn tick(&mut self, k: u64, counts: EncoderCounts) -> Drive;
}
