//! The modes of the device.

/// State of the device.
///
/// ```text
/// boot -> settling -> armed <-> running     arm; select a scene (before or after), or off again
///  ^         |          |          |
///  |         +----------+----------+-> safe  any stop cause; latched until arm or disarm
///  +---------+----------+----------+         disarm; armed and a long silence
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[repr(u8)]
pub enum Mode {
    /// Amplifiers disabled, no fault. The cause is [`Stop::CommandTimeout`](crate::Stop::CommandTimeout) if a silence disarmed
    /// the device, otherwise [`Stop::None`](crate::Stop::None).
    #[default]
    Boot = 0,
    /// Amplifiers enabled, no scene.
    Armed = 1,
    /// Amplifiers enabled, a scene is on.
    Running = 2,
    /// Amplifiers disabled because of a fault, which is the cause.
    Safe = 3,
    /// Amplifiers enabled, no current commanded until they are ready.
    Settling = 4,
}

impl Mode {
    /// The mode with this number in telemetry.
    #[must_use]
    pub const fn from_code(code: u8) -> Option<Self> {
        Some(match code {
            0 => Self::Boot,
            1 => Self::Armed,
            2 => Self::Running,
            3 => Self::Safe,
            4 => Self::Settling,
            _ => return None,
        })
    }

    /// Name in plots and tables.
    #[must_use]
    pub const fn as_str(self) -> &'static str {
        match self {
            Self::Boot => "boot",
            Self::Armed => "armed",
            Self::Running => "running",
            Self::Safe => "safe",
            Self::Settling => "settling",
        }
    }

    /// Whether the amplifiers are enabled.
    #[must_use]
    pub const fn is_enabled(self) -> bool {
        matches!(self, Self::Settling | Self::Armed | Self::Running)
    }
}
