//! Causes of a stop, and their numbers.

use crate::monitor::Cause;

/// Why the device is, or was, stopped. The numbers are those of telemetry.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[repr(u8)]
pub enum Stop {
    /// Nothing.
    #[default]
    None = 0,
    /// The handle moved faster than allowed.
    HandleOverspeed = 1,
    /// The large motor moved faster than allowed.
    LargeOverspeed = 2,
    /// A counter jumped further than any motion could.
    Jump = 3,
    /// The large motor's encoder did not move under current.
    NotMoving = 4,
    /// An amplifier reports a fault.
    AmplifierFault = 5,
    /// Control ticks were missed.
    TickOverrun = 6,
    /// A torque or velocity was not a finite number.
    NonFinite = 7,
    /// The watchdog reset the chip.
    Watchdog = 8,
    /// The supply was too low.
    BrownOut = 9,
    /// The crystal does not run, or stopped.
    ClockFailure = 10,
    /// The program panicked.
    Panic = 11,
    /// The core took a hard fault.
    HardFault = 12,
    /// No command came for too long. The scene went off; this one does not lead to safe.
    CommandTimeout = 13,
    /// The large motor sped up against its current.
    Against = 14,
    /// Debug settings would hold the outputs in a halt: a vector catch is set, or the watchdog is
    /// frozen in a halt. The device cannot be armed; an armed device is not stopped.
    Debugger = 15,
    /// An interrupt or exception that nothing handles, in the session before this reset.
    Exception = 16,
}

impl Stop {
    /// The cause of a number, for whoever kept it over a reset.
    #[must_use]
    pub const fn from_code(code: u8) -> Option<Self> {
        Some(match code {
            0 => Self::None,
            1 => Self::HandleOverspeed,
            2 => Self::LargeOverspeed,
            3 => Self::Jump,
            4 => Self::NotMoving,
            5 => Self::AmplifierFault,
            6 => Self::TickOverrun,
            7 => Self::NonFinite,
            8 => Self::Watchdog,
            9 => Self::BrownOut,
            10 => Self::ClockFailure,
            11 => Self::Panic,
            12 => Self::HardFault,
            13 => Self::CommandTimeout,
            14 => Self::Against,
            15 => Self::Debugger,
            16 => Self::Exception,
            _ => return None,
        })
    }
}

impl From<Cause> for Stop {
    fn from(cause: Cause) -> Self {
        match cause {
            Cause::HandleOverspeed => Self::HandleOverspeed,
            Cause::LargeOverspeed => Self::LargeOverspeed,
            Cause::Jump => Self::Jump,
            Cause::NotMoving => Self::NotMoving,
            Cause::Against => Self::Against,
        }
    }
}
