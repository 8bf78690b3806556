//! Optimal robust exact differentiator.

use crate::design::DesignError;
use crate::estimator::VelocityEstimator;
use crate::memory::memory;
use crate::sample::{Sample, Signals};
use crate::units::{Count, CountsPerTick, Hertz};

use super::acceleration_bound::counts_per_tick_squared;

/// Fraction bits of L.
const FRACTION_BITS: u32 = 24;

/// Optimal robust exact differentiator of first order: the mean velocity over the newest m intervals,
/// where m follows from the noise that the newest n intervals show.
///
/// With `d_j = y_k - y_{k-j}`, the bound L on the acceleration, and units of counts and ticks:
/// ```text
/// N = max over 1 <= j <= l <= n of ( |d_j - d_l j/l| - L j (l - j)/2 ) / 2
/// m = ceil(2 sqrt(N / L)), at least 1 and at most n                        v = d_m / m
/// ```
/// A motion without noise stays within `L j (l - j)/2` of its chord, so that N is zero and v the finite
/// difference. If the count lies within N of a motion whose acceleration stays within L, the error of v
/// stays within `2 sqrt(2 N L) + L/2`. No exact differentiator has a smaller bound. It holds for n from
/// `sqrt(2 N / L) + 1`; a longer window costs run time alone.
///
/// Let `p_j = d_j + L j²/2`. The term of the pair (j, l) without the magnitude is `j (p_j/j - p_l/l)`, and
/// with `-d_j` in place of `d_j` the negative sign. So one pass from the oldest sample on, which keeps the
/// least `p_l/l`, finds the maximum in a time proportional to n. All comparisons are exact, in integers
/// with L in units of 2^-24 counts/tick²; m follows from `m² L >= 4 N` without a square root.
///
/// n intervals after the count has come to rest the velocity is exactly zero. Steps of 2^15 counts/tick
/// or more restart the window. `acceleration` L is in rad/s²; it is valid from 1e-12 to 1e6 counts/tick²,
/// and taken for 2^16 counts/tick² above that. N is the largest window, 2 to 128 intervals, and takes
/// 4 N bytes.
///
/// Sources: Seeber and Haimovich, Optimal robust exact differentiation via linear adaptive techniques,
/// Automatica 148, 2023; Aldana-López, Seeber, Haimovich and Gómez-Gutiérrez, Optimal robust exact
/// first-order differentiators with Lipschitz-continuous output, IEEE Trans. Automatic Control, 2025.
///
/// ```
/// use estimator_core::{Count, Hertz, RobustExact, Sample, VelocityEstimator, preset};
/// // 60 rad/s² are 0.039 counts/tick².
/// const FILTER: RobustExact<16> = preset!(RobustExact::new(4096, Hertz(1000.0), 60.0, 16));
/// let mut state = FILTER.start(&Sample::new(Count(0)));
/// for k in 1..50u32 {
///     // Two counts in five ticks: the error is below 0.41 counts/tick.
///     let v = FILTER.update(&mut state, &Sample::new(Count(2 * k / 5))).0;
///     assert!(k < 10 || (v - 0.4).abs() < 0.41);
/// }
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(C)]
pub struct RobustExact<const N: usize> {
    window: u8,
    /// L in units of 2^-24 counts/tick².
    bound: i64,
}

memory!([const N: usize] RobustExact<N> { window, bound });

impl<const N: usize> RobustExact<N> {
    /// A differentiator for a shaft of `counts_per_rev` whose acceleration stays below `acceleration`,
    /// rad/s², updated at `rate`, over a window of at most `window` intervals, n.
    ///
    /// # Errors
    /// [`DesignError::RATE`], [`DesignError::COUNTS_PER_REV`], [`DesignError::ACCELERATION`];
    /// [`DesignError::WINDOW`] unless `1 <= window <= N`. `N` outside 2 to 128 does not compile.
    pub const fn new(
        counts_per_rev: u32,
        rate: Hertz,
        acceleration: f64,
        window: usize,
    ) -> Result<Self, DesignError> {
        const { assert!(2 <= N && N <= 128, "window of 2 to 128 intervals") };
        let bound = match counts_per_tick_squared(counts_per_rev, rate, acceleration) {
            Ok(bound) => bound,
            Err(error) => return Err(error),
        };
        if window == 0 || window > N {
            return Err(DesignError::WINDOW);
        }
        // Steps below 2^15 have no larger acceleration than 2^16.
        let bound = if bound < 65_536.0 { bound } else { 65_536.0 };
        Ok(Self {
            window: window as u8,
            bound: (bound * (1u32 << FRACTION_BITS) as f64 + 0.5) as i64,
        })
    }
}

