//! Han's tracking differentiator.

use crate::design::DesignError;
use crate::estimator::VelocityEstimator;
use crate::memory::memory;
use crate::sample::{Sample, Signals};
use crate::units::{Count, CountsPerTick, Hertz};

use super::acceleration_bound::{LARGEST_ERROR, counts_per_tick_squared};
use super::square_root::square_root;

/// Longest filter time, ticks.
const LONGEST_FILTER_TIME: f64 = 1e4;

/// Han's tracking differentiator: a position x that follows the count in the shortest time that a bound on
/// its acceleration allows, and the velocity v of that position.
///
/// In counts and ticks, with the bound r on the acceleration and the filter time h of at least a tick:
/// ```text
/// x = x + v (the v of the tick before)      v = v + fhan(e, v) with e = x - y_k before that step
/// d = r h²      z = e + 2 h v if |e + h v| < d, else h v + sgn(e + h v) (sqrt(d (d + 8 |e + h v|)) - d)/2
/// fhan = -r z/d if |z| < d, else -r sgn z
/// ```
/// Far from the count v changes by r a tick towards the parabola of braking. Near it the differentiator
/// is linear, with both poles at `1 - 1/h`, and comes to rest without a limit cycle. The larger h is, the
/// more it smooths, and the more it lags: by 2 h - 3/2 ticks while it is linear, which is up to |v| < r h. With
/// h of one tick and a large r it is the finite difference.
///
/// A faster shaft is beyond the parabola of braking: x stays v²/(2 r) counts behind it. If x lies more than 2^15
/// counts beside the count, the differentiator restarts there with the finite difference as v. From
/// |v| = 256 sqrt(r) on it does so again and again, and does not follow a constant velocity. `acceleration` is r in rad/s², valid from 1e-12 to 1e6 counts/tick²; `filter_time` is
/// h in s, valid up to 10^4 ticks. A time below one tick is one tick, so that parameters for one rate
/// serve a lower one too.
///
/// Source: Han and Wang, Nonlinear tracking-differentiator, Journal of Systems Science and Mathematical
/// Sciences 14, 1994; Han, From PID to active disturbance rejection control, IEEE Trans. Industrial
/// Electronics 56, 2009.
///
/// ```
/// use estimator_core::{Count, Hertz, Sample, TrackingDifferentiator, VelocityEstimator, preset};
/// const FILTER: TrackingDifferentiator =
///     preset!(TrackingDifferentiator::new(4096, Hertz(1000.0), 2000.0, 0.005));
/// let mut state = FILTER.start(&Sample::new(Count(0)));
/// let mut v = 0.0;
/// for tick in 1..400 {
///     v = FILTER.update(&mut state, &Sample::new(Count(3 * tick))).0;
/// }
/// assert!((v - 3.0).abs() < 1e-5);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(C)]
pub struct TrackingDifferentiator {
    /// r, counts/tick².
    bound: f32,
    /// h, ticks.
    ticks: f32,
    /// d, counts, and its root.
    band: f32,
    band_root: f32,
    /// r / d, 1/h².
    slope: f32,
}

memory!(TrackingDifferentiator {
    bound,
    ticks,
    band,
    band_root,
    slope
});

impl TrackingDifferentiator {
    /// A differentiator for a shaft of `counts_per_rev` that accelerates by at most `acceleration`,
    /// rad/s², with the filter time `filter_time`, s, updated at `rate`.
    ///
    /// # Errors
    /// [`DesignError::RATE`], [`DesignError::COUNTS_PER_REV`], [`DesignError::ACCELERATION`],
    /// [`DesignError::FILTER_TIME`].
    pub const fn new(
        counts_per_rev: u32,
        rate: Hertz,
        acceleration: f64,
        filter_time: f64,
    ) -> Result<Self, DesignError> {
        let bound = match counts_per_tick_squared(counts_per_rev, rate, acceleration) {
            Ok(bound) => bound,
            Err(error) => return Err(error),
        };
        let ticks = filter_time * rate.0;
        if !(ticks > 0.0 && ticks <= LONGEST_FILTER_TIME) {
            return Err(DesignError::FILTER_TIME);
        }
        let ticks = if ticks < 1.0 { 1.0 } else { ticks };
        let band = bound * ticks * ticks;
        Ok(Self {
            bound: bound as f32,
            ticks: ticks as f32,
            band: band as f32,
            band_root: square_root(band as f32),
            slope: (1.0 / (ticks * ticks)) as f32,
        })
    }

