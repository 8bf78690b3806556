//! Simulated hands.

use haptic_control::SimulatedHand;
use rand_xoshiro::Xoshiro256PlusPlus;
use rand_xoshiro::rand_core::SeedableRng;
use simulation::device::Device;
use simulation::plant::{Grip, Pose};
use simulation::scenario::{Intent, draw};

use super::press::Press;
use super::tracking::Tracking;

/// The simulated hand on the handle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Hand {
    /// Moves at 0.3 to 4 Hz and trembles, as in the open-loop scenario free-air.
    Moving,
    /// Moves to beyond the wall's position and back, and trembles.
    Pushing,
    /// Moves as the slip of the open-loop scenario track does: chirps and reversals.
    Tracking,
    /// Holds the handle still and trembles.
    Still,
    /// No hand: the handle starts with this velocity, rad/s.
    Gone(f64),
    /// Presses and releases, without tremor.
    Pressing(Press),
    /// A clamp instead of a hand.
    Clamp,
}

impl From<SimulatedHand> for Hand {
    fn from(hand: SimulatedHand) -> Self {
        match hand {
            SimulatedHand::FreeMotion => Self::Moving,
            SimulatedHand::WallPress => Self::Pushing,
            SimulatedHand::HoldStill => Self::Still,
        }
    }
}

/// A hand's motion, tick by tick.
pub struct Motion(Mover);

enum Mover {
    Intent(Box<Intent>),
    Pressing(Press, f64),
    Tracking(Box<Tracking>),
    Gone,
    Clamp,
}

impl Motion {
    /// The grip on the handle during tick `k`. Ticks are requested in order.
    pub fn grip(&mut self, k: u64) -> Grip {
        match &mut self.0 {
            Mover::Intent(intent) => intent.grip(k),
            Mover::Pressing(press, period_s) => press.grip(k, *period_s),
            Mover::Tracking(tracking) => tracking.grip(k),
            Mover::Gone => Grip::Free,
            Mover::Clamp => Grip::Clamped,
        }
    }
}

impl Hand {
    /// Checks that `device` has a hand, if this motion is one of a hand.
    ///
    /// # Errors
    /// One line that names the keys of the hand.
    pub(super) fn check(self, device: &Device) -> Result<(), String> {
        let hand = device.hand;
        let is_there = hand.stiffness_nm_per_rad > 0.0 || hand.damping_nms_per_rad > 0.0;
        match self {
            Self::Gone(_) | Self::Clamp => Ok(()),
            _ if is_there => Ok(()),
            _ => Err(
                "hand.stiffness_nm_per_rad and hand.damping_nms_per_rad are both 0: no hand moves or holds the \
                 handle in the closed loop; give one of them"
                    .to_owned(),
            ),
        }
    }

    fn intent(self, period_s: f64, seed: u64) -> Option<Intent> {
        let random = &mut Xoshiro256PlusPlus::seed_from_u64(seed ^ 0x4A4D);
        let about = |random: &mut _, low, high| Intent::about(draw(random, low, high), period_s);
        Some(match self {
            Self::Moving => about(random, -0.05, 0.05)
                .sine(random, (0.3, 0.8), (0.3, 0.6))
                .sine(random, (1.0, 2.0), (0.05, 0.15))
                .sine(random, (2.5, 4.0), (0.02, 0.06))
                .tremor(random),
            Self::Pushing => about(random, 0.05, 0.10)
                .sine_from(random, (0.4, 1.2), (0.12, 0.18), (-2.2, -0.9))
                .tremor(random),
            Self::Still => about(random, -0.02, 0.02).tremor(random),
            Self::Tracking | Self::Gone(_) | Self::Pressing(_) | Self::Clamp => return None,
        })
    }

    /// Initial angle and velocity of the handle.
    #[must_use]
    pub fn start(self, period_s: f64, seed: u64) -> Pose {
        match (self.intent(period_s, seed), self) {
            (Some(intent), _) => intent.start(),
            (None, Self::Gone(omega)) => Pose { angle: 0.0, omega },
            (None, _) => Pose::default(),
        }
    }

    /// The grips of the first `ticks` ticks of `period_s`, for runs that share a hand.
    #[must_use]
    pub fn grips(self, period_s: f64, seed: u64, ticks: usize) -> Vec<Grip> {
        let mut motion = self.motion(period_s, seed);
        (0..ticks as u64).map(|k| motion.grip(k)).collect()
    }

    /// The motion for ticks of `period_s`, drawn from `seed`.
    #[must_use]
    pub fn motion(self, period_s: f64, seed: u64) -> Motion {
        Motion(match (self.intent(period_s, seed), self) {
            (Some(intent), _) => Mover::Intent(Box::new(intent)),
            (None, Self::Pressing(press)) => Mover::Pressing(press, period_s),
            (None, Self::Tracking) => Mover::Tracking(Box::new(Tracking::new(period_s, seed))),
            (None, Self::Clamp) => Mover::Clamp,
            (None, _) => Mover::Gone,
        })
    }
}
