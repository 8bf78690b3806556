//! A bank beside another one that knows a part of the acceleration.

use super::input::BankInput;
use super::state::root;
use super::{
    Evidence, Followed, ImmAdaptive, ImmAdaptiveEdge, ImmMotor, ImmMotorEdge, LearnedCurrent,
    ModelBank, ModelBankState, NoStamps, Stamped, Stamps,
};
use crate::confidence::{Confidence, Variance};
use crate::design::DesignError;
use crate::estimator::{AccelerationEstimator, VelocityEstimator};
use crate::memory::{Memory, memory};
use crate::observer::{AdaptiveEdgeObserver, AdaptiveObserver};
use crate::sample::{Sample, Signals};
use crate::units::{CountsPerTick, CountsPerTickSquared, Hertz};

/// Number of members of the driven bank.
const DRIVEN: usize = 2;

/// A bank of three members beside a driven bank of two, whose members know a part u of the
/// acceleration. The output is the mean of both banks, weighted by their probabilities:
/// ```text
/// driven     as ModelBank, but x_0 += u/2  x_1 += u  after the prediction
/// weight     p += (1 - p) c_to - p c_from
///            p = p L_driven / (p L_driven + (1 - p) L_plain)
/// output     v = (1 - p) v_plain + p v_driven
/// ```
/// L is the likelihood that a bank found for the edge or for the quantisation interval: the sum over
/// its members of weight times likelihood. A wrong u makes the driven bank improbable: the output is then
/// that of the plain bank, [`Imm`](crate::Imm). While the input knows nothing, the driven bank does not run;
/// it begins with the two neighbouring members of the plain bank that have the larger weights.
///
/// An edge of age t is compared with the position at its instant, `x_0 - t x_1 + t² (x_2 + u) / 2`.
///
/// The input u comes from a [`BankInput`]: [`LearnedCurrent`] learns the effect of the motor current, with
/// `c_to` and `c_from` 5 a second; [`Followed`] takes the acceleration that an observer predicts, whose
/// model of the device may be wrong, with 20 and 0.1 a second.
///
/// Units: counts and ticks. Valid for the rates of [`ModelBank`].
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(C)]
pub struct DrivenBank<S, I> {
    plain: ModelBank<3, S>,
    driven: ModelBank<DRIVEN, S>,
    input: I,
    /// Probabilities that the driven bank becomes the better one in a tick, or no longer is.
    towards: f32,
    away: f32,
}

memory!([S: Memory, I: Memory] DrivenBank<S, I> { plain, driven, input, towards, away });

/// State of a [`DrivenBank`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DrivenBankState<I> {
    plain: ModelBankState<3>,
    driven: ModelBankState<DRIVEN>,
    input: I,
    probability: f32,
}

impl<I> DrivenBankState<I> {
    /// The probability of the driven bank; 0 while the input knows nothing.
    #[must_use]
    pub const fn probability(&self) -> f32 {
        self.probability
    }

    /// The bank that the input does not drive.
    #[must_use]
    pub const fn plain(&self) -> &ModelBankState<3> {
        &self.plain
    }

    /// The bank that the input drives; it does not run while the probability is 0.
    #[must_use]
    pub const fn driven(&self) -> &ModelBankState<2> {
        &self.driven
    }

    /// The state of the input.
    #[must_use]
    pub const fn input(&self) -> &I {
        &self.input
    }

    /// The mean of a quantity of both banks.
    #[inline(always)]
    fn mean(&self, plain: f32, driven: f32) -> f32 {
        plain + self.probability * (driven - plain)
    }
}

/// Probability of the driven bank when its input begins.
const START: f32 = 0.5;

/// Rates at which the driven bank becomes the better one, and no longer is, 1/s: where the effect of the
/// current is learned, which is worth more at some times than at others.
const LEARNED: [f64; 2] = [5.0, 5.0];

/// The same rates where an observer is followed, whose model is right or wrong for good.
const FOLLOWED: [f64; 2] = [20.0, 0.1];

/// Limits of the ratio of two variances whose root is approximated.
const RATIOS: [f32; 2] = [0.1, 10.0];

impl<S: Copy, I> DrivenBank<S, I> {
    /// Two banks, of which one is driven by `input`; the better one changes at the rates `changes`, 1/s:
    /// to the driven one and from it.
    const fn of(
        plain: ModelBank<3, S>,
        driven: ModelBank<DRIVEN, S>,
        input: I,
        changes: [f64; 2],
        rate: Hertz,
    ) -> Self {
        Self {
            plain,
            driven,
            input,
            towards: (changes[0] / rate.0) as f32,
            away: (changes[1] / rate.0) as f32,
        }
    }
}

impl<I: Copy> DrivenBank<NoStamps, I> {
    const fn on_counts(input: I, changes: [f64; 2], rate: Hertz) -> Result<Self, DesignError> {
        match (ModelBank::new(rate), ModelBank::new(rate)) {
            (Ok(plain), Ok(driven)) => Ok(Self::of(plain, driven, input, changes, rate)),
            (Err(error), _) | (_, Err(error)) => Err(error),
        }
    }
}

impl<I: Copy> DrivenBank<Stamped, I> {
    const fn on_edges(
        input: I,
        changes: [f64; 2],
        clock: Hertz,
        rate: Hertz,
    ) -> Result<Self, DesignError> {
        let plain = ModelBank::with_edges(clock, rate);
        match (plain, ModelBank::with_edges(clock, rate)) {
            (Ok(plain), Ok(driven)) => Ok(Self::of(plain, driven, input, changes, rate)),
            (Err(error), _) | (_, Err(error)) => Err(error),
        }
    }
}

