//! The intended motion of a hand that a client guides.

use simulation::plant::{Grip, HandMotion, Pose};

use super::Hold;
use crate::run::HAND_HZ;

/// Rate of the two equal poles with which the hand follows its target, 1/s. A step of the target is
/// followed to 90 % within 40 ms.
pub const FOLLOWING_PER_S: f64 = 100.0;

/// Largest velocity of the hand, rad/s. A step of a mouse is no shock, and the firmware's limit for the
/// handle is not reached by a motion in free air.
pub const FASTEST_RAD_S: f64 = 12.0;

/// A hand that follows a target: two equal poles, and a largest velocity.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Guided {
    /// Target, rad; `None` if the hand has let go.
    target: Option<f64>,
    /// Intended position and velocity.
    pose: Pose,
}

impl Guided {
    /// The hand after `hold`. A hand that takes hold begins at the handle's pose.
    pub(crate) fn after(before: Option<Self>, hold: Hold, handle: Pose) -> Self {
        match (hold, before) {
            (Hold::Free, _) => Self {
                target: None,
                pose: handle,
            },
            (
                Hold::At(angle),
                Some(Self {
                    target: Some(_),
                    pose,
                }),
            ) => Self {
                target: Some(angle),
                pose,
            },
            (Hold::At(angle), _) => Self {
                target: Some(angle),
                pose: handle,
            },
        }
    }

    /// Intended pose; `None` if the hand has let go.
    pub(crate) fn pose(&self) -> Option<Pose> {
        self.target.map(|_| self.pose)
    }

    /// The grip during the next tick of the hand.
    pub(crate) fn grip(&mut self) -> Grip {
        let Some(target) = self.target else {
            return Grip::Free;
        };
        let period_s = 1.0 / HAND_HZ;
        let from = self.pose;
        let (a, error) = (FOLLOWING_PER_S, target - from.angle);
        let omega = from.omega + period_s * a * (a * error - 2.0 * from.omega);
        let omega = omega.clamp(-FASTEST_RAD_S, FASTEST_RAD_S);
        self.pose = Pose {
            angle: from.angle + 0.5 * period_s * (from.omega + omega),
            omega,
        };
        Grip::Hand(HandMotion::between(from, self.pose, period_s))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn run(guided: &mut Guided, seconds: f64) -> (f64, f64) {
        let (mut fastest, mut farthest) = (0.0_f64, f64::MIN);
        for _ in 0..(seconds * HAND_HZ) as usize {
            let _ = guided.grip();
            fastest = fastest.max(guided.pose.omega.abs());
            farthest = farthest.max(guided.pose.angle);
        }
        (fastest, farthest)
    }

    #[test]
    fn hand_reaches_its_target_without_overshoot_and_within_its_velocity() {
        let mut guided = Guided::after(None, Hold::At(2.0), Pose::default());
        let (fastest, farthest) = run(&mut guided, 0.5);
        assert!(fastest > 0.9 * FASTEST_RAD_S && fastest <= FASTEST_RAD_S);
        assert!((guided.pose.angle - 2.0).abs() < 1e-3 && farthest < 2.0 + 0.1);
        let mut small = Guided::after(None, Hold::At(0.1), Pose::default());
        run(&mut small, 0.04);
        assert!((0.09..0.1001).contains(&small.pose.angle), "{small:?}");
    }

    #[test]
    fn hand_that_takes_hold_begins_at_the_handle_and_goes_on_from_its_pose() {
        let handle = Pose {
            angle: 0.4,
            omega: 1.0,
        };
        let held = Guided::after(None, Hold::At(0.0), handle);
        assert_eq!(held.pose(), Some(handle));
        let moved = Guided::after(Some(held), Hold::At(0.1), Pose::default());
        assert_eq!(moved.pose(), Some(handle));
        let free = Guided::after(Some(moved), Hold::Free, Pose::default());
        assert_eq!(free.pose(), None);
        assert_eq!(
            Guided::after(Some(free), Hold::At(0.1), handle).pose(),
            Some(handle)
        );
    }
}
