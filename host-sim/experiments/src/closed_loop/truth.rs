//! The true velocity in the place of an estimate.

use std::cell::Cell;

use estimator_core::{CountsPerTick, Sample, Signals, VelocityEstimator};

/// An estimator without error: the simulation writes the true velocity, counts per tick, before each
/// tick.
pub(super) struct TrueVelocity<'a>(pub(super) &'a Cell<f32>);

impl VelocityEstimator for TrueVelocity<'_> {
    type State = ();
    const NEEDS: Signals = Signals::COUNT;

    fn start(&self, _: &Sample) {}

    fn update(&self, (): &mut (), _: &Sample) -> CountsPerTick {
        CountsPerTick(self.0.get())
    }
}
