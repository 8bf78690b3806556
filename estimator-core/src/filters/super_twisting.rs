//! Super-twisting differentiator, discretised implicitly.

use crate::design::DesignError;
use crate::estimator::VelocityEstimator;
use crate::memory::memory;
use crate::sample::{Sample, Signals};
use crate::units::{Count, CountsPerTick, Hertz};

use super::acceleration_bound::{LARGEST_ERROR, counts_per_tick_squared};
use super::square_root::square_root;

/// Levant's super-twisting differentiator (the robust exact differentiator of first order), discretised
/// implicitly.
///
/// The observer `dx/dt = v`, `v = w + 1.5 sqrt(L |e|) sgn e`, `dw/dt = 1.1 L sgn e` with `e = y - x`
/// is stepped by the backward Euler method, in which the set-valued sign of the new error is solved for
/// and not switched. In counts and ticks, with `b = y_k - x - w`, `c = 1.1 L`, `a = 1.5 sqrt L`:
/// ```text
/// |b| <= c:  w = w + b                                        v = w              x = x + v = y_k
/// otherwise: r = (sqrt(a² + 4 (|b| - c)) - a)/2
///            w = w + c sgn b       v = w + a r sgn b          x = x + v = y_k - r² sgn b
/// ```
/// The state holds `y_k - x`, which is 0 or `r² sgn b`, and never a position.
///
/// After a motion whose acceleration stays below 1.1 L has lasted for long enough, the first case holds:
/// the velocity is then the finite difference, without chatter, and at rest it is exactly zero. Where the
/// counts of a slow motion step by more than L, the second case smooths them. A change by ΔL counts of
/// velocity takes ΔL / L ticks and more.
///
/// If the count lies more than 2^15 counts beside its prediction, the differentiator restarts with the
/// finite difference as w. `acceleration` L is in rad/s²; it is valid from 1e-12 to 1e6 counts/tick².
///
/// Sources: Levant, Robust exact differentiation via sliding mode technique, Automatica 34, 1998; the
/// implicit step: Brogliato, Polyakov and Efimov, The implicit discretization of the supertwisting
/// sliding-mode control algorithm, IEEE Trans. Automatic Control 65, 2020, and for differentiators
/// Mojallizadeh, Brogliato and Acary, International Journal of Robust and Nonlinear Control 31, 2021.
///
/// ```
/// use estimator_core::{Count, Hertz, Sample, SuperTwisting, VelocityEstimator, preset};
/// // 3000 rad/s² are 1.96 counts/tick².
/// const FILTER: SuperTwisting = preset!(SuperTwisting::new(4096, Hertz(1000.0), 3000.0));
/// let mut state = FILTER.start(&Sample::new(Count(0)));
/// let mut v = 0.0;
/// for k in 1..50u32 {
///     // Position k², acceleration 2 counts per tick².
///     v = FILTER.update(&mut state, &Sample::new(Count(k * k))).0;
/// }
/// assert_eq!(v, 49.0 * 49.0 - 48.0 * 48.0);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(C)]
pub struct SuperTwisting {
    /// c, 1.1 L.
    band: f32,
    /// a, 1.5 sqrt L.
    gain: f32,
    /// a².
    gain_squared: f32,
}

memory!(SuperTwisting {
    band,
    gain,
    gain_squared
});

impl SuperTwisting {
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
        let bound = match counts_per_tick_squared(counts_per_rev, rate, acceleration) {
            Ok(bound) => bound,
            Err(error) => return Err(error),
        };
        let gain_squared = (2.25 * bound) as f32;
        Ok(Self {
            band: (1.1 * bound) as f32,
            gain: square_root(gain_squared),
            gain_squared,
        })
    }
}

/// State of a [`SuperTwisting`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SuperTwistingState {
    anchor: Count,
    /// y_k - x, counts.
    error: f32,
    /// w, counts/tick.
    slope: f32,
}

impl VelocityEstimator for SuperTwisting {
    type State = SuperTwistingState;
    const NEEDS: Signals = Signals::COUNT;

    fn start(&self, first: &Sample) -> SuperTwistingState {
        SuperTwistingState {
            anchor: first.count,
            error: 0.0,
            slope: 0.0,
        }
    }

    #[inline]
    fn update(&self, state: &mut SuperTwistingState, sample: &Sample) -> CountsPerTick {
        let displacement = (sample.count - state.anchor).to_f32();
        state.anchor = sample.count;
        let error = displacement + state.error;
        let beyond = error - state.slope;
        let size = beyond.abs();
        if size <= self.band {
            (state.error, state.slope) = (0.0, error);
            return CountsPerTick(error);
        }
        if size > LARGEST_ERROR {
            (state.error, state.slope) = (0.0, displacement);
            return CountsPerTick(displacement);
        }
        let root = 0.5 * (square_root(self.gain_squared + 4.0 * (size - self.band)) - self.gain);
        let sign = if beyond > 0.0 { 1.0 } else { -1.0 };
        state.error = sign * (root * root);
        state.slope += sign * self.band;
        CountsPerTick(state.slope + sign * (self.gain * root))
    }
}

#[cfg(test)]
mod tests {
    use super::super::draws::draw;
    use super::*;

    /// Counts/rev and rate for which 1 rad/s² is 1e-3 counts/tick².
    const TURN: u32 = 6283;
    const RATE: Hertz = Hertz(1000.0);

    fn differentiator(bound: f64) -> SuperTwisting {
        let per_tick = f64::from(TURN) / core::f64::consts::TAU / (RATE.0 * RATE.0);
        SuperTwisting::new(TURN, RATE, bound / per_tick).unwrap()
    }