    /// The change of v over a tick: fhan.
    #[inline(always)]
    fn change(&self, error: f32, velocity: f32) -> f32 {
        let ahead = self.ticks * velocity;
        let aim = error + ahead;
        let size = aim.abs();
        let distance = if size < self.band {
            aim + ahead
        } else {
            let braking = self.band_root * square_root(self.band + 8.0 * size);
            let half = 0.5 * (braking - self.band);
            ahead + if aim > 0.0 { half } else { -half }
        };
        if distance.abs() < self.band {
            -self.slope * distance
        } else if distance > 0.0 {
            -self.bound
        } else {
            self.bound
        }
    }
}

/// State of a [`TrackingDifferentiator`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TrackingDifferentiatorState {
    anchor: Count,
    /// x - y_k with x of the coming tick, counts.
    lead: f32,
    /// v, counts/tick.
    velocity: f32,
}

impl VelocityEstimator for TrackingDifferentiator {
    type State = TrackingDifferentiatorState;
    const NEEDS: Signals = Signals::COUNT;

    fn start(&self, first: &Sample) -> TrackingDifferentiatorState {
        TrackingDifferentiatorState {
            anchor: first.count,
            lead: 0.0,
            velocity: 0.0,
        }
    }

    #[inline]
    fn update(&self, state: &mut TrackingDifferentiatorState, sample: &Sample) -> CountsPerTick {
        let displacement = (sample.count - state.anchor).to_f32();
        state.anchor = sample.count;
        let error = state.lead - displacement;
        if error.abs() > LARGEST_ERROR {
            (state.lead, state.velocity) = (displacement, displacement);
            return CountsPerTick(displacement);
        }
        state.lead = error + state.velocity;
        state.velocity += self.change(error, state.velocity);
        CountsPerTick(state.velocity)
    }
}

#[cfg(test)]
mod tests {
    use super::super::draws::draw;
    use super::*;

    const TURN: u32 = 6283;
    const RATE: Hertz = Hertz(1000.0);

    /// With r = `bound` counts/tick² and h in ticks.
    fn differentiator(bound: f64, ticks: f64) -> TrackingDifferentiator {
        let per_tick = f64::from(TURN) / core::f64::consts::TAU / (RATE.0 * RATE.0);
        TrackingDifferentiator::new(TURN, RATE, bound / per_tick, ticks / RATE.0).unwrap()
    }

    /// fhan as Han writes it, with signs in place of branches.
    fn fhan(x1: f64, x2: f64, r: f64, h: f64) -> f64 {
        let sign = |x: f64| if x == 0.0 { 0.0 } else { x.signum() };
        let d = r * h * h;
        let a0 = h * x2;
        let y = x1 + a0;
        let a1 = (d * (d + 8.0 * y.abs())).sqrt();
        let a2 = a0 + sign(y) * (a1 - d) / 2.0;
        let sy = (sign(y + d) - sign(y - d)) / 2.0;
        let a = (a0 + y - a2) * sy + a2;
        let sa = (sign(a + d) - sign(a - d)) / 2.0;
        -r * (a / d - sign(a)) * sa - r * sign(a)
    }

