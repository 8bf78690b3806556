//! Scenes, parameters and estimators by their names, and the bounds of values.

mod known;

use drivers::Command;
use drivers::link::Hello;
use firmware_app::large;
use firmware_app::scene::BOUNDS;
use haptic_control::{Parameter, Quantity, SceneKind};
use terminal::failure::Failure;
use terminal::wording::unknown;
use tuned::DEVICE_FINGERPRINT;

use crate::refusal::OUT_OF_BOUNDS;

pub use known::Known;

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

/// An estimator of the default image in words.
pub(crate) fn called(number: u8) -> String {
    let name = large::NAMES.get(usize::from(number));
    name.map_or_else(
        || format!("estimator {number}"),
        |name| format!("estimator {name}"),
    )
}

/// Names of the estimators of an image, each at its number.
#[must_use]
pub fn estimators(hello: &Hello) -> &'static [&'static str] {
    let has = |feature| hello.features.has(feature);
    if has("large-foaw") {
        &large::NAMES[..1]
    } else if has("large-kalman") {
        &large::NAMES[1..]
    } else if has("large-adaptive") {
        let edge = usize::from(has("edge-capture"));
        &large::LEARNING[edge..=edge]
    } else {
        &large::NAMES
    }
}

/// Checks that an image has an estimator of this number.
///
/// # Errors
/// One line with the numbers and names of its estimators.
pub fn numbered(number: u8, hello: &Hello) -> Result<(), String> {
    let names = estimators(hello);
    if usize::from(number) < names.len() {
        return Ok(());
    }
    let all: Vec<_> = (0..)
        .zip(names)
        .map(|(number, name): (u8, _)| format!("{number} ({name})"))
        .collect();
    Err(format!(
        "the image has no estimator {number}; there are {}",
        all.join(", ")
    ))
}

/// Checks that an image takes the command that selects this estimator.
///
/// # Errors
/// One line as [`numbered`], or that the image has one estimator alone.
pub fn chosen(number: u8, hello: &Hello) -> Result<(), String> {
    match estimators(hello) {
        [one] => Err(format!("the image has {one} alone, and no choice")),
        _ => numbered(number, hello),
    }
}

/// The reason of a refusal, with the bound that a scene has beside those of its parameters.
pub(crate) fn explained(reason: &str, scene: Option<SceneKind>) -> String {
    match scene {
        Some(SceneKind::Detents) if reason == OUT_OF_BOUNDS => format!(
            "{reason}; amplitude times per-turn is at most {} {}",
            BOUNDS.stiffness,
            Quantity::Stiffness.unit()
        ),
        _ => reason.to_owned(),
    }
}

/// The scenes with parameters that last, one line each with their names.
pub(crate) fn parameters() -> String {
    let tuned = SceneKind::ALL.into_iter().filter(|scene| {
        // The set-point of the torque is no parameter that lasts.
        *scene != SceneKind::Torque && !scene.facts().parameters.is_empty()
    });
    tuned.map(line).collect()
}

/// All scenes, one line each with the names of its parameters.
#[must_use]
pub fn scenes() -> String {
    SceneKind::ALL.into_iter().map(line).collect()
}

/// A line on a scene with the names of its parameters.
fn line(scene: SceneKind) -> String {
    let names = scene.facts().parameters.iter().map(|it| it.name);
    let names: Vec<_> = names.collect();
    let line = format!("  {:<15}{}", scene.name(), names.join(", "));
    format!("{}\n", line.trim_end())
}

/// A value for a parameter of a scene.
#[derive(Clone, Copy, Debug)]
pub struct Tuning {
    scene: SceneKind,
    number: u8,
    parameter: Parameter,
    value: f32,
}

impl Tuning {
    /// The value for the parameter of this name.
    ///
    /// # Errors
    /// [`Failure::Input`] with the names that the scene has, or about a value that is not finite. The bounds are
    /// those of the image: [`Tuning::check`].
    pub fn new(scene: SceneKind, name: &str, value: f32) -> Result<Self, Failure> {
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
        let tuning = Self {
            scene,
            number,
            parameter,
            value,
        };
        match value.is_finite() {
            true => Ok(tuning),
            false => Err(Failure::Input(format!(
                "{tuning}: not finite; give a number"
            ))),
        }
    }

    /// The scene.
    pub(crate) const fn scene(&self) -> SceneKind {
        self.scene
    }

    /// Number of the parameter in the scene.
    #[must_use]
    pub const fn number(&self) -> u8 {
        self.number
    }

