//! Sensitivity of the observer's state to one parameter, through ticks and corrections.

use super::gain::Gain;
use super::innovation::Innovation;
use super::inputs::TickInput;
use super::motion::{Motion, Step};

/// One tick, as [`Adaptation::propagate`](super::Adaptation::propagate) needs it.
pub struct Tick<'a> {
    pub(super) motion: &'a Motion,
    /// Acceleration by the current.
    pub(super) input: TickInput,
    /// Displacement of the coupled shaft, counts of the motor's encoder.
    pub(super) coupled: f32,
    /// Velocity before the tick, counts/tick.
    pub(super) before: f32,
    pub(super) step: &'a Step,
    pub(super) disturbance_decay: f32,
}

/// One correction, as [`Adaptation::update`](super::Adaptation::update) needs it.
pub struct Update<'a> {
    pub(super) innovation: &'a Innovation,
    pub(super) gain: &'a Gain,
    /// Error of the innovation, limited to its range, counts.
    pub(super) error: f32,
    /// Whether every tick may have an innovation.
    pub(super) dense: bool,
    /// Whether the model does not explain the innovation, and the gain is another one for it.
    pub(super) unexplained: bool,
    /// Gain of the position at the tick's end.
    pub(super) position_gain: f32,
    /// Velocity after the correction, counts/tick.
    pub(super) velocity: f32,
}

/// Sensitivity of position, velocity and disturbance to one relative parameter error.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Sensitivity {
    pub(super) position: f32,
    pub(super) velocity: f32,
    pub(super) disturbance: f32,
}

impl Sensitivity {
    /// The sensitivity after a tick; `regressor` is the acceleration per relative parameter error,
    /// `rests` whether the rotor is at rest for every parameter near the present one.
    #[inline(always)]
    pub(super) fn propagated(self, regressor: f32, rests: bool, tick: &Tick<'_>) -> Self {
        let motion = tick.motion;
        let disturbance = self.disturbance * tick.disturbance_decay;
        if rests {
            return Self {
                position: self.position + 0.5 * motion.phi1 * self.velocity,
                velocity: 0.0,
                disturbance,
            };
        }
        let force = regressor + self.disturbance;
        Self {
            position: self.position + motion.phi1 * self.velocity + motion.phi2 * force,
            velocity: motion.phi0 * self.velocity + motion.phi1 * force,
            disturbance,
        }
    }

    /// Sensitivity of the position at the instant of the measurement.
    #[inline(always)]
    pub(super) fn at_edge(self, innovation: &Innovation) -> f32 {
        self.position - innovation.age * self.velocity
    }

    /// The sensitivity after a correction whose innovation has the sensitivity `-h`.
    #[inline(always)]
    pub(super) fn corrected(self, update: &Update<'_>, h: f32) -> Self {
        Self {
            position: self.position - update.position_gain * h,
            velocity: self.velocity - update.gain.velocity * h,
            disturbance: self.disturbance - update.gain.disturbance * h,
        }
    }
}