    #[test]
    fn change_of_velocity_is_that_of_han() {
        let mut seed = 1;
        for bound in [1e-3, 0.1, 2.0, 300.0] {
            for ticks in [1.0, 3.5, 40.0] {
                let filter = differentiator(bound, ticks);
                for _ in 0..20_000 {
                    let mut number = |size: f64| {
                        (draw(&mut seed) >> 11) as f64 / (1u64 << 52) as f64 * size - size
                    };
                    let scale = bound * ticks;
                    let (error, velocity) = (number(3.0 * scale * ticks), number(3.0 * scale));
                    let (error, velocity) = (error as f32, velocity as f32);
                    let exact = fhan(error.into(), velocity.into(), bound, ticks);
                    let change = f64::from(filter.change(error, velocity));
                    // A few roundings of the terms, which are up to 10 d: of z/d, times r.
                    assert!(
                        (change - exact).abs() <= 1e-5 * bound,
                        "{bound} {ticks}: {change} for {exact} at {error}, {velocity}"
                    );
                }
            }
        }
    }

    /// Position and velocity step by Han's difference equations.
    #[test]
    fn position_and_velocity_step_as_in_the_difference_equations() {
        let (bound, ticks) = (0.3, 4.0);
        let filter = differentiator(bound, ticks);
        let mut state = filter.start(&Sample::new(Count(0)));
        let (mut x, mut v) = (0.0, 0.0);
        for k in 1..3000u32 {
            let y = (k * k / 400) % 700;
            let change = fhan(x - f64::from(y), v, bound, ticks);
            (x, v) = (x + v, v + change);
            let found = f64::from(filter.update(&mut state, &Sample::new(Count(y))).0);
            assert!((found - v).abs() <= 1e-4, "{k}: {found} for {v}");
        }
    }

    /// From a distance D at rest, the fastest motion with |acceleration| <= r takes 2 sqrt(D / r).
    #[test]
    fn step_is_followed_in_the_shortest_time() {
        let filter = differentiator(0.5, 1.0);
        let mut state = filter.start(&Sample::new(Count(0)));
        let distance = 800.0f64;
        let shortest = 2.0 * (distance / 0.5).sqrt();
        let (mut position, mut largest) = (0.0f64, 0.0f64);
        for tick in 1..=200 {
            let v = f64::from(filter.update(&mut state, &Sample::new(Count(800))).0);
            position += v;
            largest = largest.max(position);
            let is_there = (position - distance).abs() < 1.0;
            // A tick or two of lag.
            assert!(
                is_there || f64::from(tick) < shortest + 3.0,
                "{tick}: {position}"
            );
            assert!(
                !is_there || f64::from(tick) > shortest - 5.0,
                "{tick}: {position}"
            );
        }
        assert!(largest < distance + 0.5, "overshoot: {largest}");
    }

    #[test]
    fn distance_beyond_the_largest_restarts() {
        let filter = differentiator(0.1, 3.0);
        let mut used = filter.start(&Sample::new(Count(0)));
        for k in 1..40 {
            filter.update(&mut used, &Sample::new(Count(k * k)));
        }
        let landed = Count(1 << 20);
        let jump = filter.update(&mut used, &Sample::new(landed)).0;
        assert_eq!(jump, ((1 << 20) - 39 * 39) as f32);
        assert_eq!(filter.update(&mut used, &Sample::new(landed)).0, 0.0);
    }

    #[test]
    fn parameters_out_of_range_are_refused() {
        let new =
            |acceleration, time| TrackingDifferentiator::new(4096, RATE, acceleration, time).err();
        assert_eq!(new(60.0, 0.001), None);
        assert_eq!(new(60.0, 10.0), None);
        let new_at = |time| TrackingDifferentiator::new(4096, RATE, 60.0, time).expect("in range");
        assert_eq!(new_at(0.0003), new_at(0.001));
        assert_ne!(new_at(0.0011), new_at(0.001));
        assert_eq!(new(0.0, 0.001), Some(DesignError::ACCELERATION));
        for time in [0.0, 10.1, f64::NAN, -1.0] {
            assert_eq!(new(60.0, time), Some(DesignError::FILTER_TIME), "{time}");
        }
    }
}
