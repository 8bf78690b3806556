//! Counts alone, with what they say inside their cell too.

use super::bell::{Bell, HALF_WIDTH, Widening, cut};
use super::correction::{Correction, Innovation, Path};
use super::design::{Gain, Noise};
use super::table::one_tick;
use crate::design_error::DesignError;
use crate::riccati;
use crate::sample::{Sample, Signals};

/// Counts alone, as with [`Cells`](super::Cells), but for a prediction that is known as a bell
/// around x: the part of it beyond a boundary is impossible, and what is left has its mean further
/// inside, and is narrower. So there is a covariance at run time, of position and velocity:
/// p, the variance of the position; g, what the velocity errs per count that the position does; and
/// s, the variance of the velocity beyond that.
/// ```text
/// each tick  u = 1 + φ1 g            p' = p u² + s φ1² + w / 3
///            g' = (p u φ0 g + s φ0 φ1 + w / 2) / p'
///            s' = (s (p φ0² + w k) + w (p (d² / 3 + u² / 4) + w / 12)) / p'
///            d = 3 u / 2 - φ0 g      k = φ1² - φ0 φ1 + φ0² / 3
/// at rest    p stays, g = 0, s = w   while x is inside
/// start      p = s = 1 / 12          nothing is known; λ = 0, and nothing is
///                                learned, until s < 64 w
/// bell       σ² = p + R              one step of Newton's for σ
///            h = 3 σ, y = |x| - 1/2: e towards the middle, r of the variance kept
///            y < -h          inside           nothing
///            y < h           one end cut      e = (y + h)² / 4 h      r = (h - y) / 2 h
///            h > |x| + 1/2   both ends cut    e = |x| (1 - 1 / 2 h)   r = 1 / 2 h
///            y > h           wholly outside   e = y                   r = 0
/// correction x += m e,  v += g m e,  a += λ g m e,  m = 1 - R / σ²       p *= r + (1 - r) R / σ²
/// ```
/// w is the variance that the white torque adds to the velocity in a tick, R that of a boundary's
/// position, λ the ratio of both gains in the steady filter of counts in every tick. A parabola of
/// half-width 3 σ stands for the shift of a Gaussian's mean by what is cut off, and its slope for
/// what that takes of the variance, as for the Gaussian itself (Tweedie's formula; Efron 2011).
///
/// p and s are sums of products of numbers that are not negative over such sums, so they never get
/// below zero, rounding or not, and p' not below w / 3. g is a mean of φ0 g / u, φ0 / φ1 and 3/2
/// with positive weights, and 0 at first, so it stays within 0 and 3/2.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SoftCells {
    widening: Widening,
    /// R, counts².
    boundary: f32,
    /// σ of a position that was just put on a boundary, counts.
    sharp: f32,
    /// λ, per tick.
    unknown: f32,
}

/// State of [`SoftCells`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SoftCellsState {
    /// Ticks since the prediction was last outside its cell.
    since: f32,
    bell: Bell,
    /// σ, counts.
    deviation: f32,
    /// Whether the velocity that it started with is known.
    started: bool,
}

impl SoftCellsState {
    /// The covariance.
    #[must_use]
    pub const fn bell(&self) -> &Bell {
        &self.bell
    }
}

/// σ before the first tick, √(1/12) rounded up: from above, Newton's steps fall to the root.
const UNKNOWN_DEVIATION: f32 = 0.3;

/// The velocity is known when s is below the noise of so many ticks.
const STARTED: f32 = 64.0;

/// Range of w, (counts a tick)²: the product of two such is still a number; 2^18 as for
/// [`Kalman`](crate::Kalman).
const WHITE: [f64; 2] = [1e-18, 262_144.0];

impl SoftCells {
    pub(super) const fn new(beta: f64, noise: &Noise) -> Result<Self, DesignError> {
        if !(noise.white >= WHITE[0] && noise.white <= WHITE[1]) {
            return Err(DesignError::TORQUE_NOISE_FOR_SOFT);
        }
        let r = noise.boundary * noise.boundary;
        let (a, q) = one_tick(beta, noise);
        let steady = match riccati::steady(&a, &q, r) {
            Ok(steady) => steady,
            Err(error) => return Err(error),
        };
        Ok(Self {
            widening: Widening::new(beta, noise.white),
            boundary: r as f32,
            // R, and what is left of p, which is less.
            sharp: (1.25 * noise.boundary) as f32,
            unknown: steady.gain[2] / steady.gain[1],
        })
    }
}

impl Correction for SoftCells {
    type State = SoftCellsState;
    type Gain<'a> = Gain;
    const NEEDS: Signals = Signals::COUNT;
    const DENSE: bool = false;

    fn start(&self) -> SoftCellsState {
        SoftCellsState {
            since: 0.0,
            bell: Bell::unknown(),
            deviation: UNKNOWN_DEVIATION,
            started: false,
        }
    }

    fn velocity_variance(&self, state: &SoftCellsState) -> f32 {
        state.bell.velocity_variance()
    }

    #[inline(always)]
    fn innovation(
        &self,
        state: &mut SoftCellsState,
        path: Path,
        _: &Sample,
    ) -> Option<(Innovation, Gain)> {
        state.since += 1.0;
        let position = path.from + path.lead;
        let outside = position.abs() > 0.5;
        if path.rests && !outside {
            state.bell.coupling = 0.0;
            state.bell.velocity = self.widening.white;
            return None;
        }
        self.widening.widen(&mut state.bell);
        if state.bell.velocity < STARTED * self.widening.white {
            state.started = true;
        }
        let variance = state.bell.position + self.boundary;
        // Never below the root, wherever it comes from.
        let deviation = 0.5 * (state.deviation + variance / state.deviation);
        state.deviation = deviation;
        let per_deviation = 1.0 / deviation;
        let per_width = (0.5 / HALF_WIDTH) * per_deviation;
        let (inwards, kept) = cut(position, HALF_WIDTH * deviation, per_width)?;
        let blur = self.boundary * per_deviation * per_deviation;
        let kept = kept + (1.0 - kept) * blur;
        let share = 1.0 - blur;
        state.bell.position *= kept;
        state.deviation = if kept > blur {
            deviation * (0.5 + 0.5 * kept)
        } else {
            self.sharp
        };
        let innovation = Innovation {
            error: share * inwards,
            age: 0.0,
            position: 1.0,
            gap: if outside && state.started {
                state.since
            } else {
                0.0
            },
        };
        if outside {
            state.since = 0.0;
        }
        let gain = Gain {
            position: share,
            velocity: state.bell.coupling,
            load: if state.started {
                self.unknown * state.bell.coupling
            } else {
                0.0
            },
            variance,
        };
        Some((innovation, gain))
    }
}
