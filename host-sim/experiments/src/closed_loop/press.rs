//! A hand that presses against the scene and releases.

use simulation::plant::{Grip, HandMotion, Pose};

/// Motion from 0 to `angle` along a minimum-jerk curve, a rest there, and the same way back.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Press {
    /// Target, rad.
    pub angle: f64,
    /// Duration of the motion in each direction, s.
    pub moving_s: f64,
    /// Duration of the rest, s.
    pub rest_s: f64,
}

impl Press {
    /// Intended angle and velocity `t` seconds after the start.
    #[must_use]
    pub fn at(&self, t: f64) -> Pose {
        let back = self.moving_s + self.rest_s;
        let (part, sign) = if t <= back {
            (t / self.moving_s, 1.0)
        } else {
            (1.0 - (t - back) / self.moving_s, -1.0)
        };
        let x = part.clamp(0.0, 1.0);
        let slope = 30.0 * x * x * (1.0 - x) * (1.0 - x);
        Pose {
            angle: self.angle * x * x * x * (10.0 - x * (15.0 - 6.0 * x)),
            omega: sign * self.angle * slope / self.moving_s,
        }
    }

    /// The grip on the handle during tick `k`.
    pub(super) fn grip(&self, k: u64, period_s: f64) -> Grip {
        let at = |k: u64| self.at(k as f64 * period_s);
        Grip::Hand(HandMotion::between(at(k), at(k + 1), period_s))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn velocity_of_a_press_is_the_slope_of_its_angle() {
        let press = Press {
            angle: 0.2,
            moving_s: 0.1,
            rest_s: 0.3,
        };
        assert_eq!(press.at(0.0), Pose::default());
        assert_eq!(press.at(0.25).angle, 0.2);
        assert_eq!(
            press.at(9.0),
            Pose {
                angle: 0.0,
                omega: -0.0
            }
        );
        for t in [0.02, 0.05, 0.2, 0.42, 0.47] {
            let slope = (press.at(t + 1e-6).angle - press.at(t - 1e-6).angle) / 2e-6;
            assert!((slope - press.at(t).omega).abs() < 1e-6, "{t}: {slope}");
        }
    }
}
