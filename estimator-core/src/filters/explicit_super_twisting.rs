//! Super-twisting differentiator, discretised explicitly.

use crate::design::DesignError;
use crate::estimator::VelocityEstimator;
use crate::memory::memory;
use crate::sample::{Sample, Signals};
use crate::units::{Count, CountsPerTick, Hertz};

use super::acceleration_bound::{LARGEST_ERROR, counts_per_tick_squared};
use super::square_root::square_root;

/// Levant's super-twisting differentiator, discretised by explicit Euler steps as it was published.
///
/// In counts and ticks, with the error `e = y - x` before the step:
/// ```text
/// w = w + 1.1 L sgn e      v = w + 1.5 sqrt(L |e|) sgn e      x = x + v
/// ```
/// The state holds e and never a position. The sign switches at every tick, so that v chatters: in the
/// limit cycle at rest it stays within ±2.5 L counts/tick and does not become zero, except from a start at
/// rest. [`SuperTwisting`](crate::SuperTwisting) has no chatter.
///
/// If the count lies more than 2^15 counts beside x, the differentiator restarts with the finite
/// difference as w. `acceleration` L is in rad/s²; it is valid from 1e-12 to 1e6 counts/tick².
///
/// Source: Levant, Robust exact differentiation via sliding mode technique, Automatica 34, 1998.
///
/// ```
/// use estimator_core::{Count, ExplicitSuperTwisting, Hertz, Sample, VelocityEstimator, preset};
/// // 153 rad/s² are 0.1 counts/tick².
/// const FILTER: ExplicitSuperTwisting =
///     preset!(ExplicitSuperTwisting::new(4096, Hertz(1000.0), 153.0));
/// let mut state = FILTER.start(&Sample::new(Count(0)));
/// let mut v = 0.0;
/// for k in 1..500u32 {
///     v = FILTER.update(&mut state, &Sample::new(Count(3 * k))).0;
/// }
/// assert!((v - 3.0).abs() <= 0.25);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(C)]
pub struct ExplicitSuperTwisting {
    /// 1.1 L.
    slope_step: f32,
    /// L.
    bound: f32,
}

memory!(ExplicitSuperTwisting { slope_step, bound });

impl ExplicitSuperTwisting {
    /// A differentiator for a shaft of `counts_per_rev` whose acceleration stays below `acceleration`,
    /// rad/s², updated at `rate`.
    ///
    /// # Errors
    /// [`DesignError::RATE`], [`DesignError::COUNTS_PER_REV`], [`DesignError::ACCELERATION`].
    pub const fn new(
        counts_per_rev: u32,
        rate: Hertz,
        acceleration: f64,
    ) -> Result<Self, DesignError> {
        match counts_per_tick_squared(counts_per_rev, rate, acceleration) {
            Ok(bound) => Ok(Self {
                slope_step: (1.1 * bound) as f32,
                bound: bound as f32,
            }),
            Err(error) => Err(error),
        }
    }
}

/// State of an [`ExplicitSuperTwisting`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ExplicitSuperTwistingState {
    anchor: Count,
    /// y - x after the step, counts.
    error: f32,
    /// w, counts/tick.
    slope: f32,
}

impl VelocityEstimator for ExplicitSuperTwisting {
    type State = ExplicitSuperTwistingState;
    const NEEDS: Signals = Signals::COUNT;

    fn start(&self, first: &Sample) -> ExplicitSuperTwistingState {
        ExplicitSuperTwistingState {
            anchor: first.count,
            error: 0.0,
            slope: 0.0,
        }
    }

    #[inline]
    fn update(&self, state: &mut ExplicitSuperTwistingState, sample: &Sample) -> CountsPerTick {
        let displacement = (sample.count - state.anchor).to_f32();
        state.anchor = sample.count;
        let error = state.error + displacement;
        let size = error.abs();
        if size > LARGEST_ERROR {
            (state.error, state.slope) = (0.0, displacement);
            return CountsPerTick(displacement);
        }
        let sign = if error > 0.0 {
            1.0
        } else if error < 0.0 {
            -1.0
        } else {
            0.0
        };
        state.slope += sign * self.slope_step;
        let velocity = state.slope + sign * (1.5 * square_root(self.bound * size));
        state.error = error - velocity;
        CountsPerTick(velocity)
    }
}