    /// The value, in the SI unit of the parameter's quantity: finite.
    #[must_use]
    pub const fn value(&self) -> f32 {
        self.value
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

    /// Checks the value against the bounds of an image. Those of an image for another device than that of
    /// this tool are not known: the image checks them itself.
    ///
    /// # Errors
    /// [`Failure::Input`] with the bounds.
    pub fn check(&self, hello: &Hello) -> Result<(), Failure> {
        self.within(hello.device == DEVICE_FINGERPRINT.0)
    }

    /// Checks the value against the bounds of an image for the device of this tool, before the identity of
    /// the board has come.
    ///
    /// # Errors
    /// [`Failure::Input`] with the bounds.
    pub fn check_own(&self) -> Result<(), Failure> {
        self.within(true)
    }

    /// Checks the value: whether it is whole, and if the bounds of the image are known, against them.
    fn within(&self, are_known: bool) -> Result<(), Failure> {
        let quantity = self.parameter.quantity;
        let range = quantity.range(&BOUNDS);
        let inside = !are_known || range.contains(&self.value);
        let is_whole = quantity == Quantity::DetentsPerTurn;
        if inside && !(is_whole && self.value.fract() != 0.0) {
            return Ok(());
        }
        let whole = if is_whole { "a whole number from " } else { "" };
        let (least, most) = (range.start(), range.end());
        let unit = quantity.unit();
        let unit = if unit.is_empty() {
            String::new()
        } else {
            format!(" {unit}")
        };
        Err(Failure::Input(format!(
            "{self}: out of bounds; give {whole}{least} to {most}{unit}"
        )))
    }
}

/// Scene, parameter, value and unit. The only parameter of the scene torque has its name.
impl std::fmt::Display for Tuning {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let (scene, name, value) = (self.scene, self.parameter.name, self.value);
        if scene.name() != name {
            write!(f, "{scene} ")?;
        }
        let unit = self.parameter.quantity.unit();
        let space = if unit.is_empty() { "" } else { " " };
        write!(f, "{name} {value}{space}{unit}")
    }
}

#[cfg(test)]
pub(crate) mod tests {
    use drivers::link::{FEATURES, Features};

    use super::*;

    /// The identity of an image with these features.
    pub(crate) fn hello(features: &[&str]) -> Hello {
        let flags: Vec<_> = FEATURES.iter().map(|it| features.contains(it)).collect();
        assert_eq!(flags.iter().filter(|it| **it).count(), features.len());
        Hello {
            features: Features::from_flags(&flags),
            rate: 10_000,
            device: DEVICE_FINGERPRINT.0,
            ..Hello::default()
        }
    }

    #[test]
    fn estimators_are_those_of_the_image() {
        let of = |features: &[&str]| estimators(&hello(features));
        assert_eq!(of(&["edge-capture"]), large::NAMES);
        assert_eq!(of(&["large-foaw"]), ["foaw-end-fit"]);
        assert_eq!(of(&["large-kalman"]), ["kalman-triple-steady"]);
        assert_eq!(of(&["large-adaptive"]), ["adaptive"]);
        let both = ["edge-capture", "large-adaptive"];
        assert_eq!(of(&both), ["adaptive-edge"]);
        assert_eq!(
            numbered(7, &hello(&[])).unwrap_err(),
            "the image has no estimator 7; there are 0 (foaw-end-fit), 1 (kalman-triple-steady)"
        );
        assert_eq!(
            chosen(0, &hello(&["large-foaw"])).unwrap_err(),
            "the image has foaw-end-fit alone, and no choice"
        );
        for number in 0..2 {
            assert_eq!(chosen(number, &hello(&[])), Ok(()));
        }
        assert!(numbered(1, &hello(&["large-foaw"])).is_err());
    }

    #[test]
    fn value_that_is_not_finite_is_refused_without_a_board() {
        for value in [f32::NAN, f32::INFINITY] {
            let said = Tuning::new(SceneKind::Wall, "stiffness", value).unwrap_err();
            let unit = Quantity::Stiffness.unit();
            let line = format!("wall stiffness {value} {unit}: not finite; give a number");
            assert_eq!(said.to_string(), line);
        }
    }

    #[test]
    fn bounds_of_the_own_device_are_known_without_a_board() {
        let check = |value| {
            let tuning = Tuning::new(SceneKind::Wall, "stiffness", value).unwrap();
            tuning.check_own().map_err(|it| it.to_string())
        };
        let unit = Quantity::Stiffness.unit();
        assert_eq!(check(BOUNDS.stiffness), Ok(()));
        for value in [1.01 * BOUNDS.stiffness, -0.01] {
            let said = check(value).unwrap_err();
            let end = format!("out of bounds; give 0 to {} {unit}", BOUNDS.stiffness);
            assert!(said.ends_with(&end), "{said}");
        }
    }

    #[test]
    fn number_of_detents_is_whole() {
        let check = |value| {
            let tuning = Tuning::new(SceneKind::Detents, "per-turn", value).unwrap();
            tuning.check(&hello(&[])).map_err(|it| it.to_string())
        };
        assert_eq!(check(24.0), Ok(()));
        for value in [24.5, 1001.0] {
            let said = format!(
                "detents per-turn {value}: out of bounds; give a whole number from 1 to 1000"
            );
            assert_eq!(check(value), Err(said));
        }
    }
}
