//! Grip on the handle.

/// Grip on the handle during one tick.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Grip {
    /// Clamped: the velocity is exactly zero.
    Clamped,
    /// Free.
    Free,
    /// Held by a hand with this intended motion.
    Hand(HandMotion),
}

/// Intended motion of a hand during one tick: a cubic through angle and velocity at both ends,
/// which are therefore continuous from tick to tick.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HandMotion {
    angle: f64,
    omega: f64,
    second: f64,
    third: f64,
}

/// Angle and velocity at one time, rad and rad/s.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Pose {
    /// Angle, rad.
    pub angle: f64,
    /// Velocity, rad/s.
    pub omega: f64,
}

impl HandMotion {
    /// The cubic from one pose to another `duration_s` later.
    #[must_use]
    pub fn between(from: Pose, to: Pose, duration_s: f64) -> Self {
        let mean = (to.angle - from.angle) / duration_s;
        Self {
            angle: from.angle,
            omega: from.omega,
            second: (3.0 * mean - 2.0 * from.omega - to.omega) / duration_s,
            third: (from.omega + to.omega - 2.0 * mean) / (duration_s * duration_s),
        }
    }

    /// A hand that intends to stay at `angle`, rad.
    #[must_use]
    pub const fn still(angle: f64) -> Self {
        Self {
            angle,
            omega: 0.0,
            second: 0.0,
            third: 0.0,
        }
    }

    /// Pose `t` seconds after the first.
    #[inline]
    #[must_use]
    pub fn at(&self, t: f64) -> Pose {
        Pose {
            angle: self.angle + t * (self.omega + t * (self.second + t * self.third)),
            omega: self.omega + t * (2.0 * self.second + t * 3.0 * self.third),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cubic_passes_through_both_poses() {
        let from = Pose {
            angle: 0.3,
            omega: -2.0,
        };
        let to = Pose {
            angle: 0.31,
            omega: 5.0,
        };
        let motion = HandMotion::between(from, to, 0.002);
        assert_eq!(motion.at(0.0), from);
        let end = motion.at(0.002);
        assert!((end.angle - to.angle).abs() < 1e-15);
        assert!((end.omega - to.omega).abs() < 1e-12);
        let (before, after) = (motion.at(0.001 - 1e-7), motion.at(0.001 + 1e-7));
        let slope = (after.angle - before.angle) / 2e-7;
        assert!((slope - motion.at(0.001).omega).abs() < 1e-6);
    }
}
