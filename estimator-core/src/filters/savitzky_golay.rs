//! Savitzky-Golay filter: the slope of a parabola over a window of fixed length.

use crate::design::DesignError;
use crate::estimator::VelocityEstimator;
use crate::memory::memory;
use crate::sample::{Sample, Signals};
use crate::units::{Count, CountsPerTick};

/// Savitzky-Golay filter of second degree: the slope, at the newest sample, of the least-squares
/// parabola through the newest n + 1 samples.
///
/// With the steps `d_i = y_{k-i} - y_{k-i-1}`, and `m = n - i` for i from 0 to n - 1, the velocity is
/// ```text
/// v = Σ h_i d_i      D h_i = b1 m + b2 m (m+1)/2 + b3 m (m+1) (m+2)/6
/// b1 = -(n+2) (n+3) (4n+1)/2    b2 = (n+3) (14n+1)    b3 = -30 n    D = (n-1) n (n+1) (n+2) (n+3)/12
/// ```
/// The weights of a step fall with its age as sums of each other, so that one tick renews the three
/// sums at a cost that does not depend on n:
/// ```text
/// q3 = q3 - q2 + n (n+1) (n+2)/6 d_0    q2 = q2 - q1 + n (n+1)/2 d_0    q1 = q1 - q0 + n d_0    q0 = Σ d_i
/// v = d_0 + (b1 q1 + b2 q2 + b3 q3 - D d_0) / D
/// ```
/// Sums and numerator are integers: nothing drifts, and at a whole number of counts/tick, as at rest, the
/// velocity is exact n ticks after the change. Elsewhere it is rounded to within 2^-21 of the larger of
/// v and d_0. It follows a constant acceleration without lag, and overshoots a step of velocity by 35
/// to 51 %. With n = 1, which determines no parabola, it is the finite difference.
///
/// Units: counts and ticks. Before the first sample the encoder is taken for resting. N is the largest
/// window, 1 to 128 intervals, and takes 2 N bytes; n may be less at run time. Steps of 2^15 counts/tick
/// or more restart the window. Source: Savitzky and Golay, Smoothing and differentiation of data by
/// simplified least squares procedures, 1964; at the end of the window, Gorry 1990.
///
/// ```
/// use estimator_core::{Count, Sample, SavitzkyGolay, VelocityEstimator, preset};
/// const FILTER: SavitzkyGolay<8> = preset!(SavitzkyGolay::new(8));
/// let mut state = FILTER.start(&Sample::new(Count(0)));
/// let mut v = 0.0;
/// for k in 1..=8u32 {
///     // Position k², acceleration 2 counts per tick².
///     v = FILTER.update(&mut state, &Sample::new(Count(k * k))).0;
/// }
/// assert_eq!(v, 16.0);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(C)]
pub struct SavitzkyGolay<const N: usize> {
    window: u8,
    /// Weights of the newest step in q2 and q3; in q1 it is n.
    newest: [i32; 2],
    /// b1, b2 and -b3: a product of 64 bits with a number without a sign takes fewer instructions.
    first: i32,
    second: u32,
    third: u32,
    divisor: u32,
    reciprocal: f32,
}

memory!([const N: usize] SavitzkyGolay<N> { window, newest, first, second, third, divisor, reciprocal });

