//! Scenes by name, and the hands that play with them.

use std::fmt;
use std::str::FromStr;

use estimator_core::Hertz;
use haptic_control::{
    Detents, DualStage, Excite, FreeAir, Hold, Inertia, Off, Radians, Scene, Senses, SpringDamper,
    Texture, Viscous, Wall,
};
use rand_xoshiro::Xoshiro256PlusPlus;
use rand_xoshiro::rand_core::SeedableRng;

use super::press::Press;
use super::tracking::Tracking;
use catalogue::estimators::{Estimator, Kind};
use simulation::plant::{Grip, Pose};
use simulation::scenario::{Intent, draw};
use terminal::wording::unknown;

/// A scene with its parameters. Angles count from where the handle starts.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum SceneName {
    /// No current at all.
    Off,
    /// Nothing to feel.
    FreeAir,
    /// A wall at 0.1 rad: stiffness N.m/rad, damping N.m.s/rad.
    Wall(f32, f32),
    /// A spring and damper to the start: stiffness N.m/rad, damping N.m.s/rad.
    SpringDamper(f32, f32),
    /// A viscous field: damping N.m.s/rad.
    Viscous(f32),
    /// Detents: amplitude N.m, number a turn.
    Detents(f32, u16),
    /// A vibration: amplitude N.m, frequency Hz.
    Texture(f32, f32),
    /// A hold: stiffness N.m/rad, damping N.m.s/rad.
    Hold(f32, f32),
    /// An inertia, as part of the handle's own; less than zero takes some of that away.
    Inertia(f32),
    /// The excitation from which the device is identified; nothing to feel, so not in `ALL`.
    Excite,
}

/// Something to do with a scene of whichever type.
pub trait Visit {
    /// Does it.
    fn visit<S: Scene<Acceleration: Senses<Estimator>>>(self, scene: S);
}

impl SceneName {
    /// Every scene with its usual parameters.
    pub const ALL: [Self; 9] = [
        Self::Off,
        Self::FreeAir,
        Self::Wall(0.30, 0.0),
        Self::SpringDamper(0.10, 0.5e-3),
        Self::Viscous(2e-3),
        Self::Detents(8e-3, 24),
        Self::Texture(6e-3, 150.0),
        Self::Hold(0.20, 1e-3),
        Self::Inertia(-0.4),
    ];

    /// Name on the command line.
    #[must_use]
    pub const fn as_str(self) -> &'static str {
        match self {
            Self::Off => "off",
            Self::FreeAir => "free-air",
            Self::Wall(..) => "wall",
            Self::SpringDamper(..) => "spring-damper",
            Self::Viscous(..) => "viscous",
            Self::Detents(..) => "detents",
            Self::Texture(..) => "texture",
            Self::Hold(..) => "hold",
            Self::Inertia(..) => "inertia",
            Self::Excite => "excite",
        }
    }

    /// Whether the large motor renders it, so that somebody's estimate of its velocity closes the
    /// loop.
    #[must_use]
    pub const fn asks_for_velocity(self) -> bool {
        !matches!(
            self,
            Self::Off | Self::Detents(..) | Self::Texture(..) | Self::Excite
        )
    }

    /// Whether it reads the handle's acceleration, which not every estimator gives.
    #[must_use]
    pub const fn asks_for_acceleration(self) -> bool {
        matches!(self, Self::Inertia(..))
    }

    /// All scenes that can be had with an estimator of the handle.
    pub fn all_with(handle: &Kind) -> impl Iterator<Item = Self> {
        let gives = handle.gives_acceleration();
        let all = Self::ALL.into_iter();
        all.filter(move |scene| gives || !scene.asks_for_acceleration())
    }

    /// Shows the scene, as its type, to a visitor.
    pub(super) fn visit(
        self,
        rate_hz: f64,
        believed: &DualStage,
        visit: impl Visit,
    ) -> Result<(), String> {
        let refused = |error: haptic_control::DesignError| format!("scene {self}: {error}");
        let origin = Radians(0.0);
        match self {
            Self::Off => visit.visit(Off),
            Self::FreeAir => visit.visit(FreeAir),
            Self::Wall(k, b) => visit.visit(Wall::new(Radians(0.1), k, b).map_err(refused)?),
            Self::SpringDamper(k, b) => {
                visit.visit(SpringDamper::new(origin, k, b).map_err(refused)?);
            }
            Self::Viscous(b) => visit.visit(Viscous::new(b).map_err(refused)?),
            Self::Detents(a, n) => visit.visit(Detents::new(a, n).map_err(refused)?),
            Self::Texture(a, f) => {
                let frequency = Hertz(f64::from(f));
                visit.visit(Texture::new(a, frequency, Hertz(rate_hz)).map_err(refused)?);
            }
            Self::Hold(k, b) => visit.visit(Hold::new(k, b).map_err(refused)?),
            Self::Inertia(part) => {
                let own = believed.small.inertia as f32;
                visit.visit(Inertia::new(part * own, own).map_err(refused)?);
            }
            Self::Excite => visit.visit(Excite::new(believed, Hertz(rate_hz)).map_err(refused)?),
        }
        Ok(())
    }
}

impl fmt::Display for SceneName {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(self.as_str())
    }
}

impl FromStr for SceneName {
    type Err = String;

    fn from_str(name: &str) -> Result<Self, String> {
        Self::ALL
            .into_iter()
            .find(|scene| scene.as_str() == name)
            .ok_or_else(|| unknown("scene", name, Self::ALL.map(Self::as_str)))
    }
}

/// Who holds the handle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Hand {
    /// Moves at 0.3 to 4 Hz and trembles, as in the open-loop scenario free-air.
    Moving,
    /// Swings into the angle of the wall and back, and trembles.
    Pushing,
    /// Moves as the slip of the open-loop scenario track does: chirps and reversals.
    Tracking,
    /// Means to keep the handle still and trembles.
    Still,
    /// Nobody: the handle starts with this velocity, rad/s.
    Gone(f64),
    /// Presses and lets go, without tremor.
    Pressing(Press),
    /// Not a hand: a clamp.
    Clamp,
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
    /// What holds the handle during tick `k`, which follows the one asked for before.
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

    /// Where the handle is at first.
    #[must_use]
    pub fn start(self, period_s: f64, seed: u64) -> Pose {
        match (self.intent(period_s, seed), self) {
            (Some(intent), _) => intent.start(),
            (None, Self::Gone(omega)) => Pose { angle: 0.0, omega },
            (None, _) => Pose::default(),
        }
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
