//! Algebraic differentiator: a weighted mean of finite differences, without delay.

use crate::design::DesignError;
use crate::estimator::VelocityEstimator;
use crate::sample::{Sample, Signals};
use crate::units::{Count, CountsPerTick};

/// Longest step that is taken for motion, counts/tick. A longer step restarts the window.
const LONGEST_STEP: i32 = i16::MAX as i32;

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
pub struct Algebraic<const N: usize, const KAPPA: u32, const MU: u32> {
    window: u8,
    /// Weights of the steps, the newest first; 0 beyond the window.
    weights: [f32; N],
}

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
        if !(-LONGEST_STEP..=LONGEST_STEP).contains(&step.0) {
            *state = self.start(sample);
            return CountsPerTick(step.to_f32());
        }
        state.anchor = sample.count;
        let next = state.newest + 1;
        state.newest = if next < self.window { next } else { 0 };
        let newest = usize::from(state.newest);
        // Always inside.
        if let Some(slot) = state.steps.get_mut(newest) {
            *slot = step.0 as i16;
        }
        let recent = state.steps.get(..=newest).unwrap_or(&[]);
        let older = state.steps.get(newest + 1..).unwrap_or(&[]);
        let older = older.get(..usize::from(self.window - 1) - newest);
        let weights = self.weights.get(newest + 1..).unwrap_or(&[]);
        CountsPerTick(dot(recent, &self.weights) + dot(older.unwrap_or(&[]), weights))
    }
}

/// Number of products that are added before they are added to the sum.
const BLOCK: usize = 8;

/// Sum of `steps`, the last of which is the newest, times `weights`. Sums of blocks lose fewer digits
/// than one sum of 64 products.
#[inline]
fn dot(steps: &[i16], weights: &[f32]) -> f32 {
    let [mut sum, mut part] = [0.0; 2];
    let mut left = BLOCK;
    for (step, weight) in steps.iter().rev().zip(weights) {
        part += f32::from(*step) * weight;
        left -= 1;
        if left == 0 {
            sum += part;
            part = 0.0;
            left = BLOCK;
        }
    }
    sum + part
}

#[cfg(test)]
mod tests {
    use super::super::SavitzkyGolay;
    use super::super::draws::draw;
    use super::*;

    fn after<E: VelocityEstimator>(filter: &E, position: impl Fn(i64) -> i64, ticks: i64) -> f32 {
        let sample = |k: i64| Sample::new(Count(position(k) as u32));
        let mut state = filter.start(&sample(0));
        (1..=ticks).fold(0.0, |_, k| filter.update(&mut state, &sample(k)).0)
    }

    #[test]
    fn velocity_is_the_weighted_sum_by_its_definition() {
        let mut seed = 1;
        for n in [1, 2, 3, 15, 127, 128] {
            let filter = Algebraic::<128, 1, 2>::new(n).unwrap();
            let mut state = filter.start(&Sample::new(Count(0)));
            let (mut count, mut steps) = (Count(0), [0.0f64; 400]);
            for k in 0..steps.len() {
                let step = (draw(&mut seed) % 401) as i32 - 200;
                count = Count(count.0.wrapping_add_signed(step));
                steps.copy_within(..399, 1);
                steps[0] = f64::from(step);
                let found = filter.update(&mut state, &Sample::new(count)).0;
                let t = |i: usize| (i as f64 + 0.5) / n as f64;
                let u = |i: usize| t(i) * (1.0 - t(i)).powi(2);
                let mean = |of: &dyn Fn(usize) -> f64| {
                    let sum = (0..n).map(u).sum::<f64>();
                    (0..n).map(|i| u(i) * of(i)).sum::<f64>() / sum
                };
                let m = mean(&t);
                let s = mean(&|i| (t(i) - m).powi(2));
                let line = |i: usize| {
                    if n == 1 {
                        1.0
                    } else {
                        1.0 + m * (m - t(i)) / s
                    }
                };
                let exact = mean(&|i| line(i) * steps[i]);
                // n roundings of terms up to 200 times the largest weight.
                let error = (f64::from(found) - exact).abs();
                assert!(error < 1e-3, "{n} {k}: {found} for {exact}");
            }
        }
    }

    #[test]
    fn order_1_follows_ramp_and_parabola_without_delay() {
        for n in [2, 3, 15, 64] {
            let filter = Algebraic::<64, 1, 2>::new(n).unwrap();
            let ramp = after(&filter, |k| 7 * k, 100);
            assert!((ramp - 7.0).abs() < 1e-4, "{n}: {ramp}");
            // Position k², so the velocity at tick 100 is 200.
            let parabola = after(&filter, |k| k * k, 100);
            assert!((parabola - 200.0).abs() < 5e-3, "{n}: {parabola}");
        }
    }

    #[test]
    fn order_0_has_the_delay_of_its_weight() {
        // Of many intervals: n (KAPPA + 1)/(KAPPA + MU + 2), 2/5 of 100; velocity 2 per tick lower for
        // each tick of delay.
        let filter = Algebraic::<128, 1, 2>::delayed(100).unwrap();
        let found = after(&filter, |k| k * k, 400);
        assert!((found - (800.0 - 2.0 * 40.0)).abs() < 0.1, "{found}");
        let alike = Algebraic::<128, 2, 2>::delayed(100).unwrap();
        let found = after(&alike, |k| k * k, 400);
        assert!((found - (800.0 - 2.0 * 50.0)).abs() < 0.1, "{found}");
    }

    #[test]
    fn equal_powers_of_one_are_the_savitzky_golay_filter_of_many_intervals() {
        let algebraic = Algebraic::<128, 1, 1>::new(128).unwrap();
        let parabola = SavitzkyGolay::<128>::new(128).unwrap();
        // A cubic, which both follow with an error.
        let cubic = |k: i64| k * k * k / 1000;
        let [a, b] = [
            after(&algebraic, cubic, 1000),
            after(&parabola, cubic, 1000),
        ];
        let exact = 3.0 * 1000.0;
        assert!((a - b).abs() < 0.05 * (b - exact).abs(), "{a} and {b}");
    }

    #[test]
    fn rest_is_exactly_zero_after_the_window_and_a_jump_restarts() {
        let filter = Algebraic::<15, 1, 2>::new(15).unwrap();
        let mut state = filter.start(&Sample::new(Count(0)));
        for k in 1..40 {
            filter.update(&mut state, &Sample::new(Count(k * k)));
        }
        let rest = Sample::new(Count(39 * 39));
        for tick in 1..=20 {
            let v = filter.update(&mut state, &rest).0;
            assert_eq!(v == 0.0, tick >= 15, "{tick}: {v}");
        }
        let landed = Count(1 << 20);
        let jump = filter.update(&mut state, &Sample::new(landed)).0;
        assert_eq!(jump, ((1 << 20) - 39 * 39) as f32);
        assert_eq!(state, filter.start(&Sample::new(landed)));
    }

    #[test]
    fn window_out_of_range_is_refused() {
        for window in [0, 16] {
            let refused = Algebraic::<15, 1, 2>::new(window);
            assert_eq!(refused, Err(DesignError::WINDOW));
        }
        assert!(Algebraic::<15, 1, 2>::delayed(15).is_ok());
    }
}
