//! Correction of an observer by its measurements.

use core::borrow::Borrow;

use super::gain::Gain;
use super::innovation::{Innovation, Prediction};
use crate::sample::{Sample, Signals};
use crate::sealed::Sealed;

/// Source of an observer's innovations: [`CountUpdate`](super::CountUpdate),
/// [`QuantisedUpdate`](super::QuantisedUpdate) or [`EdgeUpdate`](super::EdgeUpdate).
///
/// This trait is sealed: only types of this crate implement it.
pub trait Correction: Copy + Sealed {
    /// State of the correction, carried from tick to tick.
    type State: Clone + PartialEq;
    /// The gain of an innovation, owned or borrowed from a table.
    type Gain<'a>: Borrow<Gain>
    where
        Self: 'a;
    /// The parts of a sample that the correction reads besides the count.
    const NEEDS: Signals;
    /// Whether every tick may have an innovation. Without time stamps few ticks have one.
    const DENSE: bool;

    /// The state at the first sample.
    fn start(&self) -> Self::State;

    /// Variance of the velocity, (counts/tick)², if the model's parameters are right.
    fn velocity_variance(&self, state: &Self::State) -> f32;

    /// The innovation of this tick and its gain; `None` if the measurement agrees with the
    /// prediction.
    fn innovation<'a>(
        &'a self,
        state: &mut Self::State,
        prediction: Prediction,
        sample: &Sample,
    ) -> Option<(Innovation, Self::Gain<'a>)>;
}

/// Displacement from `position` to the nearest end of the quantisation interval ±1/2; `None` if the
/// position is inside.
#[inline(always)]
pub(super) fn excess(position: f32) -> Option<f32> {
    if position.abs() > 0.5 {
        let boundary = if position > 0.0 { 0.5 } else { -0.5 };
        Some(boundary - position)
    } else {
        None
    }
}
