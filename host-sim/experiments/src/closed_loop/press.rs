//! A hand that presses on something and lets go.

use simulation::plant::{Grip, HandMotion, Pose};

/// Moves from 0 to `angle` along a curve of least jerk, rests there, and comes back the same way.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Press {
    /// Where to, rad.
    pub angle: f64,
    /// Duration of each way, s.
    pub moving_s: f64,
    /// Duration of the rest between them, s.
    pub rest_s: f64,
}

impl Press {
    /// What the hand intends `t` seconds after the start.
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

    /// The hand during tick `k`.
    pub(super) fn grip(&self, k: u64, period_s: f64) -> Grip {
        let at = |k: u64| self.at(k as f64 * period_s);
        Grip::Hand(HandMotion::between(at(k), at(k + 1), period_s))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_press_goes_there_and_back_at_the_velocity_that_it_says() {
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
