//! Commands to the firmware, as they are written to RTT down channel 0.

use haptic_control::SceneKind;

/// A command to the firmware.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Command {
    /// Enable the amplifiers.
    Arm,
    /// Disable the amplifiers.
    Disarm,
    /// Change the scene.
    Scene(SceneKind),
    /// A torque set-point, N.m.
    Torque(f32),
    /// Keep-alive: the host is still connected.
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
    /// Select the estimator of the large motor by its number.
    Estimator(u8),
}

impl Command {
    /// The frame with start byte, kind, payload and checksum, as in docs/telemetry.md. It is
    /// implemented independently of the firmware, so that each checks the other.
    #[must_use]
    pub fn encode(self) -> [u8; 11] {
        let mut bytes = [0; 11];
        bytes[0] = 0xA5;
        bytes[1] = match self {
            Self::Arm => 1,
            Self::Disarm => 2,
            Self::Scene(_) => 3,
            Self::Torque(_) => 4,
            Self::KeepAlive => 5,
            Self::Tune { .. } => 6,
            Self::Estimator(_) => 7,
        };
        match self {
            Self::Scene(scene) => bytes[2] = scene.number(),
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
    fn checksum_is_crc_8() {
        assert_eq!(crc8(b"123456789"), 0xF4);
    }

    #[test]
    fn commands_have_the_kinds_of_the_documented_table() {
        for (command, kind) in [
            (Command::Arm, 1),
            (Command::Disarm, 2),
            (Command::KeepAlive, 5),
        ] {
            let expected = [0xA5, kind, 0, 0, 0, 0, 0, 0, 0, 0];
            assert_eq!(command.encode()[..10], expected, "{command:?}");
        }
    }

    #[test]
    fn scenes_have_the_numbers_of_the_documented_table() {
        for (scene, number) in [
            (SceneKind::Off, 0),
            (SceneKind::Wall, 2),
            (SceneKind::Torque, 8),
            (SceneKind::Excite, 10),
        ] {
            let command = Command::Scene(scene).encode();
            assert_eq!(command[..3], [0xA5, 3, number], "{scene}");
        }
    }

    #[test]
    fn numbers_are_little_endian_at_their_offsets() {
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
