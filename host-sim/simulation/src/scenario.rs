//! Scenarios: who commands which current, and who holds the handle how.
//!
//! A scenario is deterministic in its name, the seed and the rate. Amplitudes, frequencies,
//! phases, order and start angle come from name and seed alone, so that the same seed intends
//! the same motion at every rate. Those that need a wanted slip are closed by a plain
//! evaluation loop on the reference encoder and the small encoder, as in the paper: no estimator
//! under test takes part.

mod clamped;
mod creep;
mod hand;
mod permanent;
mod servo;
mod step;
mod stochastic;
mod texture;
mod track;
mod wall;

pub use hand::Intent;
pub use stochastic::{CURRENT_STD_A, TORQUE_INTENSITY_NM2_S};
pub use track::Track;

use crate::device::Device;
use crate::plant::{Grip, Pose};
use rand_xoshiro::{
    Xoshiro256PlusPlus,
    rand_core::{Rng, SeedableRng},
};
use std::{fmt, str::FromStr};

/// Every scenario there is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum ScenarioName {
    /// Current steps, open loop.
    Step,
    /// Constant slip.
    Permanent,
    /// Chirp and reversals of slip.
    Track,
    /// A moving hand that should feel nothing.
    FreeAir,
    /// A virtual wall.
    Wall,
    /// A vibration of 50 to 300 Hz.
    Texture,
    /// Very slow motion.
    Creep,
    /// A trembling hand that holds still.
    Hold,
    /// A linear plant under known noise.
    Stochastic,
    /// A coupler that warms up.
    Heating,
}

impl ScenarioName {
    /// All scenarios, in the order of reports.
    pub const ALL: [Self; 10] = [
        Self::Step,
        Self::Permanent,
        Self::Track,
        Self::FreeAir,
        Self::Wall,
        Self::Texture,
        Self::Creep,
        Self::Hold,
        Self::Stochastic,
        Self::Heating,
    ];

    /// The scenarios whose plant has friction and whose device stays as it is.
    pub const WITH_FRICTION: [Self; 8] = [
        Self::Step,
        Self::Permanent,
        Self::Track,
        Self::FreeAir,
        Self::Wall,
        Self::Texture,
        Self::Creep,
        Self::Hold,
    ];

    /// Name on the command line and in reports.
    #[must_use]
    pub const fn as_str(self) -> &'static str {
        match self {
            Self::Step => "step",
            Self::Permanent => "permanent",
            Self::Track => "track",
            Self::FreeAir => "free-air",
            Self::Wall => "wall",
            Self::Texture => "texture",
            Self::Creep => "creep",
            Self::Hold => "hold",
            Self::Stochastic => "stochastic",
            Self::Heating => "heating",
        }
    }

    /// What happens, in one line.
    #[must_use]
    pub const fn description(self) -> &'static str {
        match self {
            Self::Step => {
                "current on at 0.15 to 0.9 A and off each 0.25 s, open loop, handle clamped"
            }
            Self::Permanent => "constant slip of 2 to 20 rad/s, 1 s each, handle clamped",
            Self::Track => "slip chirp of 0.5 to 20 Hz and triangular reversals, handle clamped",
            Self::FreeAir => "hand moves at 0.3 to 4 Hz and trembles, zero torque wanted",
            Self::Wall => "hand pushes into a wall of 0.30 N.m/rad at 0.10 rad",
            Self::Texture => "vibration of 6 mN.m from 50 to 300 Hz over slow motion of the hand",
            Self::Creep => "0.05 rad/s both ways, handle clamped",
            Self::Hold => "a hand trembling at 8 to 12 Hz holds still, zero torque wanted",
            Self::Stochastic => "linear frictionless plant under known white noise, handle clamped",
            Self::Heating => "the motion of track while the coupler loses damping, 30 % in 60 s",
        }
    }

    /// Length of a run unless told otherwise, s.
    #[must_use]
    pub const fn default_seconds(self) -> f64 {
        match self {
            Self::Heating => 60.0,
            _ => 10.0,
        }
    }

    /// Whether its loop reads the reference encoder; if not, that encoder is not simulated.
    #[must_use]
    pub const fn reads_reference(self) -> bool {
        !matches!(self, Self::Step | Self::Stochastic)
    }

    /// Whether its loop reads the small encoder; if not, only a trace that wants it has it.
    #[must_use]
    pub const fn reads_small(self) -> bool {
        matches!(
            self,
            Self::FreeAir | Self::Wall | Self::Texture | Self::Hold
        )
    }

    /// Whether it takes the linear plant, without friction or ripple, whatever the device.
    #[must_use]
    pub const fn linear_plant(self) -> bool {
        matches!(self, Self::Stochastic)
    }

    /// Seed of everything drawn for this scenario.
    pub fn mix(self, seed: u64) -> u64 {
        // FNV-1a of the name, so that two scenarios of one seed have nothing in common.
        let hash = |state: u64, byte: u8| (state ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3);
        seed.to_le_bytes()
            .into_iter()
            .chain(self.as_str().bytes())
            .fold(0xcbf2_9ce4_8422_2325, hash)
    }
}

