//! The prediction of one tick, and the innovation that its measurement gives.

/// Predicted motion over one tick.
#[derive(Clone, Copy, Debug)]
pub struct Prediction {
    /// Position at the last sample, from the middle of the newest quantisation interval, counts.
    pub(super) from: f32,
    /// Displacement over the tick, counts.
    pub(super) displacement: f32,
    /// Change of the velocity over the tick, counts/tick.
    pub(super) velocity_change: f32,
    /// Whether friction holds the rotor at the end of the tick.
    pub(super) stuck: bool,
}

/// Innovation of one tick: the measured position less the predicted one.
#[derive(Clone, Copy, Debug)]
pub struct Innovation {
    /// Measured less predicted position, counts.
    pub(super) error: f32,
    /// Part of the tick that had passed since the measurement, 0 to 1.
    pub(super) age: f32,
    /// Gain of the position at the time of the measurement, 0 to 1.
    pub(super) position_gain: f32,
    /// Time since the last innovation, ticks; zero if the instant of this one is not known.
    pub(super) gap: f32,
    /// The same time, also if the instant is not known.
    pub(super) waited: f32,
}
