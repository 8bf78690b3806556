//! Scenes of the image: their simulated hands, and the commands that set their parameters.

use drive::named::{Known, Tuning};
use drivers::link::Hello;
use estimator_core::Hertz;
use experiments::closed_loop::{self, Hand, Press};
use haptic_control::{DualStage, SceneKind};
use simulation::device::Device;

use crate::command::Command;

/// The scene of this name.
///
/// # Errors
/// One line with all names.
pub fn named(name: &str) -> Result<SceneKind, String> {
    closed_loop::named(name, SceneKind::ALL.into_iter())
}

/// A finger that presses on the handle of this device with 10 N against a scene that resists. Its
/// target is the deflection of the scene's stiffness plus that of the hand's compliance.
#[must_use]
pub fn press(scene: SceneKind, device: &Device) -> Hand {
    let torque = 10.0 * 0.5 * device.handle.diameter_m;
    // A scene without a stiffness is pressed to the position of the wall.
    let of = |scene| stiffness(scene, &device.stages);
    let stiffness = of(scene).or_else(|| of(SceneKind::Wall));
    let stiffness = f64::from(stiffness.expect("a wall has a stiffness"));
    let compliance = torque / stiffness + torque / device.hand.stiffness_nm_per_rad;
    Hand::Pressing(Press {
        // The wall begins at 0.1 rad.
        angle: 0.1 + compliance,
        moving_s: 0.8,
        rest_s: 0.6,
    })
}

/// The default stiffness of a scene on this device, N·m/rad, if it has one.
#[must_use]
pub fn stiffness(scene: SceneKind, device: &DualStage) -> Option<f32> {
    const RATE: Hertz = Hertz(10e3);
    let usual = scene.usual(device, RATE).ok()?;
    usual.value(scene.parameter("stiffness")?, RATE)
}

/// Parses `stiffness=0.2` to the value for the parameter of a scene.
fn parsed(scene: SceneKind, text: &str) -> Result<Tuning, String> {
    let (name, value) = text
        .split_once('=')
        .ok_or("must be NAME=VALUE@S, for example stiffness=0.2@1.5")?;
    let value = value
        .parse()
        .map_err(|_| format!("'{value}' is not a number"))?;
    Tuning::new(scene, name, value).map_err(|failure| failure.to_string())
}

/// Parses `stiffness=0.2` to the command that sets the parameter. `check` and the image check the bounds of
/// the value.
///
/// # Errors
/// One line on another text, on a name that is not a parameter of the scene, or on a value that is not finite.
pub fn tune(scene: SceneKind, text: &str) -> Result<Command, String> {
    let tuning = parsed(scene, text).map_err(|error| format!("--tune {text}: {error}"))?;
    let value = tuning.value();
    Ok(match scene {
        SceneKind::Torque => Command::Torque(value),
        _ => Command::Tune {
            scene: scene.number(),
            parameter: tuning.number(),
            value,
        },
    })
}

/// Checks that the image takes the value of a text of [`tune`], after those that are `known`.
///
/// # Errors
/// One line with the bounds; as [`tune`].
pub(crate) fn check(
    scene: SceneKind,
    text: &str,
    hello: &Hello,
    known: &mut Known,
) -> Result<(), String> {
    let set = |tuning| known.set(&tuning, hello).map_err(|it| it.to_string());
    let set = parsed(scene, text).and_then(set);
    set.map_err(|error| format!("--tune {text}: {error}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parameter_text_is_parsed_to_a_command_or_refused() {
        let wall = named("wall").unwrap();
        let command = Command::Tune {
            scene: 2,
            parameter: 1,
            value: 0.2,
        };
        assert_eq!(tune(wall, "stiffness=0.2"), Ok(command));
        let torque = tune(SceneKind::Torque, "torque=-0.01");
        assert_eq!(torque, Ok(Command::Torque(-0.01)));
        for (text, said) in [
            ("stiffness", "must be NAME=VALUE@S"),
            (
                "softness=1",
                "no parameter of wall 'softness'; did you mean stiffness? there are position, stiffness, damping",
            ),
            ("stiffness=soft", "'soft' is not a number"),
            ("stiffness=inf", "not finite; give a number"),
        ] {
            assert!(tune(wall, text).unwrap_err().contains(said), "{text}");
        }
        let off = tune(SceneKind::Off, "torque=1").unwrap_err();
        assert!(off.ends_with("scene off has no parameter"), "{off}");
    }

    #[test]
    fn press_is_as_far_as_the_device_and_its_hand_yield() {
        let angle = |device: &Device| match press(SceneKind::Wall, device) {
            Hand::Pressing(press) => press.angle - 0.1,
            hand => panic!("{hand:?}"),
        };
        // 10 N at a radius of 35 mm into a wall of 0.3 N.m/rad and a hand of 0.5 N.m/rad.
        let mut device = Device::default();
        assert!((angle(&device) - (0.35 / 0.3 + 0.35 / 0.5)).abs() < 1e-6);
        device.handle.diameter_m = 0.1;
        device.hand.stiffness_nm_per_rad = 1.0;
        assert!((angle(&device) - (0.5 / 0.3 + 0.5 / 1.0)).abs() < 1e-6);
    }

    #[test]
    fn every_scene_is_found_by_name_and_listed_in_the_error() {
        let error = named("tarpit").unwrap_err();
        for scene in SceneKind::ALL {
            assert_eq!(named(scene.name()), Ok(scene));
            assert!(error.contains(scene.name()), "{error}");
        }
    }

    #[test]
    fn every_parameter_has_a_command() {
        for scene in SceneKind::ALL {
            for parameter in scene.facts().parameters {
                let text = format!("{}=0.01", parameter.name);
                assert!(tune(scene, &text).is_ok(), "{scene} {text}");
            }
        }
    }
}