impl fmt::Display for ScenarioName {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(self.as_str())
    }
}

impl FromStr for ScenarioName {
    type Err = String;

    fn from_str(name: &str) -> Result<Self, String> {
        let known = Self::ALL.map(Self::as_str);
        match known.iter().position(|&one| one == name) {
            Some(k) => Ok(Self::ALL[k]),
            None => Err(terminal::wording::unknown("scenario", name, known)),
        }
    }
}

/// What a scenario's own loop may see at a tick; an encoder that it does not read stays at zero.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Seen {
    /// Reference encoder on the large motor, counts modulo 2^32.
    pub(crate) reference: u32,
    /// Small encoder, counts modulo 2^32.
    pub(crate) small: u32,
}

/// What a scenario decides for one tick.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Drive {
    /// Command to the large motor, A.
    pub(crate) large_a: f64,
    /// Command to the small motor, A.
    pub(crate) small_a: f64,
    /// Who holds the handle.
    pub(crate) grip: Grip,
    /// Damping b as a part of the device's.
    pub(crate) damping_part: f64,
}

impl Drive {
    /// Currents with the handle clamped and the coupler cold.
    pub(crate) const fn clamped(large_a: f64, small_a: f64) -> Self {
        Self {
            large_a,
            small_a,
            grip: Grip::Clamped,
            damping_part: 1.0,
        }
    }
}

/// One scenario, running.
pub(crate) trait Scenario {
    /// Where the handle is at first.
    fn start(&self) -> Pose {
        Pose::default()
    }

    /// Intensity of a white torque on the large shaft, N^2.m^2.s (two-sided spectral density).
    fn torque_intensity(&self) -> f64 {
        0.0
    }

    /// Decides for tick `k` from what the encoders say at its start; ticks come in order.
    fn tick(&mut self, k: u64, seen: Seen) -> Drive;
}

/// The scenario of this name on this device.
pub(crate) fn build(
    name: ScenarioName,
    device: &Device,
    period_s: f64,
    seed: u64,
) -> Box<dyn Scenario> {
    let random = Xoshiro256PlusPlus::seed_from_u64(name.mix(seed));
    match name {
        ScenarioName::Step => Box::new(step::Step::new(period_s, random)),
        ScenarioName::Permanent => Box::new(clamped::follow(
            permanent::Permanent::new(random),
            device,
            period_s,
        )),
        ScenarioName::Track => {
            Box::new(clamped::follow(track::Track::new(random), device, period_s))
        }
        ScenarioName::FreeAir => Box::new(hand::free_air(device, period_s, random)),
        ScenarioName::Wall => Box::new(wall::Wall::new(device, period_s, random)),
        ScenarioName::Texture => Box::new(texture::Texture::new(device, period_s, random)),
        ScenarioName::Creep => {
            Box::new(clamped::follow(creep::Creep::new(random), device, period_s))
        }
        ScenarioName::Hold => Box::new(hand::hold(device, period_s, random)),
        ScenarioName::Stochastic => Box::new(stochastic::Stochastic::new(random)),
        ScenarioName::Heating => Box::new(
            clamped::follow(track::Track::new(random), device, period_s)
                .heating(device.coupler.fall_at_60_s),
        ),
    }
}

/// Uniform in `low..high`.
pub fn draw(random: &mut Xoshiro256PlusPlus, low: f64, high: f64) -> f64 {
    let unit = (random.next_u64() >> 11) as f64 * (0.5_f64).powi(53);
    low + (high - low) * unit
}

/// Either sign.
pub fn draw_sign(random: &mut Xoshiro256PlusPlus) -> f64 {
    if random.next_u64() >> 63 == 0 {
        1.0
    } else {
        -1.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_read_back_and_an_unknown_one_lists_them() {
        for name in ScenarioName::ALL {
            assert_eq!(name.to_string().parse(), Ok(name));
        }
        let error = "free_air".parse::<ScenarioName>().unwrap_err();
        assert!(
            error.contains("'free_air'; did you mean free-air?")
                && error.contains("step, permanent")
        );
    }

    #[test]
    fn no_two_scenarios_or_seeds_share_their_draws() {
        let mut seeds: Vec<u64> = ScenarioName::ALL
            .iter()
            .flat_map(|name| (0..100).map(|seed| name.mix(seed)))
            .collect();
        seeds.sort_unstable();
        seeds.dedup();
        assert_eq!(seeds.len(), 1000);
    }

    #[test]
    fn draws_fill_their_range() {
        let mut random = Xoshiro256PlusPlus::seed_from_u64(1);
        let draws: Vec<f64> = (0..10_000).map(|_| draw(&mut random, -2.0, 6.0)).collect();
        assert!(draws.iter().all(|x| (-2.0..6.0).contains(x)));
        let mean = draws.iter().sum::<f64>() / 10_000.0;
        assert!((mean - 2.0).abs() < 0.1, "{mean}");
        assert!(draws.iter().any(|&x| x < -1.98) && draws.iter().any(|&x| x > 5.98));
    }
}
