//! What a page asks for, in the form of its messages.

use drive::named::{Tuning, chosen, numbered};
use drive::settings::admitted;
use drivers::link::Hello;
use drivers::{Command, Setting};
use firmware_app::large;
use haptic_control::{Request, SceneKind};
use serde::Deserialize;
use virtual_board::fault::Fault;

use crate::bench::guided;

/// A message of the page: `"arm"`, `{"hand": {"at": 0.1}}`. The key is the name of the order. A field for the
/// name would lose the numbers beside it: serde buffers the fields of a tagged variant, and a dependency
/// switches on the feature `arbitrary_precision` of `serde_json`, whose numbers cannot be read from a buffer.
#[derive(Clone, Debug, Deserialize, PartialEq)]
#[serde(rename_all = "kebab-case", deny_unknown_fields)]
pub(crate) enum Order {
    /// The page with this token wants to command.
    Join { token: String },
    /// The page lives.
    Alive,
    /// The hand holds the handle at this angle, rad; `null` lets go.
    Hand { at: Option<f64> },
    /// Enables the amplifiers.
    Arm,
    /// Disables the amplifiers.
    Disarm,
    /// Selects a scene.
    Scene { number: u8 },
    /// Sets a parameter of a scene.
    Tune {
        scene: u8,
        parameter: u8,
        value: f32,
    },
    /// Selects an estimator of the image.
    Estimator { number: u8 },
    /// Injects a fault.
    Fault { name: String },
    /// Starts the virtual board again, with all parts whole.
    Restart,
    /// Asks for the settings of the board.
    Settings,
    /// Sets a setting until the next reset.
    Set { setting: u8, value: f32 },
    /// Stores the settings in the flash of the board.
    Store,
    /// Begins a guided procedure.
    Guide { name: String },
    /// Begins or ends a recording.
    Record { on: bool },
    /// Continues or pauses the playback.
    Play { on: bool },
    /// Goes to this time of the recording, s.
    Seek { to: f64 },
    /// Sets the speed of the playback, 1 is real time.
    Speed { factor: f64 },
}

/// Largest angle of the hand, rad: beyond it the handle has turned many times.
const FARTHEST_RAD: f64 = 100.0;

impl Order {
    /// Parses a message.
    ///
    /// # Errors
    /// One line on a text that is no order.
    pub(crate) fn parse(text: &str) -> Result<Self, String> {
        serde_json::from_str(text).map_err(|error| format!("no order: {error}"))
    }

    /// Checks what the host knows of the order. The board checks its commands again.
    ///
    /// # Errors
    /// One line with the bounds.
    pub(crate) fn check(&self) -> Result<(), String> {
        match self {
            Self::Hand { at: Some(angle) } if angle.is_nan() || angle.abs() > FARTHEST_RAD => Err(
                format!("hand at {angle} rad: give -{FARTHEST_RAD} to {FARTHEST_RAD} rad"),
            ),
            Self::Scene { number } => scene(*number).map(|_| ()),
            Self::Tune {
                scene: number,
                parameter,
                value,
            } => tuning(*number, *parameter, *value).map(|_| ()),
            Self::Estimator { number } if usize::from(*number) >= large::NAMES.len() => Err(
                format!("estimator {number}: give 0 to {}", large::NAMES.len() - 1),
            ),
            Self::Fault { name } => name.parse::<Fault>().and_then(|fault| {
                if fault.acts_from_power_up() {
                    return Err(format!("fault {name} acts from power-up on"));
                }
                Ok(())
            }),
            Self::Set { setting, value } => Setting::from_number(*setting)
                .ok_or_else(|| format!("no setting {setting}"))
                .and_then(|setting| admitted(setting, *value)),
            Self::Guide { name } if guided(name).is_none() => {
                Err(format!("no guided procedure {name}"))
            }
            Self::Seek { to } if !to.is_finite() => Err("seek: not a number".to_owned()),
            Self::Speed { factor } if !(0.01..=100.0).contains(factor) => {
                Err("speed: give 0.01 to 100".to_owned())
            }
            _ => Ok(()),
        }
    }

