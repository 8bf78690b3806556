//! Two estimators, exchanged at run time without a step of the velocity.

use crate::confidence::{Confidence, Variance};
use crate::design::DesignError;
use crate::estimator::VelocityEstimator;
use crate::sample::{Sample, Signals};
use crate::units::CountsPerTick;

/// Two estimators, of which one is selected; the selection can change at run time.
///
/// The newly selected estimator starts at rest. Its output is ignored for `settle` ticks and then
/// faded in over `fade` ticks:
/// ```text
/// e = ticks since it started     s = clamp((e - settle) / fade, 0, 1)
/// v = v_old + s (v_new - v_old)
/// ```
/// The step of the velocity in a tick is at most that of either estimator plus
/// `|v_new - v_old| / fade`. If the selection changes during a fade, the fade reverses from its
/// current weight. Both estimators run only during a change; afterwards the other one costs neither
/// state nor time.
///
/// ```
/// use estimator_core::*;
/// const BOTH: Handover<FiniteDifference, Foaw<8, EndFit>> =
///     preset!(Handover::new(FiniteDifference, preset!(Foaw::new(8, 1)), 8, 10));
/// let mut state = BOTH.start(&Sample::new(Count(0)));
/// state.select(Side::Second);
/// let mut v = 0.0;
/// for tick in 1..=40 {
///     v = BOTH.update(&mut state, &Sample::new(Count(tick / 2))).0; // half a count a tick
/// }
/// assert_eq!(v, 0.5); // the finite difference alternates between 0 and 1
/// assert_eq!(state.in_charge(), Some(Side::Second));
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Handover<A, B> {
    first: A,
    second: B,
    settle: u16,
    fade: u16,
}

/// Which of the two estimators of a [`Handover`].
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Side {
    /// The first estimator, selected at the start.
    #[default]
    First,
    /// The second estimator.
    Second,
}

impl<A, B> Handover<A, B> {
    /// A change between `first` and `second` that ignores the new estimator for `settle` ticks and
    /// fades it in over `fade` ticks.
    ///
    /// # Errors
    /// [`DesignError::FADE`] unless `fade` is 1 to 2^15 ticks, [`DesignError::SETTLE`] unless `settle`
    /// is below 2^15 ticks.
    pub const fn new(first: A, second: B, settle: u16, fade: u16) -> Result<Self, DesignError>
    where
        A: Copy,
        B: Copy,
    {
        const LONGEST: u16 = 1 << 15;
        if fade == 0 || fade > LONGEST {
            return Err(DesignError::FADE);
        }
        if settle >= LONGEST {
            return Err(DesignError::SETTLE);
        }
        Ok(Self {
            first,
            second,
            settle,
            fade,
        })
    }
}

/// State of a [`Handover`].
#[derive(Clone, Debug, PartialEq)]
pub struct HandoverState<A, B> {
    running: Running<A, B>,
    wanted: Side,
}

#[derive(Clone, Debug, PartialEq)]
enum Running<A, B> {
    First(A),
    Second(B),
    /// Both: the side that is faded in, and the ticks since the change.
    Both(A, B, Side, u16),
}

impl<A, B> HandoverState<A, B> {
    /// Selects an estimator, from the next tick on.
    pub const fn select(&mut self, side: Side) {
        self.wanted = side;
    }

    /// The estimator in charge; `None` during a change.
    #[must_use]
    pub const fn in_charge(&self) -> Option<Side> {
        match self.running {
            Running::First(_) => Some(Side::First),
            Running::Second(_) => Some(Side::Second),
            Running::Both(..) => None,
        }
    }
}

impl<A, B> VelocityEstimator for Handover<A, B>
where
    A: VelocityEstimator,
    B: VelocityEstimator,
{
    type State = HandoverState<A::State, B::State>;
    const NEEDS: Signals = A::NEEDS.or(B::NEEDS);

    fn start(&self, first: &Sample) -> Self::State {
        HandoverState {
            running: Running::First(self.first.start(first)),
            wanted: Side::First,
        }
    }

    /// Starts the selected estimator without a fade.
    fn restart(&self, state: &mut Self::State, first: &Sample) {
        state.running = match state.wanted {
            Side::First => Running::First(self.first.start(first)),
            Side::Second => Running::Second(self.second.start(first)),
        };
    }

    fn update(&self, state: &mut Self::State, sample: &Sample) -> CountsPerTick {
        let wanted = state.wanted;
        match &mut state.running {
            Running::First(a) => {
                let v = self.first.update(a, sample);
                if wanted == Side::Second {
                    let (a, b) = (a.clone(), self.second.start(sample));
                    state.running = Running::Both(a, b, wanted, 0);
                }
                v
            }
            Running::Second(b) => {
                let v = self.second.update(b, sample);
                if wanted == Side::First {
                    let (a, b) = (self.first.start(sample), b.clone());
                    state.running = Running::Both(a, b, wanted, 0);
                }
                v
            }
            Running::Both(a, b, to, ticks) => {
                if *to != wanted {
                    *to = wanted;
                    *ticks = self.turned(*ticks);
                }
                // The longest change that is taken back at once is at the end already.
                *ticks = ticks.saturating_add(1);
                let (va, vb) = (
                    self.first.update(a, sample).0,
                    self.second.update(b, sample).0,
                );
                let faded = ticks.saturating_sub(self.settle).min(self.fade);
                let share = f32::from(faded) / f32::from(self.fade);
                let (old, new) = match to {
                    Side::First => (vb, va),
                    Side::Second => (va, vb),
                };
                let v = old + share * (new - old);
                if *ticks >= self.settle + self.fade {
                    state.running = match to {
                        Side::First => Running::First(a.clone()),
                        Side::Second => Running::Second(b.clone()),
                    };
                }
                CountsPerTick(v)
            }
        }
    }
}

impl<A, B> Confidence for Handover<A, B>
where
    A: Confidence,
    B: Confidence,
{
    fn variance(&self, state: &Self::State) -> Variance {
        match &state.running {
            Running::First(a) => self.first.variance(a),
            Running::Second(b) => self.second.variance(b),
            Running::Both(a, b, ..) => {
                let (a, b) = (self.first.variance(a), self.second.variance(b));
                if a > b { a } else { b }
            }
        }
    }
}

impl<A, B> Handover<A, B> {
    /// The tick of the reversed fade that has the same weight as tick `ticks` of this fade.
    fn turned(&self, ticks: u16) -> u16 {
        let faded = ticks.saturating_sub(self.settle);
        self.settle + self.fade - faded
    }
}
