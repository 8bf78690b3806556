//! A hand that moves with the slip velocity of scenario `track`.

use rand_xoshiro::Xoshiro256PlusPlus;
use rand_xoshiro::rand_core::SeedableRng;

use simulation::plant::{Grip, HandMotion, Pose};
use simulation::scenario::{ScenarioName, Track};

/// Integral of the slip velocity, tick by tick.
pub(super) struct Tracking {
    track: Track,
    period_s: f64,
    /// Intended angle and velocity at the beginning of the next tick.
    pose: Pose,
}

impl Tracking {
    pub(super) fn new(period_s: f64, seed: u64) -> Self {
        let seed = ScenarioName::Track.mix(seed);
        Self {
            track: Track::new(Xoshiro256PlusPlus::seed_from_u64(seed)),
            period_s,
            pose: Pose::default(),
        }
    }

    /// The grip on the handle during tick `k`. Ticks are requested in order.
    pub(super) fn grip(&mut self, k: u64) -> Grip {
        let omega = self.track.omega((k + 1) as f64 * self.period_s);
        let to = Pose {
            angle: self.pose.angle + 0.5 * (self.pose.omega + omega) * self.period_s,
            omega,
        };
        let motion = HandMotion::between(self.pose, to, self.period_s);
        self.pose = to;
        Grip::Hand(motion)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn motion_has_chirp_and_reversals_and_is_continuous() {
        let mut hand = Tracking::new(1e-3, 5);
        let (mut last, mut fastest, mut reversals) = (Pose::default(), 0.0_f64, 0);
        for k in 0..10_000 {
            let Grip::Hand(motion) = hand.grip(k) else {
                panic!("a hand holds the handle");
            };
            assert!((motion.at(0.0).angle - last.angle).abs() < 1e-9, "{k}");
            assert!((motion.at(0.0).omega - last.omega).abs() < 1e-9, "{k}");
            let next = motion.at(1e-3);
            reversals += i32::from(next.omega * last.omega < 0.0);
            fastest = fastest.max(next.omega.abs());
            last = next;
        }
        assert!((10.0..=15.0).contains(&fastest), "{fastest}");
        assert!(reversals > 60, "{reversals}");
    }

    /// The hand has the velocity of the slip of scenario track at each tick, and its integral as its angle.
    #[test]
    fn hand_has_the_velocity_of_the_slip() {
        let (period, seed) = (1e-3, 5);
        let random = Xoshiro256PlusPlus::seed_from_u64(ScenarioName::Track.mix(seed));
        let mut track = Track::new(random);
        let mut tracking = Tracking::new(period, seed);
        let (mut angle, mut before) = (0.0, 0.0);
        for k in 0..2000 {
            let Grip::Hand(motion) = tracking.grip(k) else {
                panic!("a hand");
            };
            let omega = track.omega((k + 1) as f64 * period);
            angle += 0.5 * (before + omega) * period;
            before = omega;
            let end = motion.at(period);
            assert!((end.omega - omega).abs() < 1e-9, "{k}: {end:?} {omega}");
            assert!((end.angle - angle).abs() < 1e-9, "{k}: {end:?} {angle}");
        }
    }
}
