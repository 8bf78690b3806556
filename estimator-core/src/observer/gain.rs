//! The gain of one correction.

use crate::memory::memory;

/// Gain of one correction: the change of each state per count of innovation.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(C)]
pub struct Gain {
    /// Gain of the position, a pure number.
    pub position: f32,
    /// Gain of the velocity, counts/tick per count.
    pub velocity: f32,
    /// Gain of the disturbance, counts/tick² per count.
    pub disturbance: f32,
    /// Variance of the innovation, counts².
    pub variance: f32,
}

memory!(Gain {
    position,
    velocity,
    disturbance,
    variance
});
