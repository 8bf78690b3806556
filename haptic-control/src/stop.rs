//! Causes of a stop: one table of variants, telemetry numbers and names.

/// The first row is the default.
macro_rules! stops {
    (
        $(#[doc = $first_doc:literal])+ $first:ident = $first_code:literal, $first_name:literal;
        $($(#[doc = $doc:literal])+ $stop:ident = $code:literal, $name:literal;)+
    ) => {
        /// Cause of a stop. The numbers and names are those of telemetry.
        ///
        /// [`Mode::Safe`](crate::Mode::Safe) is the state of a device that has stopped, but for a command timeout.
        /// Overload is judged by [`Windings`](crate::Windings), a current mismatch by
        /// [`Ammeters`](crate::Ammeters), lost counts by [`Index`](crate::Index), the torque balance by
        /// [`Balance`](crate::Balance), and the supply by [`Supply`](crate::Supply).
        #[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
        #[cfg_attr(feature = "defmt", derive(defmt::Format))]
        #[repr(u8)]
        pub enum Stop {
            $(#[doc = $first_doc])+ #[default] $first = $first_code,
            $($(#[doc = $doc])+ $stop = $code,)+
        }

        impl Stop {
            /// All causes, each at its number.
            pub const ALL: [Self; [$first_code, $($code),+].len()] = [Self::$first, $(Self::$stop),+];

            /// The cause with this number.
            #[must_use]
            pub const fn from_code(code: u8) -> Option<Self> {
                match code {
                    $first_code => Some(Self::$first),
                    $($code => Some(Self::$stop),)+
                    _ => None,
                }
            }

            /// Name in tables and recordings.
            #[must_use]
            pub const fn as_str(self) -> &'static str {
                match self {
                    Self::$first => $first_name,
                    $(Self::$stop => $name,)+
                }
            }

            /// What happened, in words without markup, for programs on a host.
            #[must_use]
            pub const fn meaning(self) -> &'static str {
                match self {
                    Self::$first => concat!($($first_doc),+),
                    $(Self::$stop => concat!($($doc),+),)+
                }
            }
        }
    };
}

stops! {
    /// The device has not stopped.
    None = 0, "none";
    /// The handle moved faster than allowed.
    HandleOverspeed = 1, "handle-overspeed";
    /// The large motor moved faster than allowed.
    LargeOverspeed = 2, "large-overspeed";
    /// A counter changed by more than any motion can cause in a tick.
    Jump = 3, "jump";
    /// The large motor's current was high for some time, and its encoder did not move.
    Stall = 4, "not-moving";
    /// An amplifier is not ready, or was not ready in time after it was enabled.
    AmplifierFault = 5, "amplifier-fault";
    /// Control ticks were missed.
    TickOverrun = 6, "tick-overrun";
    /// A torque or velocity was not a finite number.
    NonFinite = 7, "non-finite";
    /// The watchdog reset the chip.
    Watchdog = 8, "watchdog";
    /// The supply voltage was too low.
    BrownOut = 9, "brown-out";
    /// The crystal does not run, or stopped.
    ClockFailure = 10, "clock-failure";
    /// The program panicked.
    Panic = 11, "panic";
    /// The core took a hard fault.
    HardFault = 12, "hard-fault";
    /// No command came for too long. The scene is off; the device is not in the state safe.
    CommandTimeout = 13, "command-timeout";
    /// The large motor accelerated against its current: the phases of an encoder or of a motor are
    /// exchanged.
    RunawayDirection = 14, "against";
    /// Debug settings would hold the outputs in a halt: a vector catch is set, or the watchdog is
    /// frozen in a halt. The device cannot be armed; an armed device is not stopped.
    Debugger = 15, "debugger";
    /// An interrupt or exception that nothing handles, in the session before this reset.
    Exception = 16, "exception";
    /// The interlock loop opened, and hardware disabled the amplifiers: the emergency stop is
    /// pressed, or an amplifier reports a fault in the loop.
    Interlock = 17, "interlock";
    /// A winding carried more than its continuous current for too long.
    Overload = 18, "overload";
    /// A measured current was not the commanded one for too long.
    CurrentMismatch = 19, "current-mismatch";
    /// Counts of an encoder were lost or gained: an index pulse was not whole turns after the first one.
    /// The device file may also have a wrong number of counts per turn.
    LostCounts = 20, "lost-counts";
    /// The large motor's current does not agree with the motion of both shafts: the handle's encoder counts
    /// backwards or not at all, or the large motor or its encoder fails.
    TorqueBalance = 21, "torque-balance";
    /// The voltage of the amplifiers' supply is outside of its range. The device cannot be armed.
    Supply = 22, "supply";
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn meanings_are_sentences_without_markup() {
        for stop in Stop::ALL {
            let meaning = stop.meaning().trim();
            assert!(!meaning.contains(['[', ']', '`']), "{meaning}");
            assert!(meaning.ends_with('.'), "{meaning}");
        }
    }
}
