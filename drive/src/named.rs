//! Scenes, parameters and estimators by their names, and the bounds of values.

use drivers::Command;
use drivers::link::Hello;
use firmware_app::large;
use firmware_app::scene::BOUNDS;
use haptic_control::{Parameter, SceneKind};
use terminal::failure::Failure;
use terminal::wording::unknown;
use tuned::DEVICE_FINGERPRINT;

/// The scene of this name.
///
/// # Errors
/// One line with all names.
pub(crate) fn scene(name: &str) -> Result<SceneKind, String> {
    let names = SceneKind::ALL.map(SceneKind::name);
    SceneKind::named(name).ok_or_else(|| unknown("scene", name, names))
}

/// The number of an estimator of the default image, by its name.
///
/// # Errors
/// One line with all names.
pub(crate) fn estimator(name: &str) -> Result<u8, String> {
    let number = large::NAMES.iter().position(|known| *known == name);
    let number = number.and_then(|number| u8::try_from(number).ok());
    number.ok_or_else(|| unknown("estimator", name, large::NAMES))
}

/// A value for a parameter of a scene.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Tuning {
    scene: SceneKind,
    number: u8,
    parameter: Parameter,
    value: f32,
}

impl Tuning {
    /// The value for the parameter of this name.
    ///
    /// # Errors
    /// [`Failure::Input`] with the names that the scene has.
    pub(crate) fn new(scene: SceneKind, name: &str, value: f32) -> Result<Self, Failure> {
        let parameters = scene.facts().parameters;
        let known = scene
            .parameter(name)
            .and_then(|number| Some((number, *parameters.get(usize::from(number))?)));
        let Some((number, parameter)) = known else {
            return Err(Failure::Input(match parameters {
                [] => format!("scene {scene} has no parameter"),
                _ => {
                    let what = format!("parameter of {scene}");
                    unknown(&what, name, parameters.iter().map(|known| known.name))
                }
            }));
        };
        Ok(Self {
            scene,
            number,
            parameter,
            value,
        })
    }

    /// The scene.
    pub(crate) const fn scene(&self) -> SceneKind {
        self.scene
    }

    /// The command that sets the value.
    pub(crate) fn command(&self) -> Command {
        match self.scene {
            SceneKind::Torque => Command::Torque(self.value),
            scene => Command::Tune {
                scene: scene.number(),
                parameter: self.number,
                value: self.value,
            },
        }
    }

    /// Checks the value against the bounds of an image for the device of this tool. An image for
    /// another device has other bounds, and checks them itself.
    ///
    /// # Errors
    /// [`Failure::Input`] with the bounds.
    pub(crate) fn check(&self, hello: &Hello) -> Result<(), Failure> {
        let range = self.parameter.quantity.range(&BOUNDS);
        let inside = match hello.device == DEVICE_FINGERPRINT.0 {
            true => range.contains(&self.value),
            false => self.value.is_finite(),
        };
        if inside {
            return Ok(());
        }
        let (least, most) = (range.start(), range.end());
        let unit = self.parameter.quantity.unit();
        let unit = if unit.is_empty() {
            String::new()
        } else {
            format!(" {unit}")
        };
        Err(Failure::Input(format!(
            "{self}: out of bounds; give {least} to {most}{unit}"
        )))
    }
}

/// Scene, parameter, value and unit.
impl std::fmt::Display for Tuning {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let (scene, name, value) = (self.scene, self.parameter.name, self.value);
        let unit = self.parameter.quantity.unit();
        write!(
            f,
            "{scene} {name} {value}{}{unit}",
            if unit.is_empty() { "" } else { " " }
        )
    }
}
