//! Deviations of a device from the nominal one, with which the controller is designed.

mod limits;

use std::fmt;
use std::str::FromStr;

use rand_xoshiro::Xoshiro256PlusPlus;
use rand_xoshiro::rand_core::{Rng, SeedableRng};
use serde::{Deserialize, Serialize};

use haptic_control::{DualStage, SceneKind};

use super::corners::corners;
use crate::closed_loop::Hand;
use simulation::device::Device;
use simulation::scenario::{draw, draw_sign};
use terminal::checksum::Sum;

/// Factors of the nominal values, and effects that the controller does not model.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Variation {
    /// Factor of the coupler's damping b.
    pub damping: f64,
    /// Factor of the large motor's inertia.
    pub large_inertia: f64,
    /// Factor of the small motor's inertia, including the handle.
    pub small_inertia: f64,
    /// Factor of the large motor's torque constant.
    pub large_constant: f64,
    /// Factor of the small motor's torque constant.
    pub small_constant: f64,
    /// Factor of the large motor's Coulomb friction.
    pub large_friction: f64,
    /// Factor of the small motor's Coulomb friction.
    pub small_friction: f64,
    /// Factor of the amplifiers' bandwidth.
    pub amplifier: f64,
    /// Delay of the currents, ticks.
    pub late_ticks: usize,
    /// Factor of the hand's stiffness and damping.
    pub hand: f64,
    /// Initial velocity of a free handle, rad/s.
    pub gone_rad_s: Option<f64>,
    /// Error of the zero of the large motor's amplifier, over its current limit.
    pub large_zero: f64,
    /// Error of the zero of the small motor's amplifier, over its current limit.
    pub small_zero: f64,
    /// Phase error of the large encoder's disc, counts.
    pub disc_phase: f64,
    /// Once-a-turn error, counts.
    pub disc_line: f64,
    /// Random error, counts.
    pub disc_random: f64,
}

/// The nominal device.
pub const NOMINAL: Variation = Variation {
    damping: 1.0,
    large_inertia: 1.0,
    small_inertia: 1.0,
    large_constant: 1.0,
    small_constant: 1.0,
    large_friction: 1.0,
    small_friction: 1.0,
    amplifier: 1.0,
    late_ticks: 0,
    hand: 1.0,
    gone_rad_s: None,
    large_zero: 0.0,
    small_zero: 0.0,
    disc_phase: 0.0,
    disc_line: 0.0,
    disc_random: 0.0,
};

/// Ranges of the uniform draws. Friction has the widest one, because it is known least.
pub(super) const DAMPING: (f64, f64) = (0.6, 1.05);
pub(super) const INERTIA: (f64, f64) = (0.7, 1.3);
pub(super) const CONSTANT: (f64, f64) = (0.8, 1.2);
pub(super) const FRICTION: (f64, f64) = (0.6, 1.5);
pub(super) const AMPLIFIER: (f64, f64) = (0.5, 1.0);
pub(super) const HAND: (f64, f64) = (1.0, 4.0);
pub(super) const DISC: (f64, f64, f64) = (0.06, 0.25, 0.02);
/// 15 steps of a converter with 2047 steps to the current limit, which an output that is not calibrated may
/// be off by.
pub(super) const ZERO: (f64, f64) = (-15.0 / 2047.0, 15.0 / 2047.0);
/// Share of the devices with a free handle.
const GONE: f64 = 0.2;
/// Initial speed of a free handle, rad/s.
pub(super) const GONE_RAD_S: (f64, f64) = (0.5, 3.0);

/// A device: a corner, or a drawn one.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Subject {
    /// A corner, by its index in [`corners`].
    Corner(usize),
    /// A drawn device, by its index.
    Drawn(u64),
}

impl Subject {
    /// The device, and the seed of the hand's motion, the encoders' phases and the disc. Both are a
    /// function of `seed`, scene and subject.
    #[must_use]
    pub fn variation(self, seed: u64, scene: SceneKind) -> (Variation, u64) {
        let mut random = self.random(seed, scene);
        let run_seed = random.next_u64();
        let mut variation = match self {
            Self::Corner(i) => corners()[i].1,
            Self::Drawn(_) => drawn(&mut random),
        };
        if let (Some(omega), SceneKind::Wall) = (&mut variation.gone_rad_s, scene) {
            // A free handle that moves away from the wall does not reach it.
            *omega = omega.abs();
        }
        (variation, run_seed)
    }

    fn random(self, seed: u64, scene: SceneKind) -> Xoshiro256PlusPlus {
        let mut inputs = Sum::default();
        inputs.add(&seed.to_le_bytes());
        inputs.add(scene.name().as_bytes());
        inputs.add(&[0]);
        inputs.add(self.to_string().as_bytes());
        Xoshiro256PlusPlus::seed_from_u64(inputs.0)
    }
}

impl fmt::Display for Subject {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Corner(i) => f.pad(corners()[*i].0),
            Self::Drawn(i) => f.pad(&i.to_string()),
        }
    }
}

impl FromStr for Subject {
    type Err = String;

    fn from_str(name: &str) -> Result<Self, String> {
        if let Ok(index) = name.parse() {
            return Ok(Self::Drawn(index));
        }
        let corners = corners();
        let found = corners.iter().position(|(known, _)| *known == name);
        found.map(Self::Corner).ok_or_else(|| {
            let known: Vec<_> = corners.iter().map(|(known, _)| *known).collect();
            format!(
                "no device '{name}': must be an index from 0 on, or one of {}",
                known.join(", ")
            )
        })
    }
}