impl<const N: usize> SavitzkyGolay<N> {
    /// A filter over `window` intervals, n.
    ///
    /// # Errors
    /// [`DesignError::WINDOW`] unless `1 <= window <= N`. `N` outside 1 to 128 does not compile.
    pub const fn new(window: usize) -> Result<Self, DesignError> {
        const { assert!(1 <= N && N <= 128, "window of 1 to 128 intervals") };
        if window == 0 || window > N {
            return Err(DesignError::WINDOW);
        }
        let n = window as i32;
        let pairs = n * (n + 1) / 2;
        let (first, second, third, divisor) = if n == 1 {
            (1, 0, 0, 1)
        } else {
            let first = -(n + 2) * (n + 3) * (4 * n + 1) / 2;
            let second = ((n + 3) * (14 * n + 1)) as u32;
            // Below 2^32.
            let divisor = (n - 1) as u64 * (pairs * (n + 2) * (n + 3)) as u64 / 6;
            (first, second, 30 * n as u32, divisor as u32)
        };
        Ok(Self {
            window: window as u8,
            newest: [pairs, pairs * (n + 2) / 3],
            first,
            second,
            third,
            divisor,
            reciprocal: (1.0 / divisor as f64) as f32,
        })
    }
}

/// State of a [`SavitzkyGolay`]: the steps of the window and their sums.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SavitzkyGolayState<const N: usize> {
    anchor: Count,
    /// Whether n steps have come since the start or the last restart.
    is_full: bool,
    /// Index of the oldest step.
    oldest: u8,
    steps: [i16; N],
    /// q0 and q1: below 2^22 and 2^29.
    sum: i32,
    first: i32,
    /// q2 and q3: below 2^34 and 2^39.
    second: i64,
    third: i64,
}

impl<const N: usize> VelocityEstimator for SavitzkyGolay<N> {
    type State = SavitzkyGolayState<N>;
    const NEEDS: Signals = Signals::COUNT;

    fn start(&self, first: &Sample) -> SavitzkyGolayState<N> {
        SavitzkyGolayState {
            anchor: first.count,
            is_full: false,
            oldest: 0,
            steps: [0; N],
            sum: 0,
            first: 0,
            second: 0,
            third: 0,
        }
    }

    #[inline]
    fn update(&self, state: &mut SavitzkyGolayState<N>, sample: &Sample) -> CountsPerTick {
        let step = sample.count - state.anchor;
        state.anchor = sample.count;
        if !step.is_motion() {
            (state.is_full, state.oldest) = (false, 0);
            (state.sum, state.first) = (0, 0);
            (state.second, state.third) = (0, 0);
            return CountsPerTick(step.to_f32());
        }
        let newest = step.0;
        // Always inside.
        let oldest = match state.steps.get_mut(usize::from(state.oldest)) {
            Some(slot) => i32::from(core::mem::replace(slot, newest as i16)),
            None => 0,
        };
        let leaving = if state.is_full { oldest } else { 0 };
        let next = state.oldest + 1;
        if next < self.window {
            state.oldest = next;
        } else {
            (state.is_full, state.oldest) = (true, 0);
        }

        // Each sum enters the numerator where it is renewed, so that few values are live. Below 2^49.
        let [to_second, to_third] = self.newest;
        let mut beyond = -(i64::from(self.divisor) * i64::from(newest));
        state.third += i64::from(to_third) * i64::from(newest) - state.second;
        beyond -= i64::from(self.third) * state.third;
        state.second += i64::from(to_second) * i64::from(newest) - i64::from(state.first);
        beyond += i64::from(self.second) * state.second;
        state.first += i32::from(self.window) * newest - state.sum;
        beyond += i64::from(self.first) * i64::from(state.first);
        state.sum += newest - leaving;

        // Division and remainder truncate, so that mirrored motion is mirrored.
        let high = (beyond / (1 << 20)) as i32 as f32 * 1_048_576.0;
        let low = (beyond % (1 << 20)) as i32 as f32;
        CountsPerTick(newest as f32 + (high + low) * self.reciprocal)
    }
}

#[cfg(test)]
mod tests {
    use super::super::draws::draw;
    use super::*;
    use crate::units::Counts;