    /// Checks what the image of the board decides, by its identity, if that has come.
    ///
    /// # Errors
    /// One line with what the image has.
    pub(crate) fn fits(&self, hello: Option<&Hello>) -> Result<(), String> {
        let identity = || hello.ok_or("the board has not told its identity yet");
        match *self {
            Self::Tune {
                scene,
                parameter,
                value,
            } => {
                let tuning = tuning(scene, parameter, value)?;
                let checked = match hello {
                    Some(hello) => tuning.check(hello),
                    None => tuning.check_own(),
                };
                checked.map_err(|failure| failure.to_string())
            }
            Self::Estimator { number } => chosen(number, identity()?),
            // The board stores every number.
            Self::Set { setting, value } if setting == Setting::Estimator.number() => {
                numbered(value as u8, identity()?)
                    .map_err(|error| format!("estimator={value}: {error}"))
            }
            _ => Ok(()),
        }
    }

    /// Whether a silent board does not get the order: every command but the one that disarms.
    pub(crate) fn needs_an_answer(&self) -> bool {
        *self != Self::Disarm && self.command().is_some()
    }

    /// Whether the order is a command with an effect of its own. A page says again and again that it lives, and asks for
    /// the settings each second.
    pub(crate) fn changes_the_board(&self) -> bool {
        !matches!(self, Self::Alive | Self::Settings) && self.command().is_some()
    }

    /// The command of the link that the order is, if it is one.
    pub(crate) fn command(&self) -> Option<Command> {
        Some(match *self {
            Self::Alive => Command::Request(Request::KeepAlive),
            Self::Arm => Command::Request(Request::Arm),
            Self::Disarm => Command::Request(Request::Disarm),
            Self::Scene { number } => Command::Request(Request::Select(number)),
            Self::Tune { scene, value, .. } if scene == SceneKind::Torque.number() => {
                Command::Torque(value)
            }
            Self::Tune {
                scene,
                parameter,
                value,
            } => Command::Tune {
                scene,
                parameter,
                value,
            },
            Self::Estimator { number } => Command::Estimator(number),
            Self::Settings => Command::Settings,
            Self::Set { setting, value } => Command::Set { setting, value },
            Self::Store => Command::Store,
            _ => return None,
        })
    }
}

/// The value for a parameter of a scene, by their numbers.
///
/// # Errors
/// One line on an unknown number, or a value that is not finite.
pub(crate) fn tuning(number: u8, parameter: u8, value: f32) -> Result<Tuning, String> {
    let scene = scene(number)?;
    let known = scene.facts().parameters.get(usize::from(parameter));
    let known = known.ok_or_else(|| format!("scene {scene} has no parameter {parameter}"))?;
    Tuning::new(scene, known.name, value).map_err(|failure| failure.to_string())
}

fn scene(number: u8) -> Result<SceneKind, String> {
    let known = SceneKind::ALL.get(usize::from(number)).copied();
    known.ok_or_else(|| format!("scene {number}: give 0 to {}", SceneKind::ALL.len() - 1))
}

#[cfg(test)]
pub(crate) mod tests {
    use drivers::link::{Features, Label, PROTOCOL};
    use firmware_app::config::DEVICE;
    use firmware_app::scene::BOUNDS;

    use super::*;

    /// The identity of an image of all scenes and both estimators, for the device of this build.
    pub(crate) fn hello() -> Hello {
        Hello {
            protocol: PROTOCOL,
            version: Label::new("0.1.0"),
            commit: Label::new("a1b2c3d"),
            features: Features::from_flags(&[]),
            rate: 10_000,
            device: DEVICE.fingerprint().0,
            presets: 0,
            cause: 0,
            brown_out_reset: true,
        }
    }

