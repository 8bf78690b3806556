//! Known accelerations that drive a bank.

use super::state::ModelBankState;
use crate::estimator::VelocityEstimator;
use crate::observer::{Adaptation, Correction, CurrentSource, Observer, SlipSource};
use crate::sample::{Sample, Signals};
use crate::sealed::Sealed;

/// Source of a known acceleration for a [`DrivenBank`](crate::DrivenBank).
pub trait BankInput: Sealed {
    /// State carried from tick to tick.
    type State: Clone + PartialEq;
    /// The parts of a sample that are read.
    const NEEDS: Signals;

    /// The state at the first sample.
    #[doc(hidden)]
    fn start(&self, first: &Sample) -> Self::State;

    /// The mean acceleration over the tick that ends with `sample`, counts/tick²; `None` while
    /// nothing is known. `bank` is the bank without input, before this tick.
    #[doc(hidden)]
    fn input<const K: usize>(
        &self,
        state: &mut Self::State,
        sample: &Sample,
        bank: &ModelBankState<K>,
    ) -> Option<f32>;
}

/// The acceleration that an observer predicts for each tick, before it corrects its velocity by the
/// tick's count or edge: the driven bank corrects by the same measurement.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Followed<E>(pub E);

impl<E> Sealed for Followed<E> {}

impl<C, S, M, L> BankInput for Followed<Observer<C, S, M, L>>
where
    C: CurrentSource,
    S: SlipSource,
    M: Correction,
    L: Adaptation,
{
    type State = <Observer<C, S, M, L> as VelocityEstimator>::State;
    const NEEDS: Signals = Observer::<C, S, M, L>::NEEDS;

    fn start(&self, first: &Sample) -> Self::State {
        self.0.start(first)
    }

    #[inline(always)]
    fn input<const K: usize>(
        &self,
        state: &mut Self::State,
        sample: &Sample,
        _: &ModelBankState<K>,
    ) -> Option<f32> {
        Some(self.0.advance(state, sample).predicted_change)
    }
}
