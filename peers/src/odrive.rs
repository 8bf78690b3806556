//! The tracking loop of ODrive.

use estimator_core::{Count, CountsPerTick, Hertz, Sample, Signals, VelocityEstimator};

/// The tracking loop of ODrive.
///
/// ```text
/// x += T v
/// d = y - floor(x)     y count, x position of the loop
/// x += T kp d          kp = 2 b,  ki = b^2,  b the bandwidth in rad/s
/// v += T ki d
/// v = 0 if |v| < T ki / 2
/// ```
///
/// The phase detector `d` is a whole number of counts, so `v` moves in steps of `T ki`. At low
/// frequency the loop is the second-order low-pass `b^2 / (s + b)^2` of the true velocity. The project
/// reports an error unless `T kp < 1`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ODrive {
    /// kp T.
    proportional: f32,
    /// ki T^2, the step of the velocity, counts per tick.
    integral: f32,
}

impl ODrive {
    /// The bandwidth of the project's default configuration, rad/s.
    pub const BANDWIDTH_RAD_S: f64 = 1000.0;
    /// The rate of the project's control loop.
    pub const RATE: Hertz = Hertz(8000.0);

    /// A loop with the bandwidth `bandwidth_rad_s` at `rate`.
    #[must_use]
    pub const fn new(bandwidth_rad_s: f64, rate: Hertz) -> Self {
        let b = bandwidth_rad_s / rate.0;
        Self {
            proportional: (2.0 * b) as f32,
            integral: (b * b) as f32,
        }
    }

    /// The step in which the velocity moves, counts per tick.
    #[must_use]
    pub const fn step(&self) -> f32 {
        self.integral
    }
}

/// State of [`ODrive`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ODriveState {
    anchor: Count,
    /// Position of the loop relative to the newest count.
    lead: f32,
    /// Counts per tick.
    velocity: f32,
}

/// The largest whole number that is not above `x`; `x` fits an i32.
#[inline(always)]
fn floor(x: f32) -> f32 {
    let towards_zero = x as i32 as f32;
    if towards_zero > x {
        towards_zero - 1.0
    } else {
        towards_zero
    }
}

impl VelocityEstimator for ODrive {
    type State = ODriveState;
    const NEEDS: Signals = Signals::COUNT;

    fn start(&self, first: &Sample) -> ODriveState {
        ODriveState {
            anchor: first.count,
            lead: 0.0,
            velocity: 0.0,
        }
    }

    #[inline(always)]
    fn update(&self, state: &mut ODriveState, sample: &Sample) -> CountsPerTick {
        let predicted = state.lead + state.velocity - (sample.count - state.anchor).to_f32();
        state.anchor = sample.count;
        let behind = -floor(predicted);
        state.lead = predicted + self.proportional * behind;
        let velocity = state.velocity + self.integral * behind;
        let half = 0.5 * self.integral;
        state.velocity = if velocity > -half && velocity < half {
            0.0
        } else {
            velocity
        };
        CountsPerTick(state.velocity)
    }
}
