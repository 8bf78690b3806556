//! Faults that a run can inject.

use terminal::wording::unknown;

macro_rules! faults {
    ($($(#[doc = $meaning:literal])+ $fault:ident $(($parameter:ty))?: $($(($value:literal))? $name:literal, $what:literal);+;)+) => {
        /// A fault that begins at a given time.
        #[derive(Clone, Copy, Debug, PartialEq, Eq)]
        pub enum Fault {
            $($(#[doc = $meaning])+ $fault $(($parameter))?,)+
        }

        /// Each fault with its name on the command line and its description.
        const NAMES: &[(Fault, &str, &str)] = &[
            $($((Fault::$fault $(($value))?, $name, $what),)+)+
        ];
    };
}

// Each fault with its name and its description; one with a parameter has a name for each value that can be
// asked for.
faults! {
    /// Line A of the large motor's encoder is stuck.
    StuckA: "stuck-a", "large encoder's line A stuck";
    /// Line B of the large motor's encoder is stuck.
    StuckB: "stuck-b", "large encoder's line B stuck";
    /// Both lines of the large motor's encoder are stuck.
    StuckBoth: "stuck-both", "both lines of the large encoder stuck";
    /// Lines A and B of the large motor's encoder are exchanged: it counts backwards.
    Swapped: "swapped", "large encoder's lines A and B exchanged";
    /// Both lines of the small motor's encoder are stuck.
    SmallStuck: "small-stuck", "both lines of the small encoder stuck";
    /// Lines A and B of the small motor's encoder are exchanged: it counts backwards.
    SmallSwapped: "small-swapped", "small encoder's lines A and B exchanged";
    /// The last four of every 64 edges of the large motor's encoder are lost.
    LostCounts: "lost-counts", "4 of 64 edges of the large encoder lost";
    /// The large motor's amplifier is no longer ready. It continues to drive, so that only the
    /// firmware can stop it.
    AmplifierFault: "amplifier-fault", "large amplifier is no longer ready and continues to drive";
    /// The small motor's amplifier is no longer ready and continues to drive.
    SmallAmplifierFault: "small-amplifier-fault", "small amplifier is no longer ready and continues to drive";
    /// The wire of the large amplifier's ready line breaks.
    BrokenReadyWire: "broken-ready-wire", "wire of the large amplifier's ready line breaks";
    /// The large amplifier loses its supply. Its fault contact opens the interlock loop.
    Unpowered: "unpowered-amplifier", "large amplifier loses its supply";
    /// A lead of the large motor is open: no current flows.
    OpenLead: "open-lead", "a lead of the large motor is open";
    /// A lead of the small motor is open.
    SmallOpenLead: "small-open-lead", "a lead of the small motor is open";
    /// The leads of the small motor are exchanged: its torque has the other sign.
    SmallReversed: "small-reversed", "leads of the small motor exchanged";
    /// The wire of the large amplifier's current monitor breaks.
    BrokenMonitorWire: "broken-monitor-wire", "wire of the large amplifier's current monitor breaks";
    /// The voltage of the amplifiers' supply drops to 18 V. The amplifiers continue to drive.
    SupplyDrop: "supply-drop", "supply of the amplifiers drops from 24 V to 18 V";
    /// The voltage of the amplifiers' supply rises to 31 V, as if motors that brake had charged it. The
    /// amplifiers continue to drive.
    SupplyRise: "supply-rise", "supply of the amplifiers rises from 24 V to 31 V";
    /// The large amplifier takes this number of ms from its enable until it is ready, from power-up
    /// on.
    ReadyAfter(u16):
        (15) "ready-after-15ms", "large amplifier is ready 15 ms after its enable, for any S";
        (30) "ready-after-30ms", "large amplifier is ready 30 ms after its enable, for any S";
    /// The emergency stop is pressed: the interlock loop is open from then on.
    EmergencyStop: "emergency-stop", "the emergency stop opens the interlock loop";
    /// The interlock loop opens for 20 us.
    InterlockGlitch: "interlock-glitch", "the interlock loop opens for 20 us";
    /// The core stops until the watchdog resets it.
    HungCore: "hung-core", "the core stops until the watchdog resets it";
    /// A debugger halts the core for this number of ms, or until a reset. Watchdog and tick timer
    /// continue, the cycle counter stops, and the timer of the enables does as `DBG_TIM8_STOP` says.
    Halt(u16):
        (1) "halt-1ms", "a debugger halts the core for 1 ms";
        (5) "halt-5ms", "a debugger halts the core for 5 ms";
        (20) "halt-20ms", "a debugger halts the core for 20 ms";
        (100) "halt-100ms", "a debugger halts the core for 100 ms";
        (500) "halt-500ms", "a debugger halts the core for 500 ms";
    /// A debugger freezes the watchdog and halts the core for ever.
    FrozenHalt: "frozen-halt", "a debugger freezes the watchdog and halts the core";
    /// A debugger freezes the watchdog, lets the timer of the enables continue in a halt, and halts
    /// the core for ever.
    FrozenHaltTimerOn: "frozen-halt-timer-on", "a debugger freezes the watchdog, clears DBG_TIM8_STOP and halts the core";
    /// For 10 ms every control task takes 1.2 periods, because the core stops in the middle of it.
    LongTasks: "long-tasks", "the control task takes 1.2 periods, for 10 ms";
    /// The timer of the control tick stops; all other parts continue.
    HungControl: "hung-control", "the timer of the control tick stops";
    /// The task of lowest priority loops forever; the control task continues.
    HungIdle: "hung-low-priority", "the task of lowest priority loops forever";
    /// The task of lowest priority loops for 40 ms.
    StarvedIdle: "starved-low-priority", "the task of lowest priority loops for 40 ms";
    /// The watchdog's oscillator has its lowest frequency, from the start on.
    SlowWatchdog: "slow-watchdog", "watchdog's oscillator at 17 kHz from power-up, for any S";
    /// The watchdog's oscillator has its highest frequency, from the start on.
    FastWatchdog: "fast-watchdog", "watchdog's oscillator at 47 kHz from power-up, for any S";
    /// The next read of the large motor's counter causes a bus error.
    BusError: "bus-error", "a read of the large counter causes a bus error";
    /// An assertion fails in the task of lowest priority.
    Panic: "panic", "an assertion fails in the task of lowest priority";
    /// The crystal does not run, from power-up on.
    DeadCrystal: "dead-crystal", "no crystal from power-up, for any S";
    /// The crystal stops.
    CrystalFails: "crystal-fails", "the crystal stops while the device runs";
    /// The host stops reading telemetry.
    NobodyDrains: "nobody-drains", "the host stops reading telemetry";
    /// The host does not read telemetry for 300 ms.
    DrainPause: "drain-pause", "the host does not read telemetry for 300 ms";
    /// The command channel is kept full of random bytes with occasional keep-alives.
    CommandFlood: "command-flood", "random bytes fill the command channel";
    /// The supply voltage drops for a short time, and the brown-out detector resets the processor.
    BrownOut: "brown-out", "the brown-out detector resets the chip";
}

impl Fault {
    /// All faults.
    pub fn all() -> impl Iterator<Item = Self> {
        NAMES.iter().map(|(fault, ..)| *fault)
    }

    /// Whether the board is built with the fault, so that it has no effect on a running one.
    #[must_use]
    pub fn acts_from_power_up(self) -> bool {
        matches!(
            self,
            Self::DeadCrystal | Self::SlowWatchdog | Self::FastWatchdog | Self::ReadyAfter(_)
        )
    }

    /// Name on the command line, and description.
    fn words(self) -> (&'static str, &'static str) {
        let found = NAMES.iter().find(|(fault, ..)| *fault == self);
        found.map_or(("", ""), |(_, name, what)| (name, what))
    }

    /// Name on the command line.
    #[must_use]
    pub fn as_str(self) -> &'static str {
        self.words().0
    }

    /// Description in a few words.
    #[must_use]
    pub fn description(self) -> &'static str {
        self.words().1
    }
}

impl std::str::FromStr for Fault {
    type Err = String;

    fn from_str(name: &str) -> Result<Self, String> {
        Self::all()
            .find(|fault| fault.as_str() == name)
            .ok_or_else(|| unknown("fault", name, Self::all().map(Self::as_str)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The time of such a fault has no meaning, which the help tells.
    #[test]
    fn faults_from_power_up_have_no_time() {
        for fault in Fault::all() {
            let told = fault.description().ends_with("for any S");
            assert_eq!(fault.acts_from_power_up(), told, "{fault:?}");
        }
    }

    #[test]
    fn every_fault_is_found_by_its_name() {
        let mut names = std::collections::BTreeSet::new();
        for fault in Fault::all() {
            assert!(names.insert(fault.as_str()), "{fault:?}");
            assert!(!fault.description().is_empty(), "{fault:?}");
            assert_eq!(fault.as_str().parse(), Ok(fault));
        }
        let error = "stuck-c".parse::<Fault>().unwrap_err();
        assert!(error.starts_with("no fault 'stuck-c'; did you mean stuck-"));
        assert!(error.contains("? there are stuck-a, stuck-b, "), "{error}");
    }
}
