//! The acceleration by the motor current, learned from the counts.

use super::input::BankInput;
use super::regression::Regression;
use super::state::ModelBankState;
use crate::design::DesignError;
use crate::design::const_math::{exp, limited};
use crate::memory::memory;
use crate::sample::{Sample, Signals};
use crate::sealed::Sealed;
use crate::units::Hertz;

/// Number of regressors: the current, its two low-passed forms, and friction.
const TERMS: usize = 4;

/// Acceleration by the motor current i, with gain, delay and friction learned while the motor runs.
/// Nothing about the device is known in advance.
/// ```text
/// terms      φ = [ i, i1, i2, -v |v| / (v² + σ²) ]       i1 += λ (i - i1)   i2 += λ (i1 - i2)
/// input      u = g₀ i + g₁ i1 + g₂ i2 + limited(g₃ φ₃, |v|/2)
/// each block y = x(k) - 2 x(k - n) + x(k - 2n)           Φ = Σ φ, weighted by the triangle of 2n ticks
///            A = f A + Φ Φᵀ     b = f b + Φ y            unless the count stood still
///            g = s (A + 10⁻³ diag A)⁻¹ b                 s = 1 - 16 r / bᵀ (A + ..)⁻¹ b, at least 0
/// ```
/// x is the count, v and σ² velocity and variance of the bank without input. The second difference of
/// the counts over blocks of n ticks (8 ms) is the acceleration, weighted by a triangle; the terms are
/// weighted in the same way, so no filter delays one against the other. A current and its first-order
/// low-passed forms (4 ms) represent gains with delays up to 8 ms (Laguerre functions). f forgets over
/// 10 s. r is the variance of the residual of y, plus half a count² of quantisation; s is the shrinkage
/// of James and Stein (1961) with a factor of 4 for correlated residuals. Terms that explain no more
/// than chance would have no gain: there is then no input, and the bank without input is alone.
///
/// Friction brakes by at most half of the velocity, so it cannot reverse the motion. A gain g₃ below 0
/// is taken as 0. A displacement beyond ±32767 counts in a tick is no motion: learning starts again.
///
/// Units: counts, ticks, A. Valid for the rates of [`ModelBank`](crate::ModelBank).
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(C)]
pub struct LearnedCurrent {
    /// Ticks of a block.
    block: u32,
    /// λ.
    step: f32,
    /// f.
    kept: f32,
}

memory!(LearnedCurrent { block, step, kept });

/// State of a [`LearnedCurrent`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LearnedCurrentState {
    terms: [f32; TERMS],
    gains: [f32; TERMS],
    /// Whether the terms explain more than chance would.
    known: bool,
    /// Ticks that are left of the block.
    left: u32,
    /// Sum of the terms over the block, and weighted by the ticks left.
    sums: [f32; TERMS],
    rising: [f32; TERMS],
    /// Sum of the terms over the block before, weighted by the ticks from its end.
    falling: [f32; TERMS],
    moved: f32,
    /// Displacement over the block before; `None` in the first block.
    moved_before: Option<f32>,
    regression: Regression<TERMS>,
}

/// Time of a block, s.
const BLOCK: f64 = 8e-3;

/// Time constant of each low-passed form of the current, s.
const LOW_PASS: f64 = 4e-3;

/// Time over which old blocks are forgotten, s.
const MEMORY: f64 = 10.0;

/// Keeps a division finite.
const LEAST: f32 = 1e-20;

impl LearnedCurrent {
    /// The input at `rate`.
    ///
    /// # Errors
    /// [`DesignError::RATE`], [`DesignError::RATE_OF_BANK`].
    pub const fn new(rate: Hertz) -> Result<Self, DesignError> {
        if let Err(error) = super::checked(rate) {
            return Err(error);
        }
        let ticks = BLOCK * rate.0;
        let block = if ticks > 1.0 { ticks as u32 } else { 1 };
        Ok(Self {
            block,
            step: (1.0 - exp(-1.0 / (LOW_PASS * rate.0))) as f32,
            kept: exp(-(block as f64) / (MEMORY * rate.0)) as f32,
        })
    }
}