    /// The backward Euler step by its definition: the new error e solves `b ∈ e + c S + a sqrt(|e|) S`
    /// with S the set-valued sign of e, whose right side is increasing; found by bisection. Returns e, w
    /// and v.
    fn definition(bound: f64, y: f64, x: f64, w: f64) -> [f64; 3] {
        let (a, c) = (1.5 * bound.sqrt(), 1.1 * bound);
        let b = y - x - w;
        let (mut low, mut high) = (0.0, b.abs());
        for _ in 0..200 {
            let e = 0.5 * (low + high);
            if e + c + a * f64::sqrt(e) < b.abs() {
                low = e;
            } else {
                high = e;
            }
        }
        // At e = 0 the sign is any number from -1 to 1.
        let inside = b.abs() <= c;
        let (e, sign) = if inside {
            (0.0, b / c)
        } else {
            (low, b.signum())
        };
        let w = w + c * sign;
        [e * sign, w, w + a * e.sqrt() * sign]
    }

    #[test]
    fn step_is_the_backward_euler_step_by_its_definition() {
        let mut seed = 1;
        for bound in [1e-4, 0.01, 0.3, 2.0, 500.0] {
            let filter = differentiator(bound);
            for limit in [1, 3, 40] {
                let mut count = 0u32;
                let mut state = filter.start(&Sample::new(Count(0)));
                for tick in 0..3000 {
                    let step = (draw(&mut seed) % (2 * limit as u64 + 1)) as i32 - limit;
                    count = count.wrapping_add_signed(step);
                    // Each step alone: x is the origin.
                    let (y, w) = (
                        f64::from(step) + f64::from(state.error),
                        f64::from(state.slope),
                    );
                    let v = filter.update(&mut state, &Sample::new(Count(count))).0;
                    let exact = definition(bound, y, 0.0, w);
                    let found = [state.error, state.slope, v].map(f64::from);
                    // A few roundings of the largest of the terms.
                    let allowed = (y.abs() + w.abs()) * 2f64.powi(-21);
                    for (found, exact) in found.iter().zip(exact) {
                        let error = (found - exact).abs();
                        assert!(error <= allowed, "{bound} {tick}: {found} for {exact}");
                    }
                }
            }
        }
    }

    /// The sliding mode: below 1.1 L the velocity is the finite difference bit for bit.
    #[test]
    fn velocity_is_exact_once_the_acceleration_stays_below_the_bound() {
        let filter = differentiator(4.0);
        let mut state = filter.start(&Sample::new(Count(0)));
        let (mut count, mut velocity) = (0u32, 0i32);
        for tick in 0..2000 {
            // 4 counts/tick² up and down.
            velocity += if tick / 100 % 2 == 0 { 4 } else { -4 };
            count = count.wrapping_add_signed(velocity);
            let v = filter.update(&mut state, &Sample::new(Count(count))).0;
            assert_eq!(v, velocity as f32, "tick {tick}");
        }
    }

    /// With the bound of the acceleration a velocity V is forgotten within a few times V / L.
    #[test]
    fn velocity_becomes_exactly_zero_after_a_stop() {
        for bound in [0.002, 0.04, 0.5] {
            let filter = differentiator(bound);
            let mut state = filter.start(&Sample::new(Count(0)));
            let mut count = 0;
            for k in 0..40_000u32 {
                count = k / 4;
                filter.update(&mut state, &Sample::new(Count(count)));
            }
            let rest = Sample::new(Count(count));
            let forgotten = (10.0 * 0.25 / bound) as u32 + 50;
            for _ in 0..forgotten {
                filter.update(&mut state, &rest);
            }
            for _ in 0..100 {
                assert_eq!(filter.update(&mut state, &rest).0, 0.0, "L = {bound}");
            }
        }
    }

    #[test]
    fn count_far_beside_its_prediction_restarts() {
        let filter = differentiator(0.1);
        let mut used = filter.start(&Sample::new(Count(0)));
        for k in 1..40 {
            filter.update(&mut used, &Sample::new(Count(k * k)));
        }
        let landed = Count(1 << 20);
        let jump = filter.update(&mut used, &Sample::new(landed)).0;
        assert_eq!(jump, ((1 << 20) - 39 * 39) as f32);
        // Resting at the new place: the velocity of the jump is forgotten at once.
        assert_eq!(filter.update(&mut used, &Sample::new(landed)).0, 0.0);
        let mut fresh = filter.start(&Sample::new(landed));
        for k in 1..40 {
            let sample = Sample::new(Count(landed.0 + 3 * k / 2));
            let one = filter.update(&mut used, &sample);
            assert_eq!(one, filter.update(&mut fresh, &sample));
        }
    }

    #[test]
    fn acceleration_out_of_range_is_refused() {
        let new = |acceleration| SuperTwisting::new(4096, RATE, acceleration).err();
        for acceleration in [0.0, -1.0, f64::NAN, f64::INFINITY, 1e-9, 1.6e9] {
            assert_eq!(new(acceleration), Some(DesignError::ACCELERATION));
        }
        for acceleration in [1.6e-9, 60.0, 1.5e9] {
            assert_eq!(new(acceleration), None);
        }
        let zero = SuperTwisting::new(0, RATE, 60.0).err();
        assert_eq!(zero, Some(DesignError::COUNTS_PER_REV));
        let zero = SuperTwisting::new(4096, Hertz(0.0), 60.0).err();
        assert_eq!(zero, Some(DesignError::RATE));
    }
}
