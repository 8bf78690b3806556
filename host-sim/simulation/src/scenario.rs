//! Scenarios: the currents of both motors and the grip of the handle, tick by tick.
//!
//! A scenario is deterministic in its name, the seed and the rate. Amplitudes, frequencies,
//! phases, order and start angle follow from name and seed alone, so that one seed gives the same
//! motion at every rate. A scenario that needs a certain slip closes a loop of its own on the
//! reference encoder and the small encoder, as in the paper. No estimator under test takes part in
//! that loop.

mod clamped;
mod creep;
mod draw;
mod hand;
mod micro_reversals;
mod motion;
mod permanent;
mod servo;
mod step;
mod stochastic;
mod texture;
mod track;
mod wall;

pub use draw::{draw, draw_sign};
pub use hand::Intent;
pub(crate) use motion::{Drive, EncoderCounts, Scenario};
pub use stochastic::{CURRENT_STD_A, TORQUE_INTENSITY_NM2_S};
pub use track::Track;

use crate::device::Device;
use rand_xoshiro::{Xoshiro256PlusPlus, rand_core::SeedableRng};
use std::{fmt, str::FromStr};

/// What a scenario is for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Role {
    /// The paper's experiment: presets are tuned on it, and the report's figures show it.
    Tuning,
    /// Motion with friction that no preset of a plain filter is tuned on.
    Judging,
    /// The model of the filters: a plant without friction under known white noise.
    Linear,
    /// A device that changes during the run. It runs when it is named.
    Warming,
    /// Motion for one question. It runs when it is named, so that figures over all compared
    /// scenarios keep their meaning.
    Special,
}

/// Speeds of a run of 10 s on the default device, rad/s: each between two bounds.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Speeds {
    /// Largest speed.
    pub largest: [f64; 2],
    /// Root mean square of the speed.
    pub rms: [f64; 2],
}

impl Speeds {
    const fn within(largest: [f64; 2], rms: [f64; 2]) -> Self {
        Self { largest, rms }
    }
}

/// The row of a scenario.
struct Row {
    /// Name on the command line and in reports.
    name: &'static str,
    /// Description, in one line.
    description: &'static str,
    role: Role,
    /// Length of a run unless told otherwise, s.
    seconds: f64,
    /// Speeds that its motion has to have.
    speeds: Speeds,
    /// Whether the plant has friction and ripple, as the device says; if not, it has neither.
    friction: bool,
    /// Whether its own loop reads the reference encoder; if not, that encoder is not simulated.
    reads_reference: bool,
    /// Whether its own loop reads the small encoder; if not, only a trace that wants it has it.
    reads_small: bool,
    /// The scenario on a device, with its control period in s and its source of random numbers.
    build: fn(&Device, f64, Xoshiro256PlusPlus) -> Box<dyn Scenario>,
}

impl Row {
    /// What most rows have.
    const USUAL: Self = Self {
        name: "",
        description: "",
        role: Role::Judging,
        seconds: 10.0,
        speeds: Speeds::within([0.0, f64::INFINITY], [0.0, f64::INFINITY]),
        friction: true,
        reads_reference: true,
        reads_small: false,
        build: |_, _, random| Box::new(stochastic::Stochastic::new(random)),
    };
}

