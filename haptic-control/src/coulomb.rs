//! Feed-forward against the Coulomb friction of the small motor.

use crate::units::RadPerS;

/// Inverse of the velocity of the handle from which on the friction that is fed forward drives no handle,
/// 1 / (rad/s). The velocity is above the 4.4 rad/s of a swing by 40° to both sides once a second.
const PER_DRIVEN: f32 = 1.0 / 6.0;

/// Least friction and largest torque constant of the small motor with which the feed-forward drives no
/// faster handle, as factors of the values in the description.
const LEAST_FRICTION: f64 = 0.6;
const LARGEST_CONSTANT: f64 = 1.2;
const PASSIVE_PART: f64 = LEAST_FRICTION / LARGEST_CONSTANT;

/// Torque in the direction of the handle's velocity ω, N·m:
/// ```text
/// T sat(ω / ω_d) (p + (1 - p) s)      sat(x) = max(-1, min(x, 1))
/// ```
/// T is the friction, ω_d the velocity below which its direction is uncertain, and s is [`slow`]. From 6 rad/s
/// on, half of the friction is left, which is p. A handle that nothing holds is driven, if its friction is
/// less or the torque constant is more than in the description: up to the velocity at which the torque
/// fed forward is the friction. That is at most 6 rad/s down to 60 % of the friction and up to 120 % of
/// the torque constant.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Coulomb {
    /// T p, N·m.
    passive: f32,
    /// T (1 - p), N·m.
    driving: f32,
    per_direction: f32,
}

/// `1 - sat(ω / 6 rad/s)⁴`: 1 at rest, 0 from the velocity on from which the compensation drives no handle.
#[inline]
pub(crate) fn slow(handle: RadPerS) -> f32 {
    let driven = handle.0 * PER_DRIVEN;
    let square = driven * driven;
    let slow = 1.0 - square * square;
    if slow < 0.0 { 0.0 } else { slow }
}

impl Coulomb {
    /// Against a friction, N·m, with ω_d in rad/s.
    pub(crate) const fn new(friction: f64, direction: f64) -> Self {
        Self {
            passive: (PASSIVE_PART * friction) as f32,
            driving: ((1.0 - PASSIVE_PART) * friction) as f32,
            per_direction: (1.0 / direction) as f32,
        }
    }

    /// The torque at a velocity of the handle, with its direction, 1 or -1, and s at this velocity.
    #[inline]
    pub(crate) fn at(&self, handle: RadPerS, direction: f32, slow: f32) -> f32 {
        let part = handle.0 * self.per_direction;
        let part = if part.abs() > 1.0 { direction } else { part };
        part * (self.passive + self.driving * slow)
    }
}