    /// The slope of the least-squares parabola, by Cramer's rule on the normal equations, at the
    /// newest of the samples `y`, oldest first.
    fn definition(y: &[i32]) -> f64 {
        let n = y.len() as i128 - 1;
        let power = |k: u32| (0..=n).map(|t| (t - n).pow(k)).sum::<i128>();
        let moment = |k: u32| -> i128 {
            let products = (0..=n).zip(y).map(|(t, y)| (t - n).pow(k) * i128::from(*y));
            products.sum()
        };
        let determinant = |c: [[i128; 3]; 3]| {
            c[0][0] * (c[1][1] * c[2][2] - c[1][2] * c[2][1])
                - c[0][1] * (c[1][0] * c[2][2] - c[1][2] * c[2][0])
                + c[0][2] * (c[1][0] * c[2][1] - c[1][1] * c[2][0])
        };
        let row = |k: u32| [power(k), power(k + 1), power(k + 2)];
        let with_moment = |k: u32| [power(k), moment(k), power(k + 2)];
        let slope = determinant([with_moment(0), with_moment(1), with_moment(2)]);
        slope as f64 / determinant([row(0), row(1), row(2)]) as f64
    }

    #[test]
    fn velocity_is_the_slope_of_the_parabola_by_its_definition() {
        let mut seed = 1;
        for n in [2, 3, 5, 15, 64, 100, 128] {
            let filter = SavitzkyGolay::<128>::new(n).unwrap();
            for limit in [1, 3, 200, Counts::LONGEST_STEP] {
                let mut positions = [0i32; 400];
                let mut state = filter.start(&Sample::new(Count(0)));
                for k in 1..positions.len() {
                    let step = (draw(&mut seed) % (2 * limit as u64 + 1)) as i32 - limit;
                    positions[k] = positions[k - 1] + step;
                    let v = filter.update(&mut state, &Sample::new(Count(positions[k] as u32)));
                    if k < n {
                        continue;
                    }
                    let exact = definition(&positions[k - n..=k]);
                    let allowed = exact.abs().max(f64::from(step.abs())) / 2f64.powi(21);
                    let error = (f64::from(v.0) - exact).abs();
                    assert!(error <= allowed, "{n} {k}: {} for {exact}", v.0);
                }
            }
        }
    }

    #[test]
    fn ramp_and_rest_are_exact_once_they_fill_the_window() {
        for n in [1, 2, 15, 128] {
            let filter = SavitzkyGolay::<128>::new(n).unwrap();
            let mut count = Count(u32::MAX - 1000);
            let mut state = filter.start(&Sample::new(count));
            for velocity in [7, -Counts::LONGEST_STEP, 0, Counts::LONGEST_STEP, 0] {
                for tick in 1..=n + 3 {
                    count = Count(count.0.wrapping_add_signed(velocity));
                    let v = filter.update(&mut state, &Sample::new(count)).0;
                    if tick >= n {
                        assert_eq!(v, velocity as f32, "n = {n}, tick {tick}");
                    }
                }
            }
        }
    }

    #[test]
    fn jump_restarts_the_window() {
        let filter = SavitzkyGolay::<15>::new(15).unwrap();
        let mut used = filter.start(&Sample::new(Count(0)));
        for k in 1..40 {
            filter.update(&mut used, &Sample::new(Count(k * k)));
        }
        let landed = Count(1 << 20);
        let jump = filter.update(&mut used, &Sample::new(landed)).0;
        assert_eq!(jump, ((1 << 20) - 39 * 39) as f32);
        let mut fresh = filter.start(&Sample::new(landed));
        for k in 1..40 {
            let sample = Sample::new(Count(landed.0 + 3 * k / 2));
            let one = filter.update(&mut used, &sample);
            assert_eq!(one, filter.update(&mut fresh, &sample));
        }
    }

    #[test]
    fn window_out_of_range_is_refused() {
        assert_eq!(SavitzkyGolay::<15>::new(0), Err(DesignError::WINDOW));
        assert_eq!(SavitzkyGolay::<15>::new(16), Err(DesignError::WINDOW));
        assert!(SavitzkyGolay::<15>::new(15).is_ok());
    }
}
