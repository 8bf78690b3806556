//! Feed-forward against the Coulomb friction of the small motor.

use crate::limits::at_most;
use crate::units::{NewtonMetres, RadPerS};

/// Velocity of the handle from which on the friction that is fed forward drives no handle, rad/s: above
/// the 4.4 rad/s of a swing by 40° to both sides once a second.
const DRIVEN: f64 = 6.0;

/// Least friction and largest torque constant of the small motor with which the feed-forward drives no
/// faster handle, as factors of the values in the description.
const LEAST_FRICTION: f64 = 0.6;
pub(crate) const LARGEST_CONSTANT: f64 = 1.2;
const PASSIVE_PART: f64 = LEAST_FRICTION / LARGEST_CONSTANT;

/// Torque in the direction of the handle's velocity ω, N·m:
/// ```text
/// T sat(ω / ω_d) (1 - p sat(ω / 6 rad/s)⁴)      sat(x) = max(-1, min(x, 1))
/// ```
/// T is a part of the friction, ω_d the velocity below which its direction is uncertain. From 6 rad/s
/// on, half of the friction is left, which is p. A handle that nothing holds is driven, if its friction is
/// less or the torque constant is more than in the description: up to the velocity at which the torque
/// fed forward is the friction. That is at most 6 rad/s down to 60 % of the friction and up to 120 % of
/// the torque constant.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Coulomb {
    torque: f32,
    per_direction: f32,
    per_driven: f32,
    less: f32,
}

impl Coulomb {
    /// Against `part` of a friction, N·m, with ω_d in rad/s. The part is at least one half.
    pub(crate) const fn new(friction: f64, part: f64, direction: f64) -> Self {
        Self {
            torque: (part * friction) as f32,
            per_direction: (1.0 / direction) as f32,
            per_driven: (1.0 / DRIVEN) as f32,
            less: (1.0 - PASSIVE_PART / part) as f32,
        }
    }

    /// The torque at a velocity of the handle.
    #[inline]
    pub(crate) fn at(&self, handle: RadPerS) -> NewtonMetres {
        let direction = at_most(handle.0 * self.per_direction, 1.0);
        let driven = at_most(handle.0 * self.per_driven, 1.0);
        let square = driven * driven;
        NewtonMetres(self.torque * direction * (1.0 - self.less * square * square))
    }
}