impl<const N: usize> RobustExact<N> {
    /// Index of the count so many intervals ago, at most n.
    #[inline(always)]
    fn ago(&self, next: u8, intervals: u8) -> u8 {
        if intervals > next {
            next + (self.window - intervals)
        } else {
            next - intervals
        }
    }
}

/// State of a [`RobustExact`]: the counts of the window.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct RobustExactState<const N: usize> {
    newest: Count,
    /// Intervals since the start or the last restart, at most n.
    filled: u8,
    /// Index of the next count that is replaced.
    next: u8,
    /// The counts before the newest one.
    counts: [Count; N],
}

/// The least `p_l/l` among the samples that the pass has met, and the number of intervals m.
#[derive(Clone, Copy)]
struct Chord {
    /// 2^25 p_l.
    height: i64,
    length: u32,
}

impl Chord {
    /// Takes sample j with 2^25 p_j = `height`, and raises `m` until it meets `m² L >= 4 N` for the pair
    /// of j and the chord, but not above `longest`. All products are below 2^62.
    #[inline(always)]
    fn take(&mut self, height: i64, length: u32, bound: i64, m: &mut u32, longest: u32) {
        let excess = height * i64::from(self.length) - self.height * i64::from(length);
        if excess <= 0 {
            *self = Self { height, length };
            return;
        }
        while *m < longest && bound * i64::from(*m * *m * self.length) < excess {
            *m += 1;
        }
    }
}

impl<const N: usize> VelocityEstimator for RobustExact<N> {
    type State = RobustExactState<N>;
    const NEEDS: Signals = Signals::COUNT;

    fn start(&self, first: &Sample) -> RobustExactState<N> {
        RobustExactState {
            newest: first.count,
            filled: 0,
            next: 0,
            counts: [first.count; N],
        }
    }

    #[inline]
    fn update(&self, state: &mut RobustExactState<N>, sample: &Sample) -> CountsPerTick {
        let step = sample.count - state.newest;
        let before = core::mem::replace(&mut state.newest, sample.count);
        if !step.is_motion() {
            state.filled = 0;
            return CountsPerTick(step.to_f32());
        }
        // Always inside.
        if let Some(slot) = state.counts.get_mut(usize::from(state.next)) {
            *slot = before;
        }
        let next = state.next + 1;
        state.next = if next < self.window { next } else { 0 };
        state.filled = state.filled.min(self.window - 1) + 1;

        let filled = u32::from(state.filled);
        let first = usize::from(self.ago(state.next, state.filled));
        let next = usize::from(state.next);
        // The counts before the newest from the oldest on, in two parts where the ring wraps.
        let ring = state.counts.get(..usize::from(self.window));
        let ring = ring.unwrap_or(&[]);
        let (older, newer) = if first < next {
            (ring.get(first..next), None)
        } else {
            (ring.get(first..), ring.get(..next))
        };
        let mut m = 1;
        let none = Chord {
            height: i64::MAX >> 8,
            length: 1,
        };
        let (mut above, mut below) = (none, none);
        let mut j = filled;
        for counts in [older.unwrap_or(&[]), newer.unwrap_or(&[])] {
            for count in counts {
                let displacement = i64::from((sample.count - *count).0) << (FRACTION_BITS + 1);
                let sag = self.bound * i64::from(j * j);
                above.take(sag + displacement, j, self.bound, &mut m, filled);
                below.take(sag - displacement, j, self.bound, &mut m, filled);
                j -= 1;
            }
        }
        let back = self.ago(state.next, m as u8);
        let oldest = match state.counts.get(usize::from(back)) {
            Some(count) => *count,
            None => before,
        };
        CountsPerTick((sample.count - oldest).to_f32() / m as f32)
    }
}
