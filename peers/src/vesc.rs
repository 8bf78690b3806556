//! The velocity estimates of VESC.

use estimator_core::{Count, CountsPerTick, Hertz, Sample, Signals, VelocityEstimator};

use crate::limited;

/// The low-pass of VESC over the finite difference, its fast speed:
/// `v += share (d - v)`, `d` the difference of two counts, limited to a sixth of an electrical turn.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct VescFast {
    share: f32,
    /// Largest difference, counts.
    most: f32,
}

impl VescFast {
    /// The share of the fast speed. The project compiles it in.
    pub const SHARE: f64 = 0.01;

    /// A low-pass with `share` of the new difference, on an encoder with `counts_per_turn` counts in an
    /// electrical turn.
    #[must_use]
    pub const fn new(share: f64, counts_per_turn: f64) -> Self {
        Self {
            share: share as f32,
            most: (counts_per_turn / 6.0) as f32,
        }
    }

    #[inline(always)]
    fn filtered(&self, velocity: f32, step: f32) -> f32 {
        velocity + self.share * (limited(step, self.most) - velocity)
    }
}

/// State of [`VescFast`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct VescFastState {
    anchor: Count,
    velocity: f32,
}

impl VelocityEstimator for VescFast {
    type State = VescFastState;
    const NEEDS: Signals = Signals::COUNT;

    fn start(&self, first: &Sample) -> VescFastState {
        VescFastState {
            anchor: first.count,
            velocity: 0.0,
        }
    }

    #[inline(always)]
    fn update(&self, state: &mut VescFastState, sample: &Sample) -> CountsPerTick {
        let step = (sample.count - state.anchor).to_f32();
        state.anchor = sample.count;
        state.velocity = self.filtered(state.velocity, step);
        CountsPerTick(state.velocity)
    }
}

/// The tracking loop of VESC.
///
/// ```text
/// e = y - x           y angle, x angle of the loop, e within half an electrical turn
/// x += T (v + kp e)
/// v += T ki e
/// |v| <= 3 |u|        u the fast speed
/// ```
///
/// The velocity is the low-pass `ki / (s^2 + kp s + ki)` of the true one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct VescPll {
    /// kp T.
    proportional: f32,
    /// ki T^2.
    integral: f32,
    /// Counts in an electrical turn.
    turn: f32,
    fast: VescFast,
}

impl VescPll {
    /// The proportional gain of the project's default configuration, 1/s.
    pub const KP: f64 = 2000.0;
    /// The integral gain of the project's default configuration, 1/s^2.
    pub const KI: f64 = 30_000.0;
    /// Electrical turns in a revolution in the project's default configuration.
    pub const RATIO: f64 = 7.0;
    /// The rate of the project's default configuration: half of the switching frequency of 25 kHz.
    pub const RATE: Hertz = Hertz(12_500.0);

    /// A loop with the gains `kp`, 1/s, and `ki`, 1/s^2, at `rate`.
    #[must_use]
    pub const fn new(kp: f64, ki: f64, rate: Hertz, counts_per_turn: f64) -> Self {
        Self {
            proportional: (kp / rate.0) as f32,
            integral: (ki / (rate.0 * rate.0)) as f32,
            turn: counts_per_turn as f32,
            fast: VescFast::new(VescFast::SHARE, counts_per_turn),
        }
    }
}

/// State of [`VescPll`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct VescPllState {
    anchor: Count,
    /// Angle of the loop relative to the newest count, counts.
    lead: f32,
    velocity: f32,
    fast: f32,
}

impl VelocityEstimator for VescPll {
    type State = VescPllState;
    const NEEDS: Signals = Signals::COUNT;

    fn start(&self, first: &Sample) -> VescPllState {
        VescPllState {
            anchor: first.count,
            lead: 0.0,
            velocity: 0.0,
            fast: 0.0,
        }
    }

    #[inline(always)]
    fn update(&self, state: &mut VescPllState, sample: &Sample) -> CountsPerTick {
        let step = (sample.count - state.anchor).to_f32();
        state.anchor = sample.count;
        let mut error = step - state.lead;
        if error > 0.5 * self.turn {
            error -= self.turn;
        } else if error < -0.5 * self.turn {
            error += self.turn;
        }
        state.lead = state.velocity + self.proportional * error - error;
        state.fast = self.fast.filtered(state.fast, step);
        let most = if state.fast < 0.0 {
            -3.0 * state.fast
        } else {
            3.0 * state.fast
        };
        state.velocity = limited(state.velocity + self.integral * error, most);
        CountsPerTick(state.velocity)
    }
}