impl ImmMotor {
    /// The banks on counts, updated at `rate`, that learn the effect of the motor current.
    ///
    /// # Errors
    /// As [`ModelBank::new`].
    pub const fn learning(rate: Hertz) -> Result<Self, DesignError> {
        match LearnedCurrent::new(rate) {
            Ok(input) => Self::on_counts(input, LEARNED, rate),
            Err(error) => Err(error),
        }
    }
}

impl ImmMotorEdge {
    /// The banks on counts and edges, stamped by a clock of frequency `clock`, that learn the effect of
    /// the motor current.
    ///
    /// # Errors
    /// As [`ModelBank::with_edges`].
    pub const fn learning(clock: Hertz, rate: Hertz) -> Result<Self, DesignError> {
        match LearnedCurrent::new(rate) {
            Ok(input) => Self::on_edges(input, LEARNED, clock, rate),
            Err(error) => Err(error),
        }
    }
}

impl ImmAdaptive {
    /// The banks on counts, updated at `rate`, that follow `observer`.
    ///
    /// # Errors
    /// That of `observer`, and as [`ModelBank::new`].
    pub const fn following(
        observer: Result<AdaptiveObserver, DesignError>,
        rate: Hertz,
    ) -> Result<Self, DesignError> {
        match observer {
            Ok(observer) => Self::on_counts(Followed(observer), FOLLOWED, rate),
            Err(error) => Err(error),
        }
    }
}

impl ImmAdaptiveEdge {
    /// The banks on counts and edges, stamped by a clock of frequency `clock`, that follow `observer`.
    ///
    /// # Errors
    /// That of `observer`, and as [`ModelBank::with_edges`].
    pub const fn following(
        observer: Result<AdaptiveEdgeObserver, DesignError>,
        clock: Hertz,
        rate: Hertz,
    ) -> Result<Self, DesignError> {
        match observer {
            Ok(observer) => Self::on_edges(Followed(observer), FOLLOWED, clock, rate),
            Err(error) => Err(error),
        }
    }
}

impl<S: Stamps, I: BankInput> VelocityEstimator for DrivenBank<S, I> {
    type State = DrivenBankState<I::State>;
    const NEEDS: Signals = S::NEEDS.or(I::NEEDS);

    fn start(&self, first: &Sample) -> Self::State {
        DrivenBankState {
            plain: self.plain.start(first),
            driven: self.driven.start(first),
            input: self.input.start(first),
            probability: 0.0,
        }
    }

    fn update(&self, state: &mut Self::State, sample: &Sample) -> CountsPerTick {
        let Some(input) = self.input.input(&mut state.input, sample, &state.plain) else {
            state.probability = 0.0;
            return self.plain.update(&mut state.plain, sample);
        };
        if state.probability == 0.0 {
            state.driven = state.plain.narrowed();
            state.probability = START;
        }
        // Both use the edge or neither: their likelihoods are those of the same measurement.
        let stamped = state.plain.reads_stamps();
        let plain = self.plain.advance(&mut state.plain, sample, None, stamped);
        let driven = (self.driven).advance(&mut state.driven, sample, Some(input), stamped);
        let (Some(plain), Some(driven)) = (plain, driven) else {
            return CountsPerTick(0.0);
        };
        state.probability = self.probability(state.probability, &plain, &driven);
        CountsPerTick(state.mean(state.plain.velocity(), state.driven.velocity()))
    }
}

impl<S: Stamps, I: BankInput> DrivenBank<S, I> {
    /// The probability of the driven bank after the measurement of a tick, with `probability` before.
    #[inline(always)]
    fn probability(&self, probability: f32, plain: &Evidence, driven: &Evidence) -> f32 {
        let smallest = if plain.likelihood.divisor < driven.likelihood.divisor {
            plain.likelihood.divisor
        } else {
            driven.likelihood.divisor
        };
        // Both ends are constants: the panic of `clamp` is removed.
        let ratio = (plain.variance / driven.variance).clamp(RATIOS[0], RATIOS[1]);
        let prior = probability + (1.0 - probability) * self.towards - probability * self.away;
        let for_plain = (1.0 - prior) * plain.likelihood.relative(smallest);
        let for_driven = prior * driven.likelihood.relative(smallest) * root(ratio);
        for_driven / (for_plain + for_driven)
    }
}

impl<S: Stamps, I: BankInput> AccelerationEstimator for DrivenBank<S, I> {
    fn acceleration(&self, state: &Self::State) -> CountsPerTickSquared {
        let (plain, driven) = (state.plain.acceleration(), state.driven.acceleration());
        CountsPerTickSquared(state.mean(plain, driven))
    }
}

impl<S: Stamps, I: BankInput> Confidence for DrivenBank<S, I> {
    /// The variance of the mixture of both banks.
    fn variance(&self, state: &Self::State) -> Variance {
        let apart = state.driven.velocity() - state.plain.velocity();
        let probability = state.probability;
        let plain = state.plain.velocity_variance();
        let driven = state.driven.velocity_variance();
        Variance(state.mean(plain, driven) + probability * (1.0 - probability) * apart * apart)
    }
}

#[cfg(test)]
mod tests;
