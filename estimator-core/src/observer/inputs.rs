//! What drives the motor, where the device can tell: its current and the handle. A device that
//! cannot takes [`NoCurrent`] or [`HeldHandle`]: no state, no code.

use crate::const_math::exp;
use crate::sample::{Sample, Signals};
use crate::units::Count;

/// What a current did over one tick.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Push {
    /// Its mean acceleration, counts per tick².
    pub mean: f32,
    /// How far the rotor is behind of one that was pushed by the mean throughout, counts.
    pub behind: f32,
}

/// The large motor's current, or nothing.
pub trait CurrentSource: Copy {
    /// What is carried from tick to tick.
    type State: Clone + PartialEq;
    /// What it reads of a sample.
    const NEEDS: Signals;

    /// The state at the first sample.
    fn start(&self, first: &Sample) -> Self::State;

    /// The push over the tick that ends with `sample`.
    fn push(&self, state: &mut Self::State, sample: &Sample) -> Push;
}

/// The handle's motion, or none.
pub trait SlipSource: Copy {
    /// What is carried from tick to tick.
    type State: Clone + PartialEq;
    /// What it reads of a sample.
    const NEEDS: Signals;

    /// The state at the first sample.
    fn start(&self, first: &Sample) -> Self::State;

    /// How far the handle turned over the tick, in counts of the large encoder.
    fn moved(&self, state: &mut Self::State, sample: &Sample) -> f32;
}

/// A current behind an amplifier of time constant τ, `x = τ / T`, `p = exp(-1 / x)`,
/// `m = x (1 - p)`:
/// ```text
/// Δ = i_command - i        mean = i_command - m Δ        behind = (x (1 - m) - m / 2) Δ
/// i = i_command - p Δ
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AmplifierCurrent {
    per_amp: f32,
    missing: f32,
    behind: f32,
    left: f32,
}

impl AmplifierCurrent {
    /// `per_amp`: counts per tick² per A; `lag`: τ / T.
    pub(super) const fn new(per_amp: f64, lag: f64) -> Self {
        // Above 700 time constants a tick, exp is out of range and zero.
        let left = if lag * 700.0 < 1.0 {
            0.0
        } else {
            exp(-1.0 / lag)
        };
        let missing = lag * (1.0 - left);
        Self {
            per_amp: per_amp as f32,
            missing: missing as f32,
            behind: (per_amp * (lag * (1.0 - missing) - missing / 2.0)) as f32,
            left: left as f32,
        }
    }
}

impl CurrentSource for AmplifierCurrent {
    /// The amplifier's current at the sample, A.
    type State = f32;
    const NEEDS: Signals = Signals::COUNT_AND_CURRENT;

    fn start(&self, first: &Sample) -> f32 {
        first.current.get()
    }

    #[inline(always)]
    fn push(&self, current: &mut f32, sample: &Sample) -> Push {
        let command = sample.current.get();
        let difference = command - *current;
        *current = command - self.left * difference;
        Push {
            mean: self.per_amp * (command - self.missing * difference),
            behind: self.behind * difference,
        }
    }
}

/// A motor whose current nobody measures.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct NoCurrent;

impl CurrentSource for NoCurrent {
    type State = ();
    const NEEDS: Signals = Signals::COUNT;

    fn start(&self, _: &Sample) {}

    #[inline(always)]
    fn push(&self, (): &mut (), _: &Sample) -> Push {
        Push::default()
    }
}

/// The small motor's encoder on the handle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SmallEncoder {
    /// Counts of the large encoder per count of the small one.
    pub(super) ratio: f32,
}

impl SlipSource for SmallEncoder {
    type State = Count;
    const NEEDS: Signals = Signals {
        small: true,
        ..Signals::COUNT
    };

    fn start(&self, first: &Sample) -> Count {
        first.small
    }

    #[inline(always)]
    fn moved(&self, previous: &mut Count, sample: &Sample) -> f32 {
        let moved = sample.small - *previous;
        *previous = sample.small;
        self.ratio * moved.to_f32()
    }
}

/// A handle that stands still, or of which nothing is known.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct HeldHandle;

impl SlipSource for HeldHandle {
    type State = ();
    const NEEDS: Signals = Signals::COUNT;

    fn start(&self, _: &Sample) {}

    #[inline(always)]
    fn moved(&self, (): &mut (), _: &Sample) -> f32 {
        0.0
    }
}
