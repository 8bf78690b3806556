//! Anticipation of the motion of a handle that moves freely.

use core::f64::consts::PI;

use estimator_core::Hertz;
use estimator_core::const_math::exp;

use crate::coulomb::Coulomb;
use crate::device::DualStage;
use crate::rst_design::LoopPoles;
use crate::stage::Followed;
use crate::units::{NewtonMetres, RadPerS};

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
/// x ← x + (1 - e^(-T/τ)) (ω - x)      followed = ω + (ω - x)
/// friction = Tc sat(ω / ω_d) (1 - sat(ω / 6 rad/s)⁴ / 2)
/// ```
/// `followed` is the velocity that the large motor follows, rad/s: `(ω - x) / τ` is the acceleration of the
/// handle, and a large motor that leads by the delay does not lag a steady acceleration. `friction` is the torque
/// of the small motor against its whole friction Tc, N·m. ω_d is what 28 rad/s² reach in the delay of the
/// loop: 0.031 rad/s at 10 kHz, 0.056 rad/s at 1 kHz.
///
/// The friction that is left damps the spring of a scene, so only scenes without a spring have this part
/// ([`Scene::Free`](crate::Scene::Free)).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Anticipation {
    /// 1 - e^(-T/τ).
    gain: f32,
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
        Anticipated {
            followed: Followed {
                velocity: RadPerS(handle.0 + (handle.0 - state.0)),
                per_fade: PER_FADE,
            },
            friction: self.friction.at(handle),
        }
    }
}