/// The enumeration of the scenarios and their rows, from one list.
macro_rules! scenarios {
    ($($(#[$about:meta])* $Name:ident { $($fact:tt)* })+) => {
        /// Every scenario there is.
        #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
        pub enum ScenarioName {
            $($(#[$about])* $Name,)+
        }

        impl ScenarioName {
            /// All scenarios, in the order of reports.
            pub const ALL: [Self; [$(stringify!($Name)),+].len()] = [$(Self::$Name),+];

            const ROWS: [Row; Self::ALL.len()] = [$(Row { $($fact)* ..Row::USUAL }),+];
        }
    };
}

scenarios! {
    /// Current steps, open loop.
    Step {
        name: "step",
        description: "current on at 0.15 to 0.9 A and off each 0.25 s, open loop, handle clamped",
        // On half of the time: sqrt(1/2) of 24 rad/s, the RMS of its levels, less the rise.
        speeds: Speeds::within([30.0, 42.0], [11.0, 20.0]),
        role: Role::Tuning,
        reads_reference: false,
        build: |_, period_s, random| Box::new(step::Step::new(period_s, random)),
    }
    /// Constant slip.
    Permanent {
        name: "permanent",
        description: "constant slip of 2 to 20 rad/s, 1 s each, handle clamped",
        speeds: Speeds::within([18.0, 20.5], [11.5, 12.7]),
        role: Role::Tuning,
        build: |device, period_s, random| {
            Box::new(clamped::follow(permanent::Permanent::new(random), device, period_s))
        },
    }
    /// Chirp and reversals of slip.
    Track {
        name: "track",
        description: "slip chirp of 0.5 to 20 Hz and triangular reversals, handle clamped",
        speeds: Speeds::within([9.5, 15.6], [5.5, 10.0]),
        role: Role::Tuning,
        build: |device, period_s, random| {
            Box::new(clamped::follow(Track::new(random), device, period_s))
        },
    }
    /// A moving hand that should feel nothing.
    FreeAir {
        name: "free-air",
        description: "hand moves at 0.3 to 4 Hz and trembles, zero torque wanted",
        speeds: Speeds::within([1.5, 6.5], [0.7, 3.0]),
        reads_small: true,
        build: |device, period_s, random| Box::new(hand::free_air(device, period_s, random)),
    }
    /// A virtual wall.
    Wall {
        name: "wall",
        description: "hand pushes into a wall of 0.30 N.m/rad at 0.10 rad",
        speeds: Speeds::within([12.0, 40.0], [5.0, 20.0]),
        reads_small: true,
        build: |device, period_s, random| Box::new(wall::Wall::new(device, period_s, random)),
    }
    /// A vibration of 50 to 300 Hz.
    Texture {
        name: "texture",
        description: "vibration of 6 mN.m from 50 to 300 Hz over slow motion of the hand",
        speeds: Speeds::within([6.0, 10.0], [2.7, 3.7]),
        reads_small: true,
        build: |device, period_s, random| {
            Box::new(texture::Texture::new(device, period_s, random))
        },
    }
    /// Very slow motion.
    Creep {
        name: "creep",
        description: "0.05 rad/s both ways, handle clamped",
        speeds: Speeds::within([0.05, 0.3], [0.045, 0.065]),
        build: |device, period_s, random| {
            Box::new(clamped::follow(creep::Creep::new(random), device, period_s))
        },
    }
    /// A trembling hand that holds still.
    Hold {
        name: "hold",
        description: "a hand trembling at 8 to 12 Hz holds still, zero torque wanted",
        speeds: Speeds::within([0.2, 1.0], [0.05, 0.45]),
        reads_small: true,
        build: |device, period_s, random| Box::new(hand::hold(device, period_s, random)),
    }
    /// A linear plant under known noise.
    Stochastic {
        name: "stochastic",
        description: "linear frictionless plant under known white noise, handle clamped",
        speeds: Speeds::within([2.0, 16.0], [0.8, 3.3]),
        role: Role::Linear,
        friction: false,
        reads_reference: false,
    }
    /// A coupler that warms up.
    Heating {
        name: "heating",
        description: "the motion of track while the coupler loses damping, 30 % in 60 s",
        speeds: Speeds::within([9.5, 15.6], [5.5, 10.0]),
        role: Role::Warming,
        seconds: 60.0,
        build: |device, period_s, random| {
            let motion = clamped::follow(Track::new(random), device, period_s);
            Box::new(motion.heating(device.fall_at_60_s))
        },
    }
    /// Reversals within a few counts.
    MicroReversals {
        name: "micro-reversals",
        description: "reversals 1 to 8 counts apart at 2 to 8 Hz, no friction, open loop, handle clamped",
        speeds: Speeds::within([0.05, 0.35], [0.03, 0.2]),
        role: Role::Special,
        friction: false,
        reads_reference: false,
        build: |device, period_s, random| {
            Box::new(micro_reversals::MicroReversals::new(device, period_s, random))
        },
    }
}

impl ScenarioName {
    const fn row(self) -> &'static Row {
        &Self::ROWS[self as usize]
    }

    /// All scenarios of these roles, in the order of reports.
    #[must_use]
    pub fn of(roles: &[Role]) -> Vec<Self> {
        let has_role = |scenario: &Self| roles.contains(&scenario.role());
        Self::ALL.into_iter().filter(has_role).collect()
    }

    /// The scenarios that are compared unless others are named.
    #[must_use]
    pub fn compared() -> Vec<Self> {
        Self::of(&[Role::Tuning, Role::Judging, Role::Linear])
    }

    /// The scenarios whose plant has friction and whose device stays as it is.
    #[must_use]
    pub fn with_friction() -> Vec<Self> {
        Self::of(&[Role::Tuning, Role::Judging])
    }

    /// What it is for.
    #[must_use]
    pub const fn role(self) -> Role {
        self.row().role
    }

    /// Name on the command line and in reports.
    #[must_use]
    pub const fn as_str(self) -> &'static str {
        self.row().name
    }

    /// What happens, in one line.
    #[must_use]
    pub const fn description(self) -> &'static str {
        self.row().description
    }

    /// Length of a run unless told otherwise, s.
    #[must_use]
    pub const fn default_seconds(self) -> f64 {
        self.row().seconds
    }

    /// Speeds that its motion has to have.
    #[must_use]
    pub const fn speeds(self) -> Speeds {
        self.row().speeds
    }

    /// Whether its loop reads the reference encoder; if not, that encoder is not simulated.
    #[must_use]
    pub const fn reads_reference(self) -> bool {
        self.row().reads_reference
    }

    /// Whether its loop reads the small encoder; if not, only a trace that wants it has it.
    #[must_use]
    pub const fn reads_small(self) -> bool {
        self.row().reads_small
    }

    /// Whether it takes the linear plant, without friction or ripple, whatever the device.
    #[must_use]
    pub const fn linear_plant(self) -> bool {
        !self.row().friction
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

/// The scenario of this name on this device.
pub(crate) fn build(
    name: ScenarioName,
    device: &Device,
    period_s: f64,
    seed: u64,
) -> Box<dyn Scenario> {
    let random = Xoshiro256PlusPlus::seed_from_u64(name.mix(seed));
    (name.row().build)(device, period_s, random)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_parsed_and_an_unknown_one_lists_them() {
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
    fn draws_differ_between_scenarios_and_seeds() {
        let mut seeds: Vec<u64> = ScenarioName::ALL
            .iter()
            .flat_map(|name| (0..100).map(|seed| name.mix(seed)))
            .collect();
        seeds.sort_unstable();
        seeds.dedup();
        assert_eq!(seeds.len(), 100 * ScenarioName::ALL.len());
    }
}
