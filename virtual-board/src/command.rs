//! Commands to the firmware, as they go into RTT down channel 0.

use host_sim::closed_loop::SceneName;

/// Something to tell the firmware.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Command {
    /// Enable the amplifiers.
    Arm,
    /// Disable the amplifiers.
    Disarm,
    /// Change the scene.
    Scene(SceneName),
    /// Somebody is still there.
    KeepAlive,
}

impl Command {
    /// Start byte, kind, payload, checksum.
    #[must_use]
    pub fn encode(self) -> [u8; 11] {
        let mut bytes = [0; 11];
        bytes[0] = 0xA5;
        bytes[1] = match self {
            Self::Arm => 1,
            Self::Disarm => 2,
            Self::Scene(_) => 3,
            Self::KeepAlive => 5,
        };
        if let Self::Scene(scene) = self {
            let index = SceneName::ALL
                .iter()
                .position(|known| known.as_str() == scene.as_str());
            bytes[2] = index.map_or(u8::MAX, |index| index as u8);
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
    fn the_checksum_is_that_of_the_catalogue() {
        assert_eq!(crc8(b"123456789"), 0xF4);
    }

    #[test]
    fn scenes_are_numbered_as_the_firmware_numbers_them() {
        let wall = Command::Scene(SceneName::ALL[2]).encode();
        assert_eq!(wall[..3], [0xA5, 3, 2]);
    }
}
