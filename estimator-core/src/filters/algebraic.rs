//! Algebraic differentiator: a weighted mean of finite differences, without delay.

use crate::design::DesignError;
use crate::estimator::VelocityEstimator;
use crate::memory::memory;
use crate::sample::{Sample, Signals};
use crate::units::{Count, CountsPerTick};

/// Algebraic differentiator of Mboup, Join and Fliess: finite differences of a window of n intervals,
/// weighted by a Jacobi weight.
///
/// With `d_i = y_{k-i} - y_{k-i-1}`, whose middle lies at the share `t_i = (i + 1/2)/n` of the window:
/// ```text
/// u_i = t_i^KAPPA (1 - t_i)^MU / Σ t_j^KAPPA (1 - t_j)^MU      m = Σ u_i t_i      s = Σ u_i (t_i - m)²
/// order 0:  v = Σ u_i d_i                                      delay m n, about n (KAPPA+1)/(KAPPA+MU+2)
/// order 1:  v = Σ u_i (1 + m (m - t_i)/s) d_i                  no delay of a ramp and of a parabola
/// ```
/// [`Self::new`] designs order 1, [`Self::delayed`] order 0. With KAPPA = MU = 1 order 1 is, for many
/// intervals, the [`SavitzkyGolay`](crate::SavitzkyGolay) filter of second degree; a larger MU gives more
/// weight to new counts. With n = 1, which determines no line, it is the finite difference.
///
/// Units: counts and ticks. Before the first sample the encoder is taken for resting. N is the largest
/// window, 1 to 128 intervals, and takes 2 N bytes of state; n may be less at run time. Steps of 2^15
/// counts/tick or more restart the window. Source: Mboup, Join and Fliess, Numerical differentiation with
/// annihilators in noisy environment, Numerical Algorithms 50, 2009.
///
/// ```
/// use estimator_core::{Algebraic, Count, Sample, VelocityEstimator, preset};
/// const FILTER: Algebraic<8, 1, 2> = preset!(Algebraic::new(8));
/// let mut state = FILTER.start(&Sample::new(Count(0)));
/// let mut v = 0.0;
/// for k in 1..=8u32 {
///     // Position k², acceleration 2 counts per tick².
///     v = FILTER.update(&mut state, &Sample::new(Count(k * k))).0;
/// }
/// assert!((v - 16.0).abs() < 1e-5);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(C)]
pub struct Algebraic<const N: usize, const KAPPA: u32, const MU: u32> {
    window: u8,
    /// Weights of the steps, the newest first; 0 beyond the window.
    weights: [f32; N],
}

memory!([const N: usize, const KAPPA: u32, const MU: u32] Algebraic<N, KAPPA, MU> { window, weights });

impl<const N: usize, const KAPPA: u32, const MU: u32> Algebraic<N, KAPPA, MU> {
    /// A differentiator of order 1 over `window` intervals, n.
    ///
    /// # Errors
    /// [`DesignError::WINDOW`] unless `1 <= window <= N`. `N` outside 1 to 128 and powers above 8 do not
    /// compile.
    pub const fn new(window: usize) -> Result<Self, DesignError> {
        Self::of_order(window, 1)
    }

    /// A differentiator of order 0, which has a delay, over `window` intervals.
    ///
    /// # Errors
    /// As [`Self::new`].
    pub const fn delayed(window: usize) -> Result<Self, DesignError> {
        Self::of_order(window, 0)
    }

    const fn of_order(window: usize, order: u32) -> Result<Self, DesignError> {
        const { assert!(1 <= N && N <= 128, "window of 1 to 128 intervals") };
        const { assert!(KAPPA <= 8 && MU <= 8, "powers of the weight up to 8") };
        if window == 0 || window > N {
            return Err(DesignError::WINDOW);
        }
        let [mut sum, mut first, mut second] = [0.0; 3];
        let mut i = 0;
        while i < window {
            let (t, u) = Self::weight(i, window);
            sum += u;
            first += u * t;
            second += u * t * t;
            i += 1;
        }
        let mean = first / sum;
        let variance = second / sum - mean * mean;
        // A single interval has no variance and determines no line.
        let tilt = if order == 0 || window == 1 {
            0.0
        } else {
            mean / variance
        };
        let mut weights = [0.0; N];
        let mut i = 0;
        while i < window {
            let (t, u) = Self::weight(i, window);
            weights[i] = (u / sum * (1.0 + tilt * (mean - t))) as f32;
            i += 1;
        }
        Ok(Self {
            window: window as u8,
            weights,
        })
    }

