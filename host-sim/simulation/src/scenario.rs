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
use terminal::checksum::Sum;

/// Purpose of a scenario. It decides where the scenario is used by default.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Role {
    /// The paper's experiment. Presets are tuned on it, and the report's figures show it.
    Tuning,
    /// Motion with friction that no preset of a plain filter is tuned on.
    Judging,
    /// The model of the Kalman filters: a plant without friction under known white noise.
    Linear,
    /// A device that changes during the run. It is not compared by default.
    Warming,
    /// Motion for one question. It is not compared by default, so that figures over all compared
    /// scenarios stay comparable.
    Special,
}

/// Bounds of the large motor's speed in a run of 10 s on the default device, rad/s.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Speeds {
    /// Bounds of the largest speed.
    pub largest: [f64; 2],
    /// Bounds of the root mean square of the speed.
    pub rms: [f64; 2],
}

impl Speeds {
    const fn within(largest: [f64; 2], rms: [f64; 2]) -> Self {
        Self { largest, rms }
    }
}

/// A row of the table of scenarios.
struct ScenarioRow {
    /// Name on the command line and in reports.
    name: &'static str,
    /// Description, in one line.
    description: &'static str,
    role: Role,
    /// Default duration of a run, s.
    seconds: f64,
    /// Bounds that the motion of the scenario keeps; a test checks them.
    speeds: Speeds,
    /// Whether the plant has the friction and the ripple of the device. Otherwise it has neither.
    friction: bool,
    /// Whether the scenario's own loop reads the reference encoder. That encoder is only simulated
    /// if it is read.
    reads_reference: bool,
    /// Whether the scenario's own loop reads the small encoder. An encoder that is not read is only
    /// simulated for a trace with its column.
    reads_small: bool,
    /// Builds the scenario for a device, a control period (s) and a source of random numbers.
    build: fn(&Device, f64, Xoshiro256PlusPlus) -> Box<dyn Scenario>,
}

impl ScenarioRow {
    /// Defaults of the fields. A row of the table lists the fields that differ.
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
        /// All scenarios.
        #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
        pub enum ScenarioName {
            $($(#[$about])* $Name,)+
        }

        impl ScenarioName {
            /// All scenarios, in the order of reports.
            pub const ALL: [Self; [$(stringify!($Name)),+].len()] = [$(Self::$Name),+];

            const ROWS: [ScenarioRow; Self::ALL.len()] =
                [$(ScenarioRow { $($fact)* ..ScenarioRow::USUAL }),+];
        }
    };
}

scenarios! {
    /// Current steps, open loop.
    Step {
        name: "step",
        description: "current on at 0.15 to 0.9 A and off each 0.25 s, open loop, handle clamped",
        // The current is on half of the time: sqrt(1/2) of 24 rad/s, the RMS of the levels, less
        // the rise.
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
    const fn row(self) -> &'static ScenarioRow {
        &Self::ROWS[self as usize]
    }

    /// All scenarios of these roles, in the order of reports.
    #[must_use]
    pub fn of(roles: &[Role]) -> Vec<Self> {
        let has_role = |scenario: &Self| roles.contains(&scenario.role());
        Self::ALL.into_iter().filter(has_role).collect()
    }

    /// The scenarios that are compared by default.
    #[must_use]
    pub fn compared() -> Vec<Self> {
        Self::of(&[Role::Tuning, Role::Judging, Role::Linear])
    }

    /// The scenarios with friction on a device that does not change during the run.
    #[must_use]
    pub fn with_friction() -> Vec<Self> {
        Self::of(&[Role::Tuning, Role::Judging])
    }

    /// Purpose of the scenario.
    #[must_use]
    pub const fn role(self) -> Role {
        self.row().role
    }

    /// Name on the command line and in reports.
    #[must_use]
    pub const fn as_str(self) -> &'static str {
        self.row().name
    }

    /// Description, in one line.
    #[must_use]
    pub const fn description(self) -> &'static str {
        self.row().description
    }

    /// Default duration of a run, s.
    #[must_use]
    pub const fn default_seconds(self) -> f64 {
        self.row().seconds
    }

    /// Bounds that the speed keeps in a run of 10 s on the default device.
    #[must_use]
    pub const fn speeds(self) -> Speeds {
        self.row().speeds
    }

    /// Whether the scenario's own loop reads the reference encoder. That encoder is only simulated
    /// if it is read.
    #[must_use]
    pub const fn reads_reference(self) -> bool {
        self.row().reads_reference
    }

    /// Whether the scenario's own loop reads the small encoder. An encoder that is not read is only
    /// simulated for a trace with its column.
    #[must_use]
    pub const fn reads_small(self) -> bool {
        self.row().reads_small
    }

    /// Whether the plant is linear: it has no friction and no ripple, even if the device has them.
    #[must_use]
    pub const fn linear_plant(self) -> bool {
        !self.row().friction
    }

    /// Seed of all random numbers of this scenario, from the seed of the run.
    pub fn mix(self, seed: u64) -> u64 {
        // With the name, so that two scenarios with one seed draw independent numbers.
        let mut inputs = Sum::default();
        inputs.add(&seed.to_le_bytes());
        inputs.add(self.as_str().as_bytes());
        inputs.0
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

/// Builds the scenario `name` for `device` and a control period, with random numbers from `seed`.
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
mod tests;