#[cfg(test)]
mod tests {
    use super::super::draws::draw;
    use super::*;

    /// Counts/rev and rate for which 1 rad/s² is 1e-3 counts/tick².
    const TURN: u32 = 6283;
    const RATE: Hertz = Hertz(1000.0);

    fn differentiator(bound: f64) -> ExplicitSuperTwisting {
        let per_tick = f64::from(TURN) / core::f64::consts::TAU / (RATE.0 * RATE.0);
        ExplicitSuperTwisting::new(TURN, RATE, bound / per_tick).unwrap()
    }

    #[test]
    fn step_is_the_explicit_euler_step_with_a_position() {
        let mut seed = 1;
        for bound in [1e-3f64, 0.1, 2.0] {
            let filter = differentiator(bound);
            let mut state = filter.start(&Sample::new(Count(0)));
            let mut count = 0i32;
            for tick in 0..500 {
                // The position and the slope that the state stands for: a sign decides, and would
                // amplify the rounding of many steps.
                let x = f64::from(count) - f64::from(state.error);
                let w = f64::from(state.slope);
                count += (draw(&mut seed) % 7) as i32 - 2;
                let e = x - f64::from(count);
                let sign = if e > 0.0 { 1.0 } else { -1.0 } * f64::from(u8::from(e != 0.0));
                let w = w - 1.1 * bound * sign;
                let v = w - 1.5 * (bound * e.abs()).sqrt() * sign;
                let found = filter
                    .update(&mut state, &Sample::new(Count(count as u32)))
                    .0;
                let error = (f64::from(found) - v).abs();
                // Near e = 0 the root amplifies a rounding of e, 2^-24 of a few counts, to
                // 1.5 sqrt(L 1e-6).
                let allowed = 1.5 * (bound * 1e-6).sqrt() + 1e-5 * (1.0 + v.abs());
                assert!(error <= allowed, "{bound} {tick}: {found} for {v}");
                // x + v, less the count.
                let next = f64::from(count) - x - v;
                let error = (f64::from(state.error) - next).abs();
                assert!(error <= allowed, "{bound} {tick}: error {}", state.error);
            }
        }
    }

    #[test]
    fn limit_cycle_at_rest_stays_within_two_and_a_half_bounds() {
        let mut seed = 3;
        for bound in [0.002, 0.1, 1.0] {
            let filter = differentiator(bound);
            for _ in 0..20 {
                let mut state = filter.start(&Sample::new(Count(0)));
                let mut count = 0u32;
                for _ in 0..50 {
                    count = count.wrapping_add_signed((draw(&mut seed) % 9) as i32 - 4);
                    filter.update(&mut state, &Sample::new(Count(count)));
                }
                let rest = Sample::new(Count(count));
                for _ in 0..20_000 {
                    filter.update(&mut state, &rest);
                }
                let mut largest: f32 = 0.0;
                for _ in 0..500 {
                    largest = largest.max(filter.update(&mut state, &rest).0.abs());
                }
                assert!(f64::from(largest) <= 2.5 * bound, "L = {bound}: {largest}");
                assert!(largest > 0.0, "L = {bound}: no chatter");
            }
        }
    }

    #[test]
    fn rest_from_the_start_is_zero_and_a_jump_restarts() {
        let filter = differentiator(0.1);
        let mut state = filter.start(&Sample::new(Count(7)));
        for _ in 0..100 {
            assert_eq!(filter.update(&mut state, &Sample::new(Count(7))).0, 0.0);
        }
        let landed = Count(1 << 20);
        let jump = filter.update(&mut state, &Sample::new(landed)).0;
        assert_eq!(jump, ((1 << 20) - 7) as f32);
        let restarted = ExplicitSuperTwistingState {
            slope: jump,
            ..filter.start(&Sample::new(landed))
        };
        assert_eq!(state, restarted);
    }

    #[test]
    fn acceleration_out_of_range_is_refused() {
        let new = |acceleration| ExplicitSuperTwisting::new(4096, RATE, acceleration).err();
        for acceleration in [0.0, -1.0, f64::NAN, f64::INFINITY, 1e-9, 1.6e9] {
            assert_eq!(new(acceleration), Some(DesignError::ACCELERATION));
        }
        assert_eq!(new(60.0), None);
    }
}
