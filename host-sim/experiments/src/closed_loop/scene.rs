//! Scenes of the catalogue in a simulated loop.

use catalogue::estimators::{Estimator, Kind};
use estimator_core::Hertz;
use haptic_control::{AnyScene, DesignError, DualStage, Scene, SceneKind, Senses, scenes};
use terminal::wording::unknown;

use super::truth::TrueMotion;

/// Operation that is generic over the type of the scene.
pub(super) trait Visit {
    /// Performs the operation.
    fn visit<S>(self, scene: S)
    where
        S: Scene<Acceleration: Senses<Estimator> + for<'a> Senses<TrueMotion<'a>>> + Clone;
}

macro_rules! visit {
    ($($number:literal, $name:literal, $scene:ident, $facts:tt;)+) => {
        /// Calls `visit` with the scene as its own type.
        pub(super) fn visit(scene: &AnyScene, visit: impl Visit) {
            match *scene {
                $(AnyScene::$scene(scene) => visit.visit(scene),)+
            }
        }
    };
}
scenes!(visit);

/// The scene with its default parameters.
///
/// # Errors
/// One line if the scene cannot be rendered with the device or at the control rate.
pub fn usual(scene: SceneKind, assumed: &DualStage, rate_hz: f64) -> Result<AnyScene, String> {
    let usual = scene.usual(assumed, Hertz(rate_hz));
    usual.map_err(|error| match error {
        DesignError::ExciteRate => format!("--rate {rate_hz}: {error}"),
        error => format!("scene {scene}: {error}"),
    })
}

/// The scene called `name` among `scenes`.
///
/// # Errors
/// One line with the names of `scenes`.
pub fn named(
    name: &str,
    scenes: impl Iterator<Item = SceneKind> + Clone,
) -> Result<SceneKind, String> {
    let found = scenes.clone().find(|scene| scene.name() == name);
    found.ok_or_else(|| unknown("scene", name, scenes.map(SceneKind::name)))
}

/// The virtual environments that are possible with this estimator of the handle. Some need an
/// acceleration, which not every estimator provides.
pub fn environments_with(handle: &Kind) -> impl Iterator<Item = SceneKind> {
    let gives = handle.gives_acceleration();
    SceneKind::environments().filter(move |scene| gives || !scene.facts().needs.acceleration)
}
