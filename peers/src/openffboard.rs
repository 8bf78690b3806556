//! The speed of OpenFFBoard.

use core::f64::consts::PI;

use estimator_core::{Count, CountsPerTick, Hertz, Sample, Signals, VelocityEstimator};

/// The low-pass of OpenFFBoard over the finite difference: a biquad in transposed direct form II, the
/// bilinear transform of `w^2 / (s^2 + w s / Q + w^2)` that is exact at its frequency.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OpenFfBoard {
    /// Numerator: `b0`, twice `b0`, `b0`.
    b0: f32,
    a1: f32,
    a2: f32,
}

impl OpenFfBoard {
    /// The frequencies of the project's four profiles; the second one is the default.
    pub const PROFILES: [Hertz; 4] = [Hertz(40.0), Hertz(70.0), Hertz(120.0), Hertz(180.0)];
    /// The quality of all profiles.
    pub const Q: f64 = 0.55;
    /// The rate of the project's default configuration.
    pub const RATE: Hertz = Hertz(1000.0);

    /// A biquad of `frequency`, below half of `rate`, and `quality`.
    #[must_use]
    pub const fn new(frequency: Hertz, quality: f64, rate: Hertz) -> Self {
        let k = tan(PI * frequency.0 / rate.0);
        let norm = 1.0 / (1.0 + k / quality + k * k);
        Self {
            b0: (k * k * norm) as f32,
            a1: (2.0 * (k * k - 1.0) * norm) as f32,
            a2: ((1.0 - k / quality + k * k) * norm) as f32,
        }
    }
}

/// The tangent of `x` from 0 to below π/2, by the series of sine and cosine of a quarter of it.
const fn tan(x: f64) -> f64 {
    let q = 0.25 * x;
    let s = q * q;
    let (mut sine, mut cosine) = (0.0, 0.0);
    let mut n = 10;
    while n > 0 {
        let m = 2.0 * n as f64;
        sine = (1.0 + sine) * (-s / (m * (m + 1.0)));
        cosine = (1.0 + cosine) * (-s / (m * (m - 1.0)));
        n -= 1;
    }
    let quarter = q * (1.0 + sine) / (1.0 + cosine);
    let half = 2.0 * quarter / (1.0 - quarter * quarter);
    2.0 * half / (1.0 - half * half)
}

/// State of [`OpenFfBoard`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OpenFfBoardState {
    anchor: Count,
    z1: f32,
    z2: f32,
}

impl VelocityEstimator for OpenFfBoard {
    type State = OpenFfBoardState;
    const NEEDS: Signals = Signals::COUNT;

    fn start(&self, first: &Sample) -> OpenFfBoardState {
        OpenFfBoardState {
            anchor: first.count,
            z1: 0.0,
            z2: 0.0,
        }
    }

    #[inline(always)]
    fn update(&self, state: &mut OpenFfBoardState, sample: &Sample) -> CountsPerTick {
        let step = (sample.count - state.anchor).to_f32();
        state.anchor = sample.count;
        let weighted = self.b0 * step;
        let velocity = weighted + state.z1;
        state.z1 = weighted + weighted + state.z2 - self.a1 * velocity;
        state.z2 = weighted - self.a2 * velocity;
        CountsPerTick(velocity)
    }
}