impl LearnedCurrentState {
    /// The acceleration that a lasting current of 1 A causes, counts/tick²: the sum of the gains of the
    /// current and its low-passed forms.
    #[must_use]
    pub const fn gain(&self) -> f32 {
        self.gains[0] + self.gains[1] + self.gains[2]
    }

    /// Friction over inertia, counts/tick².
    #[must_use]
    pub const fn friction(&self) -> f32 {
        if self.gains[3] > 0.0 {
            self.gains[3]
        } else {
            0.0
        }
    }

    /// u.
    #[inline(always)]
    fn acceleration(&self, speed: f32) -> f32 {
        let [i, i1, i2, friction] = self.terms;
        let [g, g1, g2, _] = self.gains;
        g * i + g1 * i1 + g2 * i2 + limited(self.friction() * friction, 0.5 * speed)
    }

    /// Adds a tick to the block. At its end, learns from it and from the one before.
    #[inline(always)]
    fn collect(&mut self, moved: f32, design: &LearnedCurrent) {
        self.moved += moved;
        // The middle of the tick.
        let weight = self.left as f32 - 0.5;
        for n in 0..TERMS {
            self.sums[n] += self.terms[n];
            self.rising[n] += weight * self.terms[n];
        }
        self.left -= 1;
        if self.left == 0 {
            self.learn(design);
        }
    }

    /// Learns from the block and the one before, and begins the next.
    fn learn(&mut self, design: &LearnedCurrent) {
        let ticks = design.block as f32;
        let mut explained = [0.0; TERMS];
        for n in 0..TERMS {
            explained[n] = self.rising[n] + self.falling[n];
            self.falling[n] = ticks * self.sums[n] - self.rising[n];
        }
        // The displacement before the first block is unknown.
        let before = self.moved_before.replace(self.moved);
        if let Some(before) = before.filter(|before| self.moved != 0.0 || *before != 0.0) {
            let difference = self.moved - before;
            self.regression.add(&explained, difference, design.kept);
            let (gains, share) = self.regression.solve();
            self.gains = gains.map(|gain| share * gain);
            self.known = share > 0.0;
        }
        self.sums = [0.0; TERMS];
        self.rising = [0.0; TERMS];
        self.moved = 0.0;
        self.left = design.block;
    }
}

impl Sealed for LearnedCurrent {}

impl BankInput for LearnedCurrent {
    type State = LearnedCurrentState;
    const NEEDS: Signals = Signals::COUNT_AND_CURRENT;

    fn start(&self, first: &Sample) -> LearnedCurrentState {
        let current = first.current.get();
        LearnedCurrentState {
            terms: [current, current, current, 0.0],
            gains: [0.0; TERMS],
            known: false,
            left: self.block,
            sums: [0.0; TERMS],
            rising: [0.0; TERMS],
            falling: [0.0; TERMS],
            moved: 0.0,
            moved_before: None,
            regression: Regression::NONE,
        }
    }

    #[inline(always)]
    fn input<const K: usize>(
        &self,
        state: &mut LearnedCurrentState,
        sample: &Sample,
        bank: &ModelBankState<K>,
    ) -> Option<f32> {
        let velocity = bank.velocity();
        let speed = velocity.abs();
        let variance = bank.velocity_variance();
        let [_, once, twice, _] = state.terms;
        let current = sample.current.get();
        state.terms = [
            current,
            once + self.step * (current - once),
            twice + self.step * (once - twice),
            -velocity * speed / (velocity * velocity + variance + LEAST),
        ];
        let moved = sample.count - bank.anchor;
        // A count that jumped would be learned as an effect of the current.
        if !moved.is_motion() {
            *state = self.start(sample);
            return None;
        }
        let input = state.known.then(|| state.acceleration(speed));
        state.collect(moved.to_f32(), self);
        input
    }
}

#[cfg(test)]
mod tests;