fn drawn(random: &mut Xoshiro256PlusPlus) -> Variation {
    let mut within = |(low, high)| draw(random, low, high);
    let mut variation = Variation {
        damping: within(DAMPING),
        large_inertia: within(INERTIA),
        small_inertia: within(INERTIA),
        large_constant: within(CONSTANT),
        small_constant: within(CONSTANT),
        large_friction: within(FRICTION),
        small_friction: within(FRICTION),
        amplifier: within(AMPLIFIER),
        hand: within(HAND),
        disc_phase: within((0.0, DISC.0)),
        disc_line: within((0.0, DISC.1)),
        disc_random: within((0.0, DISC.2)),
        late_ticks: usize::from(within((0.0, 1.0)) < 0.5),
        gone_rad_s: None,
        large_zero: 0.0,
        small_zero: 0.0,
    };
    if within((0.0, 1.0)) < GONE {
        variation.gone_rad_s = Some(within(GONE_RAD_S) * draw_sign(random));
    }
    // Drawn last: the other values of a device are those of before.
    variation.large_zero = draw(random, ZERO.0, ZERO.1);
    variation.small_zero = draw(random, ZERO.0, ZERO.1);
    variation
}

impl Variation {
    /// `nominal` with these deviations.
    #[must_use]
    pub fn of(&self, nominal: &Device) -> Device {
        let mut device = nominal.clone();
        device.stages.damping *= self.damping;
        device.stages.large.inertia *= self.large_inertia;
        device.stages.small.inertia *= self.small_inertia;
        device.stages.large.torque_constant *= self.large_constant;
        device.stages.small.torque_constant *= self.small_constant;
        device.stages.large.coulomb_friction *= self.large_friction;
        device.stages.small.coulomb_friction *= self.small_friction;
        device.stages.amplifier_bandwidth.0 *= self.amplifier;
        device.hand.stiffness_nm_per_rad *= self.hand;
        device.hand.damping_nms_per_rad *= self.hand;
        device.disc.phase_counts += self.disc_phase;
        device.disc.line_counts += self.disc_line;
        device.disc.random_counts += self.disc_random;
        device
    }

    /// Currents at a command of zero, A: large motor, small motor.
    #[must_use]
    pub fn offsets_a(&self, nominal: &DualStage) -> [f64; 2] {
        [
            self.large_zero * nominal.large.current_limit,
            self.small_zero * nominal.small.current_limit,
        ]
    }

    /// The hand for `scene`.
    #[must_use]
    pub fn hand(&self, scene: SceneKind) -> Hand {
        match self.gone_rad_s {
            Some(omega) => Hand::Gone(omega),
            None => scene.facts().hand.into(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn device_is_a_function_of_seed_scene_and_index() {
        let (wall, hold) = (SceneKind::Wall, SceneKind::Hold);
        let of = |i, seed, scene| Subject::Drawn(i).variation(seed, scene);
        let forwards: Vec<_> = (0..50).map(|i| of(i, 1, wall)).collect();
        let backwards: Vec<_> = (0..50).rev().map(|i| of(i, 1, wall)).collect();
        assert!(forwards.iter().eq(backwards.iter().rev()));
        assert_ne!(of(3, 1, wall), of(3, 2, wall));
        assert_ne!(of(3, 1, wall), of(3, 1, hold));
        assert_ne!(of(3, 1, wall), of(4, 1, wall));
    }

    #[test]
    fn draws_fill_their_ranges_and_a_fifth_has_a_free_handle() {
        let scene = SceneKind::FreeAir;
        let draws: Vec<_> = (0..2000)
            .map(|i| Subject::Drawn(i).variation(1, scene).0)
            .collect();
        let check = |of: fn(&Variation) -> f64, (low, high): (f64, f64)| {
            let smallest = draws.iter().map(of).fold(f64::INFINITY, f64::min);
            let largest = draws.iter().map(of).fold(f64::NEG_INFINITY, f64::max);
            let edge = 0.01 * (high - low);
            assert!(smallest >= low && smallest < low + edge, "{smallest}");
            assert!(largest <= high && largest > high - edge, "{largest}");
        };
        check(|v| v.damping, DAMPING);
        check(|v| v.large_inertia, INERTIA);
        check(|v| v.small_inertia, INERTIA);
        check(|v| v.large_constant, CONSTANT);
        check(|v| v.small_constant, CONSTANT);
        check(|v| v.amplifier, AMPLIFIER);
        check(|v| v.hand, HAND);
        check(|v| v.large_zero, ZERO);
        check(|v| v.small_zero, ZERO);
        check(|v| v.large_friction, FRICTION);
        check(|v| v.small_friction, FRICTION);
        check(|v| v.disc_phase, (0.0, DISC.0));
        check(|v| v.disc_line, (0.0, DISC.1));
        check(|v| v.disc_random, (0.0, DISC.2));
        check(|v| v.late_ticks as f64, (0.0, 1.0));
        let gone: Vec<_> = draws.iter().filter_map(|v| v.gone_rad_s).collect();
        assert!((340..460).contains(&gone.len()), "{}", gone.len());
        let away = gone.iter().filter(|omega| **omega > 0.0).count();
        assert!((150..250).contains(&away), "{away}");
        for omega in &gone {
            assert!(
                (GONE_RAD_S.0..=GONE_RAD_S.1).contains(&omega.abs()),
                "{omega}"
            );
        }
        let fastest = gone
            .iter()
            .fold(0.0_f64, |most, omega| most.max(omega.abs()));
        assert!(fastest > 0.95 * GONE_RAD_S.1, "{fastest}");
    }
}
