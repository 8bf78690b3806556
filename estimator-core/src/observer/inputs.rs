//! Measured inputs of the motor: its current and the displacement of the coupled shaft. A device
//! without one takes [`NoCurrent`] or [`HeldShaft`], which have no state and no code.

use crate::design::const_math::exp;
use crate::memory::memory;
use crate::sample::{Sample, Signals};
use crate::sealed::Sealed;
use crate::units::Count;

/// Acceleration that an input causes over one tick.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct TickInput {
    /// Mean acceleration over the tick, counts/tick².
    pub mean: f32,
    /// Lag of the displacement, counts: displacement under the mean acceleration throughout, less
    /// the displacement under the acceleration as it rises.
    pub lag: f32,
}

/// Source of the motor current: [`AmplifierCurrent`] or [`NoCurrent`].
///
/// This trait is sealed: only types of this crate implement it.
pub trait CurrentSource: Copy + Sealed {
    /// State of the source, carried from tick to tick.
    type State: Clone + PartialEq;
    /// The parts of a sample that the source reads besides the count.
    const NEEDS: Signals;

    /// The state at the first sample.
    fn start(&self, first: &Sample) -> Self::State;

    /// The acceleration by the current over the tick that ends with `sample`.
    fn input(&self, state: &mut Self::State, sample: &Sample) -> TickInput;
}

/// Source of the coupled shaft's motion: [`CoupledEncoder`] or [`HeldShaft`].
///
/// This trait is sealed: only types of this crate implement it.
pub trait SlipSource: Copy + Sealed {
    /// State of the source, carried from tick to tick.
    type State: Clone + PartialEq;
    /// The parts of a sample that the source reads besides the count.
    const NEEDS: Signals;

    /// The state at the first sample.
    fn start(&self, first: &Sample) -> Self::State;

    /// Displacement of the coupled shaft over the tick, in counts of the motor's encoder.
    fn displacement(&self, state: &mut Self::State, sample: &Sample) -> f32;
}

/// Motor current behind an amplifier with a first-order lag of time constant τ. With `x = τ / T`,
/// `p = exp(-1 / x)` and `m = x (1 - p)`:
/// ```text
/// Δ = i_command - i        mean = i_command - m Δ        lag = (x (1 - m) - m / 2) Δ
/// i = i_command - p Δ
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(C)]
pub struct AmplifierCurrent {
    per_amp: f32,
    missing: f32,
    lag: f32,
    left: f32,
}

memory!(AmplifierCurrent {
    per_amp,
    missing,
    lag,
    left
});

impl AmplifierCurrent {
    /// `per_amp` is in counts/tick² per A, `lag` is τ / T.
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
            lag: (per_amp * (lag * (1.0 - missing) - missing / 2.0)) as f32,
            left: left as f32,
        }
    }
}

impl Sealed for AmplifierCurrent {}

impl CurrentSource for AmplifierCurrent {
    /// The amplifier's current at the sample, A.
    type State = f32;
    const NEEDS: Signals = Signals::COUNT_AND_CURRENT;

    fn start(&self, first: &Sample) -> f32 {
        first.current.get()
    }

    #[inline(always)]
    fn input(&self, current: &mut f32, sample: &Sample) -> TickInput {
        let command = sample.current.get();
        let difference = command - *current;
        *current = command - self.left * difference;
        TickInput {
            mean: self.per_amp * (command - self.missing * difference),
            lag: self.lag * difference,
        }
    }
}

/// No current: the motor's current is not measured.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[repr(C)]
pub struct NoCurrent;

memory!(NoCurrent {});

impl Sealed for NoCurrent {}

impl CurrentSource for NoCurrent {
    type State = ();
    const NEEDS: Signals = Signals::COUNT;

    fn start(&self, _: &Sample) {}

    #[inline(always)]
    fn input(&self, (): &mut (), _: &Sample) -> TickInput {
        TickInput::default()
    }
}

/// Encoder on the coupled shaft.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(C)]
pub struct CoupledEncoder {
    /// Counts of the motor's encoder per count of this encoder.
    pub(super) ratio: f32,
}

memory!(CoupledEncoder { ratio });

impl Sealed for CoupledEncoder {}

impl SlipSource for CoupledEncoder {
    type State = Count;
    const NEEDS: Signals = Signals {
        coupled: true,
        ..Signals::COUNT
    };

    fn start(&self, first: &Sample) -> Count {
        first.coupled
    }

    #[inline(always)]
    fn displacement(&self, previous: &mut Count, sample: &Sample) -> f32 {
        let displacement = sample.coupled - *previous;
        *previous = sample.coupled;
        self.ratio * displacement.to_f32()
    }
}

/// Coupled shaft at rest: it is held, or its motion is not measured.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[repr(C)]
pub struct HeldShaft;

memory!(HeldShaft {});

impl Sealed for HeldShaft {}

impl SlipSource for HeldShaft {
    type State = ();
    const NEEDS: Signals = Signals::COUNT;

    fn start(&self, _: &Sample) {}

    #[inline(always)]
    fn displacement(&self, (): &mut (), _: &Sample) -> f32 {
        0.0
    }
}
