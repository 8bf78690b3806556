//! How the motor's state depends on a parameter, from tick to tick and through corrections.

use super::correction::Innovation;
use super::design::Gain;
use super::inputs::Push;
use super::motion::{Motion, Step};

/// One tick as [`Learning::follow`](super::Learning::follow) sees it.
pub struct Tick<'a> {
    pub(super) motion: &'a Motion,
    pub(super) push: Push,
    pub(super) handle: f32,
    pub(super) before: f32,
    pub(super) step: &'a Step,
    pub(super) load_decay: f32,
}

/// One innovation as [`Learning::learn`](super::Learning::learn) sees it.
pub struct Lesson<'a> {
    pub(super) innovation: &'a Innovation,
    pub(super) gain: &'a Gain,
    /// The innovation's error in its range, counts.
    pub(super) error: f32,
    /// Whether every tick may have an innovation.
    pub(super) dense: bool,
    /// Whether its gain is that of a start in motion.
    pub(super) starting: bool,
    /// Gain of the position at the tick's end.
    pub(super) position: f32,
    /// Velocity after the correction, counts a tick.
    pub(super) velocity: f32,
}

/// How the motor's state depends on one parameter.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Dependence {
    pub(super) position: f32,
    pub(super) velocity: f32,
    pub(super) load: f32,
}

impl Dependence {
    /// After a tick over which the parameter accelerates by `regressor`.
    #[inline(always)]
    pub(super) fn after(self, regressor: f32, tick: &Tick<'_>) -> Self {
        let motion = tick.motion;
        let load = self.load * tick.load_decay;
        if tick.step.stuck {
            return Self {
                position: self.position + 0.5 * motion.phi1 * self.velocity,
                velocity: 0.0,
                load,
            };
        }
        let force = regressor + self.load;
        Self {
            position: self.position + motion.phi1 * self.velocity + motion.phi2 * force,
            velocity: motion.phi0 * self.velocity + motion.phi1 * force,
            load,
        }
    }

    /// On the position when the innovation was.
    #[inline(always)]
    pub(super) fn then(self, innovation: &Innovation) -> f32 {
        self.position - innovation.age * self.velocity
    }

    /// After the correction of an innovation that depends by `h`.
    #[inline(always)]
    pub(super) fn corrected(self, lesson: &Lesson<'_>, h: f32) -> Self {
        Self {
            position: self.position - lesson.position * h,
            velocity: self.velocity - lesson.gain.velocity * h,
            load: self.load - lesson.gain.load * h,
        }
    }
}