    #[test]
    fn text_that_is_no_order_is_refused() {
        for text in [
            "",
            "{}",
            "[1]",
            "\"fly\"",
            "{\"fly\":{}}",
            "{\"hand\":{\"at\":0,\"now\":1}}",
        ] {
            let refused = Order::parse(text).unwrap_err();
            assert!(refused.starts_with("no order"), "{text}");
        }
        let hand = |at| Ok(Order::Hand { at });
        assert_eq!(Order::parse(r#"{"hand":{"at":null}}"#), hand(None));
        assert_eq!(Order::parse(r#"{"hand":{"at":-0.25}}"#), hand(Some(-0.25)));
        assert_eq!(Order::parse("\"arm\""), Ok(Order::Arm));
    }

    #[test]
    fn silent_board_gets_no_command_but_disarm() {
        let commands = [Order::Arm, Order::Alive, Order::Store, Order::Settings];
        assert!(commands.iter().all(Order::needs_an_answer));
        // The others are none of the board.
        for order in [Order::Disarm, Order::Restart, Order::Record { on: false }] {
            assert!(!order.needs_an_answer(), "{order:?}");
        }
    }

    #[test]
    fn time_and_speed_of_a_playback_are_numbers_within_bounds() {
        let is_speed = |factor| Order::Speed { factor }.check().is_ok();
        assert!(is_speed(0.01) && is_speed(100.0));
        for factor in [0.0, -1.0, 101.0, f64::NAN] {
            assert!(!is_speed(factor), "{factor}");
        }
        let is_time = |to| Order::Seek { to }.check().is_ok();
        assert!(is_time(-1e3) && !is_time(f64::NAN) && !is_time(f64::INFINITY));
    }

    #[test]
    fn estimator_that_the_image_does_not_have_is_refused() {
        let set = |value| Order::Set {
            setting: Setting::Estimator.number(),
            value,
        };
        let hello = hello();
        assert_eq!(set(1.0).fits(Some(&hello)), Ok(()));
        let refused = set(77.0).fits(Some(&hello)).unwrap_err();
        assert!(
            refused.starts_with("estimator=77: the image has no estimator 77; there are 0 ("),
            "{refused}"
        );
        assert!(set(1.0).fits(None).unwrap_err().contains("identity"));
        assert_eq!(Order::Estimator { number: 1 }.fits(Some(&hello)), Ok(()));
        assert!(Order::Estimator { number: 2 }.fits(Some(&hello)).is_err());
        assert_eq!(Order::Arm.fits(None), Ok(()));
    }

    #[test]
    fn value_out_of_the_bounds_of_the_firmware_is_refused() {
        let tune = |value| Order::Tune {
            scene: SceneKind::Wall.number(),
            parameter: 1,
            value,
        };
        let checked = |value, hello: &Hello| {
            let order = tune(value);
            order.check().and_then(|()| order.fits(Some(hello)))
        };
        let own = hello();
        let other = Hello {
            device: !own.device,
            ..own
        };
        assert_eq!(checked(BOUNDS.stiffness, &own), Ok(()));
        for value in [BOUNDS.stiffness + 0.01, -0.01] {
            assert!(checked(value, &own).unwrap_err().contains("out of bounds"));
            assert!(tune(value).fits(None).is_err());
            // The bounds of another device are those of its image.
            assert_eq!(checked(value, &other), Ok(()));
        }
        for value in [f32::NAN, f32::INFINITY] {
            for hello in [own, other] {
                let refused = checked(value, &hello).unwrap_err();
                assert!(refused.contains("not finite; give a number"), "{refused}");
            }
        }
        // A part of a detent, on any device.
        let detents = Order::Tune {
            scene: SceneKind::Detents.number(),
            parameter: 1,
            value: 24.5,
        };
        let said = "detents per-turn 24.5: out of bounds; give a whole number from 1 to 1000";
        for hello in [None, Some(&own), Some(&other)] {
            assert_eq!(detents.fits(hello), Err(said.to_owned()));
        }
        let unknown = Order::Tune {
            scene: SceneKind::Wall.number(),
            parameter: 9,
            value: 0.0,
        };
        let said = "scene wall has no parameter 9";
        assert_eq!(unknown.check(), Err(said.to_owned()));
        assert!(Order::Hand { at: Some(f64::NAN) }.check().is_err());
        assert!(Order::Scene { number: 200 }.check().is_err());
        assert!(Order::Estimator { number: 2 }.check().is_err());
        let fault = |name: &str| {
            Order::Fault {
                name: name.to_owned(),
            }
            .check()
        };
        let set = |value| Order::Set {
            setting: Setting::CurrentScale.number(),
            value,
        };
        assert_eq!(set(0.5).check(), Ok(()));
        let refused = set(1.5).check().unwrap_err();
        assert_eq!(refused, "current-scale must be from 0 to 1");
        let unknown = Order::Set {
            setting: 200,
            value: 0.0,
        };
        assert!(unknown.check().is_err());
        let guide = |name: &str| {
            Order::Guide {
                name: name.to_owned(),
            }
            .check()
        };
        assert!(guide("bring-up").is_ok() && guide("fly").is_err());
        assert!(fault("stuck-a").is_ok() && fault("dead-crystal").is_err() && fault("x").is_err());
    }
}