    /// Place of the middle of interval i in the window, 0 to 1, and its Jacobi weight.
    const fn weight(i: usize, window: usize) -> (f64, f64) {
        let t = (i as f64 + 0.5) / window as f64;
        (t, power(t, KAPPA) * power(1.0 - t, MU))
    }
}

const fn power(base: f64, exponent: u32) -> f64 {
    let (mut power, mut left) = (1.0, exponent);
    while left > 0 {
        power *= base;
        left -= 1;
    }
    power
}

/// State of an [`Algebraic`]: the steps of the window.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct AlgebraicState<const N: usize> {
    anchor: Count,
    /// Index of the newest step.
    newest: u8,
    steps: [i16; N],
}

impl<const N: usize, const KAPPA: u32, const MU: u32> VelocityEstimator
    for Algebraic<N, KAPPA, MU>
{
    type State = AlgebraicState<N>;
    const NEEDS: Signals = Signals::COUNT;

    fn start(&self, first: &Sample) -> AlgebraicState<N> {
        AlgebraicState {
            anchor: first.count,
            newest: 0,
            steps: [0; N],
        }
    }

    #[inline]
    fn update(&self, state: &mut AlgebraicState<N>, sample: &Sample) -> CountsPerTick {
        let step = sample.count - state.anchor;
        if !step.is_motion() {
            *state = self.start(sample);
            return CountsPerTick(step.to_f32());
        }
        state.anchor = sample.count;
        let next = state.newest + 1;
        state.newest = if next < self.window { next } else { 0 };
        let newest = usize::from(state.newest);
        // Always inside: an early return costs a branch, an empty slice a length.
        let Some(slot) = state.steps.get_mut(newest) else {
            return CountsPerTick(0.0);
        };
        *slot = step.0 as i16;
        let Some((recent, older)) = state.steps.split_at_checked(newest + 1) else {
            return CountsPerTick(0.0);
        };
        let Some((first, rest)) = self.weights.split_at_checked(newest + 1) else {
            return CountsPerTick(0.0);
        };
        let Some(older) = older.get(..usize::from(self.window - 1) - newest) else {
            return CountsPerTick(0.0);
        };
        CountsPerTick(dot(recent, first) + dot(older, rest))
    }
}

/// Number of products that are added before they are added to the sum.
const BLOCK: usize = 8;

/// Sum of `steps`, the last of which is the newest, times `weights`. Sums of blocks lose fewer digits
/// than one sum of 64 products. The compiler unrolls them, as the rest in parts: their lengths are
/// constants where that of the window is not.
#[inline]
fn dot<'a>(mut steps: &'a [i16], mut weights: &'a [f32]) -> f32 {
    let mut sum = 0.0;
    while let Some((newest, first)) = part::<BLOCK>(&mut steps, &mut weights) {
        sum += block(0.0, newest, first);
    }
    let mut rest = 0.0;
    if let Some((newest, first)) = part::<{ BLOCK / 2 }>(&mut steps, &mut weights) {
        rest = block(rest, newest, first);
    }
    if let Some((newest, first)) = part::<{ BLOCK / 4 }>(&mut steps, &mut weights) {
        rest = block(rest, newest, first);
    }
    if let Some((newest, first)) = part::<{ BLOCK / 8 }>(&mut steps, &mut weights) {
        rest = block(rest, newest, first);
    }
    sum + rest
}

/// Takes the newest L steps, and as many weights.
#[inline(always)]
fn part<'a, const L: usize>(
    steps: &mut &'a [i16],
    weights: &mut &'a [f32],
) -> Option<(&'a [i16; L], &'a [f32; L])> {
    let (older, newest) = steps.split_last_chunk()?;
    let (first, others) = weights.split_first_chunk()?;
    (*steps, *weights) = (older, others);
    Some((newest, first))
}

/// `sum` and the products of one part, added one by one.
#[inline(always)]
fn block<const L: usize>(mut sum: f32, steps: &[i16; L], weights: &[f32; L]) -> f32 {
    for (step, weight) in steps.iter().rev().zip(weights) {
        sum += f32::from(*step) * weight;
    }
    sum
}

#[cfg(test)]
mod tests;
