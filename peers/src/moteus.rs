//! The tracking loop of moteus.

use core::f64::consts::TAU;

use estimator_core::{Count, CountsPerTick, Hertz, Sample, Signals, VelocityEstimator};

use crate::limited;

/// The 3 dB frequency of the loop over its natural frequency, at a damping of 1, with the three digits
/// of the project.
const CUTOFF_RATIO: f64 = 2.48;

/// The tracking loop of moteus.
///
/// ```text
/// e = y - x        y count, x position of the loop
/// i += T ki e      w = 2 π f / 2.48,  kp = 2 w,  ki = w^2
/// x += T (i + kp e)
/// ```
///
/// The velocity is the integral `i`, the second-order low-pass `w^2 / (s + w)^2` of the true velocity.
/// The integral and the rate of `x` are limited to an eighth of a revolution in a tick. The error of the
/// project wraps at half a revolution; here it does not wrap.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Moteus {
    /// kp T.
    proportional: f32,
    /// ki T^2.
    integral: f32,
    /// Largest velocity, counts per tick.
    most: f32,
}

impl Moteus {
    /// The 3 dB frequency of the project's default configuration.
    pub const CUTOFF: Hertz = Hertz(400.0);
    /// The rate of the project's default configuration.
    pub const RATE: Hertz = Hertz(30_000.0);

    /// A loop with the 3 dB frequency `cutoff` at `rate`.
    #[must_use]
    pub const fn new(cutoff: Hertz, rate: Hertz, counts_per_rev: u32) -> Self {
        let w = TAU * cutoff.0 / CUTOFF_RATIO / rate.0;
        Self {
            proportional: (2.0 * w) as f32,
            integral: (w * w) as f32,
            most: 0.125 * counts_per_rev as f32,
        }
    }
}

/// State of [`Moteus`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MoteusState {
    anchor: Count,
    /// Position of the loop after the tick, relative to the newest count.
    lead: f32,
    /// The integral, counts per tick.
    velocity: f32,
}

impl VelocityEstimator for Moteus {
    type State = MoteusState;
    const NEEDS: Signals = Signals::COUNT;

    fn start(&self, first: &Sample) -> MoteusState {
        MoteusState {
            anchor: first.count,
            lead: 0.0,
            velocity: 0.0,
        }
    }

    #[inline(always)]
    fn update(&self, state: &mut MoteusState, sample: &Sample) -> CountsPerTick {
        let error = (sample.count - state.anchor).to_f32() - state.lead;
        state.anchor = sample.count;
        let velocity = state.velocity + self.integral * error;
        let rate = limited(velocity + self.proportional * error, self.most);
        state.velocity = limited(velocity, self.most);
        state.lead = rate - error;
        CountsPerTick(state.velocity)
    }
}
