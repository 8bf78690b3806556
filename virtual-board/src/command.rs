//! Commands to the firmware, as they go into RTT down channel 0.

use experiments::closed_loop::SceneName;

/// Number of the scene of the torque set-point, which the host simulation does not have.
pub const TORQUE_SCENE: u8 = 8;

/// Something to tell the firmware.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Command {
    /// Enable the amplifiers.
    Arm,
    /// Disable the amplifiers.
    Disarm,
    /// Change the scene.
    Scene(SceneName),
    /// Change to the scene of the torque set-point.
    TorqueScene,
    /// A torque set-point, N.m.
    Torque(f32),
    /// Somebody is still there.
    KeepAlive,
    /// Set a parameter of a scene, both by their numbers.
    Tune {
        /// Scene.
        scene: u8,
        /// Parameter.
        parameter: u8,
        /// Value.
        value: f32,
    },
    /// Put an estimator in charge of the large motor, by its number.
    Estimator(u8),
}

impl Command {
    /// Start byte, kind, payload, checksum: written from docs/telemetry.md, not shared with the
    /// firmware, so that each checks the other.
    #[must_use]
    pub fn encode(self) -> [u8; 11] {
        let mut bytes = [0; 11];
        bytes[0] = 0xA5;
        bytes[1] = match self {
            Self::Arm => 1,
            Self::Disarm => 2,
            Self::Scene(_) | Self::TorqueScene => 3,
            Self::Torque(_) => 4,
            Self::KeepAlive => 5,
            Self::Tune { .. } => 6,
            Self::Estimator(_) => 7,
        };
        match self {
            Self::Scene(scene) => bytes[2] = number(scene),
            Self::TorqueScene => bytes[2] = TORQUE_SCENE,
            Self::Torque(torque) => bytes[2..6].copy_from_slice(&torque.to_le_bytes()),
            Self::Tune {
                scene,
                parameter,
                value,
            } => {
                bytes[2..4].copy_from_slice(&[scene, parameter]);
                bytes[4..8].copy_from_slice(&value.to_le_bytes());
            }
            Self::Estimator(number) => bytes[2] = number,
            Self::Arm | Self::Disarm | Self::KeepAlive => {}
        }
        bytes[10] = crc8(&bytes[1..10]);
        bytes
    }
}

/// Number of a scene; parameters do not matter.
#[must_use]
pub const fn number(scene: SceneName) -> u8 {
    match scene {
        SceneName::Off => 0,
        SceneName::FreeAir => 1,
        SceneName::Wall(..) => 2,
        SceneName::SpringDamper(..) => 3,
        SceneName::Viscous(..) => 4,
        SceneName::Detents(..) => 5,
        SceneName::Texture(..) => 6,
        SceneName::Hold(..) => 7,
        SceneName::Inertia(..) => 9,
        SceneName::Excite => 10,
    }
}

/// CRC-8, polynomial 0x07, start 0.
fn crc8(bytes: &[u8]) -> u8 {
    bytes.iter().fold(0, |crc, &byte| {
        (0..8).fold(crc ^ byte, |crc, _| {
            if crc & 0x80 == 0 {
                crc << 1
            } else {
                (crc << 1) ^ 0x07
            }
        })
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_checksum_is_that_of_the_catalogue() {
        assert_eq!(crc8(b"123456789"), 0xF4);
    }

    #[test]
    fn scenes_are_numbered_as_the_firmware_numbers_them() {
        let wall = Command::Scene(SceneName::ALL[2]).encode();
        assert_eq!(wall[..3], [0xA5, 3, 2]);
        assert_eq!(Command::TorqueScene.encode()[..3], [0xA5, 3, 8]);
    }

    #[test]
    fn numbers_are_little_endian_where_the_table_says() {
        let torque = Command::Torque(0.5).encode();
        assert_eq!(torque[..10], [0xA5, 4, 0, 0, 0, 0x3F, 0, 0, 0, 0]);
        let tune = Command::Tune {
            scene: 2,
            parameter: 1,
            value: -2.0,
        };
        assert_eq!(tune.encode()[..10], [0xA5, 6, 2, 1, 0, 0, 0, 0xC0, 0, 0]);
        assert_eq!(Command::Estimator(1).encode()[..4], [0xA5, 7, 1, 0]);
    }
}
