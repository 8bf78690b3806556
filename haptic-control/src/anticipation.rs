//! Anticipation of the handle's motion from the change of its velocity.

use core::f64::consts::PI;

use estimator_core::Hertz;
use estimator_core::const_math::exp;

use crate::coulomb::{Coulomb, LARGEST_CONSTANT};
use crate::device::DualStage;
use crate::rst_design::LoopPoles;
use crate::stage::Followed;
use crate::units::{NewtonMetres, RadPerS};

/// Least inertia of the handle, as a factor of that in the description.
const LEAST_INERTIA: f64 = 0.7;

/// Part of the handle's inertia that the small motor takes away: six sevenths of the largest one that
/// does not drive a free handle, which is the least inertia over the largest torque constant. The
/// rest is for the delays of estimator, tick and amplifier.
const INERTIA_PART: f64 = 6.0 / 7.0 * LEAST_INERTIA / LARGEST_CONSTANT;

/// Acceleration of the handle when a hand turns it back, rad/s²: that of a swing by 40° to both sides once
/// a second. Below the velocity that it reaches in the delay of the loop, the direction is uncertain.
const REVERSAL: f64 = 28.0;

/// Inverse of the commanded velocity of the large motor below which the friction that is fed forward is
/// reduced, 1 / (rad/s).
const PER_FADE: f32 = 1.0 / 0.15;

/// What the controller knows of the motion of a handle that moves freely, in a scene without a spring.
///
/// Each tick, with the estimated velocity ω of the handle and the delay `τ = 2 / (2π f_t)` of the
/// velocity loop's tracking filter:
/// ```text
/// x ← x + (1 - e^(-T/τ)) (ω - x)      α = (ω - x) / τ
/// followed = ω + τ α = 2 ω - x         velocity that the large motor follows, rad/s
/// inertia  = J_S α / 2                 torque of the small motor, N·m
/// friction = Tc sat(ω / ω_d) (1 - sat(ω / 6 rad/s)⁴ / 2)
/// ```
/// The first takes the delay out of the large motor's motion, the second half of the handle's inertia out
/// of the force that the hand feels, the third the whole friction Tc of the small motor. ω_d is what
/// 28 rad/s² reach in the delay of the loop: 0.031 rad/s at 10 kHz, 0.056 rad/s at 1 kHz.
///
/// Far above `f_t` the handle has its whole inertia. Below, the delay of α is a negative damping. With
/// a spring of the scene that could be an oscillation, and the friction damps the spring; so only scenes
/// without a spring have this part ([`Scene::Free`](crate::Scene::Free)).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Anticipation {
    /// 1 - e^(-T/τ).
    gain: f32,
    /// Torque per difference of velocities, N·m per rad/s.
    nm_per_rad_per_s: f32,
    friction: Coulomb,
}

/// State of an [`Anticipation`]: x, the velocity of the handle a delay before, rad/s.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AnticipationState(f32);

/// What a tick anticipates.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Anticipated {
    /// What the large motor follows.
    pub followed: Followed,
    /// Torque of the small motor against the inertia of the handle.
    pub inertia: NewtonMetres,
    /// Torque of the small motor against its own friction.
    pub friction: NewtonMetres,
}

impl Anticipation {
    /// For the handle of a device, with the velocity loop of these poles at a control rate.
    #[must_use]
    pub const fn new(device: &DualStage, rate: Hertz, poles: LoopPoles) -> Self {
        let delay = 2.0 / (2.0 * PI * poles.tracking.0);
        let direction = REVERSAL * (rate.period_s() + poles.estimator_delay_s);
        Self {
            gain: (1.0 - exp(-rate.period_s() / delay)) as f32,
            friction: Coulomb::new(device.small.coulomb_friction, 1.0, direction),
            nm_per_rad_per_s: (INERTIA_PART * device.small.inertia / delay) as f32,
        }
    }

    /// State after a constant velocity of the handle.
    #[must_use]
    pub const fn start(&self, handle: RadPerS) -> AnticipationState {
        AnticipationState(handle.0)
    }

    /// One tick, with the estimated velocity of the handle.
    #[inline]
    #[must_use]
    pub fn update(&self, state: &mut AnticipationState, handle: RadPerS) -> Anticipated {
        state.0 += self.gain * (handle.0 - state.0);
        let change = handle.0 - state.0;
        Anticipated {
            followed: Followed {
                velocity: RadPerS(handle.0 + change),
                per_fade: PER_FADE,
            },
            inertia: NewtonMetres(self.nm_per_rad_per_s * change),
            friction: self.friction.at(handle),
        }
    }
}
