//! Correction by counts, as quantised measurements.

use super::correction::Correction;
use super::covariance::{Covariance, HALF_WIDTH, Propagation, truncate};
use super::gain::Gain;
use super::gain_table::one_tick;
use super::innovation::{Innovation, Prediction};
use super::uncertainty::Noise;
use crate::design::DesignError;
use crate::design::riccati;
use crate::memory::memory;
use crate::sample::{Sample, Signals};
use crate::sealed::Sealed;

/// Correction by counts alone, as quantised measurements (truncated-Gaussian update).
///
/// The predicted position is Gaussian around x. A count truncates it to one quantisation interval,
/// ±1/2, which shifts the mean inwards and reduces the variance; this happens also while x is
/// inside. The covariance of position and velocity is therefore kept at run time, factored into p,
/// the variance of the position; g, the error of the velocity per error of the position; and s, the
/// variance of the velocity given the position.
/// ```text
/// each tick  u = 1 + φ1 g            p' = p u² + s φ1² + w / 3
///            g' = (p u φ0 g + s φ0 φ1 + w / 2) / p'
///            s' = (s (p φ0² + w k) + w (p (d² / 3 + u² / 4) + w / 12)) / p'
///            d = 3 u / 2 - φ0 g      k = φ1² - φ0 φ1 + φ0² / 3
/// at rest    p stays, g = 0, s = w   while x is inside
/// start      p = s = 1 / 12          λ = 0 and no adaptation until s < 64 w
/// truncation σ² = p + R              one step of Newton's iteration for σ
///            h = 3 σ, y = |x| - 1/2: shift e towards the middle, factor r of the variance
///            y < -h          inside             no correction
///            y < h           one end truncates  e = (y + h)² / 4 h      r = (h - y) / 2 h
///            h > |x| + 1/2   both ends truncate e = |x| (1 - 1 / 2 h)   r = 1 / 2 h
///            y > h           wholly outside     e = y                   r = 0
/// correction x += m e,  v += g m e,  a += λ g m e,  m = 1 - R / σ²       p *= r + (1 - r) R / σ²
/// ```
/// w is the variance that the white torque adds to the velocity in a tick, R the variance of a
/// boundary's position, λ the ratio of the disturbance's to the velocity's gain in the steady filter
/// that is corrected in every tick. A parabola of half-width 3 σ approximates the shift of the mean
/// of the Gaussian; the slope of the shift gives the variance (Tweedie's formula; Efron 2011).
///
/// p and s are sums of products of non-negative numbers over such sums, so rounding cannot make them
/// negative, and p' is at least w / 3. g is a mean of φ0 g / u, φ0 / φ1 and 3/2 with positive
/// weights, and 0 at first, so it stays within 0 and 3/2.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(C)]
pub struct QuantisedUpdate {
    propagation: Propagation,
    /// R, counts².
    boundary: f32,
    /// σ of a position that was just moved to a boundary, counts.
    sharp: f32,
    /// λ, 1/tick.
    disturbance_ratio: f32,
}

memory!(QuantisedUpdate {
    propagation,
    boundary,
    sharp,
    disturbance_ratio
});

/// State of [`QuantisedUpdate`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct QuantisedUpdateState {
    /// Ticks since the prediction was last outside its quantisation interval.
    since: f32,
    covariance: Covariance,
    /// σ, counts.
    std_dev: f32,
    /// Whether the initial velocity has been found.
    started: bool,
}

impl QuantisedUpdateState {
    /// The covariance of position and velocity.
    #[must_use]
    pub const fn covariance(&self) -> &Covariance {
        &self.covariance
    }
}

/// σ before the first tick, √(1/12) rounded up: Newton's iteration falls to the root from above.
const START_STD_DEV: f32 = 0.3;

/// The initial velocity has been found when s is below the noise of this many ticks.
const STARTED: f32 = 64.0;

/// Range of w, (counts/tick)²: the square of the lower end is a normal f32, the upper end is 2^18 as
/// for [`Kalman`](crate::Kalman).
const WHITE: [f64; 2] = [1e-18, 262_144.0];

impl QuantisedUpdate {
    pub(super) const fn new(beta: f64, noise: &Noise) -> Result<Self, DesignError> {
        if !(noise.white >= WHITE[0] && noise.white <= WHITE[1]) {
            return Err(DesignError::TORQUE_NOISE_FOR_QUANTISED);
        }
        let r = noise.boundary * noise.boundary;
        let (a, q) = one_tick(beta, noise);
        let steady = match riccati::steady_of_three(&a, &q, r) {
            Ok(steady) => steady,
            Err(error) => return Err(error),
        };
        Ok(Self {
            propagation: Propagation::new(beta, noise.white),
            boundary: r as f32,
            // R, and the rest of p, which is less.
            sharp: (1.25 * noise.boundary) as f32,
            disturbance_ratio: steady.gain[2] / steady.gain[1],
        })
    }
}

impl Sealed for QuantisedUpdate {}

impl Correction for QuantisedUpdate {
    type State = QuantisedUpdateState;
    type Gain<'a> = Gain;
    const NEEDS: Signals = Signals::COUNT;
    const DENSE: bool = false;

    fn start(&self) -> QuantisedUpdateState {
        QuantisedUpdateState {
            since: 0.0,
            covariance: Covariance::at_start(),
            std_dev: START_STD_DEV,
            started: false,
        }
    }

    fn velocity_variance(&self, state: &QuantisedUpdateState) -> f32 {
        state.covariance.velocity_variance()
    }

    #[inline(always)]
    fn innovation(
        &self,
        state: &mut QuantisedUpdateState,
        prediction: Prediction,
        _: &Sample,
    ) -> Option<(Innovation, Gain)> {
        state.since += 1.0;
        let position = prediction.from + prediction.displacement;
        let outside = position.abs() > 0.5;
        if prediction.stuck && !outside {
            state.covariance.coupling = 0.0;
            state.covariance.velocity = self.propagation.white;
            return None;
        }
        self.propagation.propagate(&mut state.covariance);
        if state.covariance.velocity < STARTED * self.propagation.white {
            state.started = true;
        }
        let variance = state.covariance.position + self.boundary;
        // A Newton step is never below the root.
        let std_dev = 0.5 * (state.std_dev + variance / state.std_dev);
        state.std_dev = std_dev;
        let per_std_dev = 1.0 / std_dev;
        let per_width = (0.5 / HALF_WIDTH) * per_std_dev;
        let (inwards, kept) = truncate(position, HALF_WIDTH * std_dev, per_width)?;
        let blur = self.boundary * per_std_dev * per_std_dev;
        let kept = kept + (1.0 - kept) * blur;
        let share = 1.0 - blur;
        state.covariance.position *= kept;
        state.std_dev = if kept > blur {
            std_dev * (0.5 + 0.5 * kept)
        } else {
            self.sharp
        };
        let gap = if outside && state.started {
            state.since
        } else {
            0.0
        };
        let innovation = Innovation {
            error: share * inwards,
            age: 0.0,
            position_gain: 1.0,
            gap,
            waited: gap,
        };
        if outside {
            state.since = 0.0;
        }
        let gain = Gain {
            position: share,
            velocity: state.covariance.coupling,
            disturbance: if state.started {
                self.disturbance_ratio * state.covariance.coupling
            } else {
                0.0
            },
            variance,
        };
        Some((innovation, gain))
    }
}
