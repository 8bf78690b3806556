//! What the image can be told to render, by name.

use std::fmt;
use std::str::FromStr;

use experiments::closed_loop::{Hand, Press, SceneName};
use haptic_control::{
    Detents, Hold, Inertia, SpringDamper, Texture, Torque, Tunable, Viscous, Wall,
};
use simulation::device::Device;

use crate::command::{Command, number};

/// A scene of the image.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ImageScene {
    /// One that the host simulation has too.
    Host(SceneName),
    /// The torque set-point.
    Torque,
}

impl FromStr for ImageScene {
    type Err = String;

    fn from_str(name: &str) -> Result<Self, String> {
        match name {
            "torque" => Ok(Self::Torque),
            _ => name
                .parse()
                .map(Self::Host)
                .map_err(|error| format!("{error}, torque")),
        }
    }
}

impl fmt::Display for ImageScene {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Host(scene) => f.write_str(scene.as_str()),
            Self::Torque => f.write_str("torque"),
        }
    }
}

impl ImageScene {
    /// All of them.
    pub fn all() -> impl Iterator<Item = Self> {
        let hosts = SceneName::ALL.into_iter().chain([SceneName::Excite]);
        hosts.map(Self::Host).chain([Self::Torque])
    }

    /// The command that puts it on.
    #[must_use]
    pub fn select(self) -> Command {
        match self {
            Self::Host(scene) => Command::Scene(scene),
            Self::Torque => Command::TorqueScene,
        }
    }

    /// Who plays with it.
    #[must_use]
    pub const fn hand(self) -> Hand {
        match self {
            Self::Host(SceneName::Wall(..)) => Hand::Pushing,
            Self::Host(SceneName::Hold(..)) => Hand::Still,
            _ => Hand::Moving,
        }
    }

    /// A finger that would press with 10 N, had the scene as much to set against it: it goes as far
    /// into the scene as its stiffness asks for, and further by what the hand itself gives way.
    #[must_use]
    pub fn press(self) -> Hand {
        let device = Device::default();
        let torque = 10.0 * 0.5 * device.handle.diameter_m;
        let stiffness = match self {
            Self::Host(
                SceneName::Wall(stiffness, _)
                | SceneName::SpringDamper(stiffness, _)
                | SceneName::Hold(stiffness, _),
            ) => f64::from(stiffness),
            // As far as into a wall, whatever is there.
            _ => 0.30,
        };
        let given_way = torque / stiffness + torque / device.hand.stiffness_nm_per_rad;
        Hand::Pressing(Press {
            // The wall begins there.
            angle: 0.1 + given_way,
            moving_s: 0.8,
            rest_s: 0.6,
        })
    }

    /// Names of its parameters, in the order of their numbers.
    #[must_use]
    pub fn parameters(self) -> &'static [&'static str] {
        match self {
            Self::Host(SceneName::Off | SceneName::FreeAir | SceneName::Excite) => &[],
            Self::Host(SceneName::Wall(..)) => Wall::PARAMETERS,
            Self::Host(SceneName::SpringDamper(..)) => SpringDamper::PARAMETERS,
            Self::Host(SceneName::Viscous(..)) => Viscous::PARAMETERS,
            Self::Host(SceneName::Detents(..)) => Detents::PARAMETERS,
            Self::Host(SceneName::Texture(..)) => Texture::PARAMETERS,
            Self::Host(SceneName::Hold(..)) => Hold::PARAMETERS,
            Self::Host(SceneName::Inertia(..)) => Inertia::PARAMETERS,
            Self::Torque => Torque::PARAMETERS,
        }
    }

    /// The command that sets a parameter, from text as `stiffness=0.2`. Whether the value is in
    /// bounds is for the image to say.
    ///
    /// # Errors
    /// One line on another text, or a name that is none of its parameters.
    pub fn tune(self, text: &str) -> Result<Command, String> {
        let (name, value) = text
            .split_once('=')
            .ok_or_else(|| format!("--tune {text}: give it as stiffness=0.2@1.5"))?;
        let parameters = self.parameters();
        let parameter = parameters.iter().position(|known| *known == name);
        let parameter = parameter.ok_or_else(|| match parameters {
            [] => format!("--tune {text}: {self} has no parameters"),
            _ => format!("--tune {text}: {self} has {}", parameters.join(", ")),
        })? as u8;
        let value = value
            .parse()
            .map_err(|_| format!("--tune {text}: '{value}' is no number"))?;
        Ok(match self {
            Self::Torque => Command::Torque(value),
            Self::Host(scene) => Command::Tune {
                scene: number(scene),
                parameter,
                value,
            },
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::command::TORQUE_SCENE;

    #[test]
    fn what_is_typed_becomes_a_command_or_a_reason() {
        let wall: ImageScene = "wall".parse().unwrap();
        let tune = Command::Tune {
            scene: 2,
            parameter: 1,
            value: 0.2,
        };
        assert_eq!(wall.tune("stiffness=0.2"), Ok(tune));
        assert_eq!(
            ImageScene::Torque.tune("torque=-0.01"),
            Ok(Command::Torque(-0.01))
        );
        assert_eq!(TORQUE_SCENE, 8);
        for (text, said) in [
            ("stiffness", "give it as"),
            ("softness=1", "wall has position, stiffness, damping"),
            ("stiffness=soft", "'soft' is no number"),
        ] {
            assert!(wall.tune(text).unwrap_err().contains(said), "{text}");
        }
        assert!(
            "tarpit"
                .parse::<ImageScene>()
                .unwrap_err()
                .ends_with(", torque")
        );
        for scene in SceneName::ALL {
            assert_eq!(
                ImageScene::Host(scene).to_string().parse(),
                Ok(ImageScene::Host(scene))
            );
        }
    }
}
