//! The true motion of a shaft in the place of an estimate.

use std::cell::Cell;

use estimator_core::{
    AccelerationEstimator, CountsPerTick, CountsPerTickSquared, Sample, Signals, VelocityEstimator,
};

/// Velocity and acceleration of a shaft, which the simulation writes before each tick.
#[derive(Default)]
pub(super) struct Truth {
    velocity: Cell<f32>,
    acceleration: Cell<f32>,
}

impl Truth {
    /// Sets the velocity, rad/s, and the acceleration, rad/s², at a tick of `period_s` for an encoder with
    /// this velocity of a count per tick, rad/s.
    pub(super) fn set(&self, omega: f64, acceleration: f64, per_count: f64, period_s: f64) {
        self.velocity.set((omega / per_count) as f32);
        let per_tick = acceleration * period_s / per_count;
        self.acceleration.set(per_tick as f32);
    }
}

/// An estimator without error.
pub(super) struct TrueMotion<'a>(pub(super) &'a Truth);

impl VelocityEstimator for TrueMotion<'_> {
    type State = ();
    const NEEDS: Signals = Signals::COUNT;

    fn start(&self, _: &Sample) {}

    fn update(&self, (): &mut (), _: &Sample) -> CountsPerTick {
        CountsPerTick(self.0.velocity.get())
    }
}

impl AccelerationEstimator for TrueMotion<'_> {
    fn acceleration(&self, (): &()) -> CountsPerTickSquared {
        CountsPerTickSquared(self.0.acceleration.get())
    }
}
