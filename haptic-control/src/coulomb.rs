//! Feed-forward against the Coulomb friction of the small motor.

use crate::limits::at_most;
use crate::units::RadPerS;

/// Velocity of the handle from which on the friction that is fed forward drives no handle, rad/s: above
/// the 4.4 rad/s of a swing by 40° to both sides once a second.
const PER_DRIVEN: f32 = 1.0 / 6.0;

/// Least friction and largest torque constant of the small motor with which the feed-forward drives no
/// faster handle, as factors of the values in the description.
const LEAST_FRICTION: f32 = 0.6;
const LARGEST_CONSTANT: f32 = 1.2;
const PASSIVE_PART: f32 = LEAST_FRICTION / LARGEST_CONSTANT;

/// Torque in the direction of the handle's velocity ω, N·m:
/// ```text
/// T sat(ω / ω_d) (p + (1 - p) s)      s = 1 - sat(ω / 6 rad/s)⁴      sat(x) = max(-1, min(x, 1))
/// ```
/// T is the friction, ω_d the velocity below which its direction is uncertain. From 6 rad/s
/// on, half of the friction is left, which is p. A handle that nothing holds is driven, if its friction is
/// less or the torque constant is more than in the description: up to the velocity at which the torque
/// fed forward is the friction. That is at most 6 rad/s down to 60 % of the friction and up to 120 % of
/// the torque constant.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Coulomb {
    torque: f32,
    per_direction: f32,
}

/// `sat(ω / 6 rad/s)⁴`: 0 at rest, 1 from the velocity on from which the compensation drives no handle.
#[inline]
pub(crate) fn driven(handle: RadPerS) -> f32 {
    let driven = at_most(handle.0 * PER_DRIVEN, 1.0);
    let square = driven * driven;
    square * square
}

impl Coulomb {
    /// Against a friction, N·m, with ω_d in rad/s.
    pub(crate) const fn new(friction: f64, direction: f64) -> Self {
        Self {
            torque: friction as f32,
            per_direction: (1.0 / direction) as f32,
        }
    }

    /// The torque at a velocity of the handle, with s at this velocity.
    #[inline]
    pub(crate) fn at(&self, handle: RadPerS, slow: f32) -> f32 {
        let direction = at_most(handle.0 * self.per_direction, 1.0);
        self.torque * direction * (PASSIVE_PART + (1.0 - PASSIVE_PART) * slow)
    }
}
