//! What can go wrong.

/// A fault, from its instant on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Fault {
    /// Line A of the large motor's encoder stays where it is.
    StuckA,
    /// Line B of the large motor's encoder stays where it is.
    StuckB,
    /// Both lines of the large motor's encoder stay where they are.
    StuckBoth,
    /// Lines A and B of the large motor's encoder change places: it counts backwards.
    Swapped,
    /// Of 64 edges of the large motor's encoder the last four do not arrive.
    LostCounts,
    /// The large motor's amplifier reports a fault. It goes on driving, so that only the firmware
    /// can stop it.
    AmplifierFault,
    /// The small motor's amplifier reports a fault, and goes on driving.
    SmallAmplifierFault,
    /// The core stops: no task runs any more, until the watchdog resets it.
    HungCore,
    /// A debugger halts the core for so many ms, or until a reset: timers and watchdog run on, the
    /// outputs stay as they are, and the cycle counter stands.
    Halt(u16),
    /// For 10 ms every control task takes 1.2 periods: the core stands in the middle of it.
    LongTasks,
    /// The control tick stops coming, while everything else runs on.
    HungControl,
    /// The task of lowest priority loops for ever, while the control task runs on.
    HungIdle,
    /// The task of lowest priority loops for 40 ms.
    StarvedIdle,
    /// The oscillator behind the watchdog is as slow as it may be, whatever the instant.
    SlowWatchdog,
    /// The oscillator behind the watchdog is as fast as it may be, whatever the instant.
    FastWatchdog,
    /// The next read of the large motor's counter is answered with a bus error.
    BusError,
    /// An assertion fails in the task of lowest priority.
    Panic,
    /// The crystal never runs, from power-up on whatever the instant.
    DeadCrystal,
    /// The crystal stops.
    CrystalFails,
    /// Nobody drains the telemetry any more.
    NobodyDrains,
    /// Nobody drains the telemetry for 300 ms.
    DrainPause,
    /// The command channel is kept full: garbage, and a keep-alive now and then.
    CommandFlood,
    /// The supply sags for a moment: a reset by the brown-out detector.
    BrownOut,
}

/// Each fault with its name on the command line and what it is.
const NAMES: [(Fault, &str, &str); 27] = [
    (Fault::StuckA, "stuck-a", "large encoder's line A stuck"),
    (Fault::StuckB, "stuck-b", "large encoder's line B stuck"),
    (
        Fault::StuckBoth,
        "stuck-both",
        "both lines of the large encoder stuck",
    ),
    (
        Fault::Swapped,
        "swapped",
        "large encoder's phases change places",
    ),
    (
        Fault::LostCounts,
        "lost-counts",
        "4 of 64 edges of the large encoder lost",
    ),
    (
        Fault::AmplifierFault,
        "amplifier-fault",
        "large amplifier reports a fault and drives on",
    ),
    (
        Fault::SmallAmplifierFault,
        "small-amplifier-fault",
        "small amplifier reports a fault and drives on",
    ),
    (Fault::HungCore, "hung-core", "the core stops"),
    (
        Fault::Halt(1),
        "halt-1ms",
        "a debugger halts the core for 1 ms",
    ),
    (
        Fault::Halt(5),
        "halt-5ms",
        "a debugger halts the core for 5 ms",
    ),
    (
        Fault::Halt(20),
        "halt-20ms",
        "a debugger halts the core for 20 ms",
    ),
    (
        Fault::Halt(100),
        "halt-100ms",
        "a debugger halts the core for 100 ms",
    ),
    (
        Fault::Halt(500),
        "halt-500ms",
        "a debugger halts the core for 500 ms",
    ),
    (
        Fault::LongTasks,
        "long-tasks",
        "the control task takes 1.2 periods, for 10 ms",
    ),
    (
        Fault::HungControl,
        "hung-control",
        "the control task runs no more",
    ),
    (
        Fault::HungIdle,
        "hung-low-priority",
        "the task of lowest priority loops for ever",
    ),
    (
        Fault::StarvedIdle,
        "starved-low-priority",
        "the task of lowest priority loops for 40 ms",
    ),
    (
        Fault::SlowWatchdog,
        "slow-watchdog",
        "watchdog's oscillator at 17 kHz from power-up on, whatever S",
    ),
    (
        Fault::FastWatchdog,
        "fast-watchdog",
        "watchdog's oscillator at 47 kHz from power-up on, whatever S",
    ),
    (
        Fault::BusError,
        "bus-error",
        "a read of the large counter fails",
    ),
    (
        Fault::Panic,
        "panic",
        "an assertion fails in the task of lowest priority",
    ),
    (
        Fault::DeadCrystal,
        "dead-crystal",
        "no crystal from power-up on, whatever S",
    ),
    (
        Fault::CrystalFails,
        "crystal-fails",
        "the crystal stops while the device runs",
    ),
    (
        Fault::NobodyDrains,
        "nobody-drains",
        "nobody drains the telemetry",
    ),
    (
        Fault::DrainPause,
        "drain-pause",
        "nobody drains the telemetry for 300 ms",
    ),
    (
        Fault::CommandFlood,
        "command-flood",
        "garbage fills the command channel",
    ),
    (
        Fault::BrownOut,
        "brown-out",
        "the brown-out detector resets the chip",
    ),
];

impl Fault {
    /// All of them.
    pub fn all() -> impl Iterator<Item = Self> {
        NAMES.iter().map(|(fault, ..)| *fault)
    }

    /// Its name on the command line, and what it is in a few words.
    fn words(self) -> (&'static str, &'static str) {
        let found = NAMES.iter().find(|(fault, ..)| *fault == self);
        found.map_or(("", ""), |(_, name, what)| (name, what))
    }

    /// Name on the command line.
    #[must_use]
    pub fn as_str(self) -> &'static str {
        self.words().0
    }

    /// What it is, in a few words.
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
            .ok_or_else(|| {
                let known: Vec<_> = Self::all().map(Self::as_str).collect();
                format!("no fault '{name}'; there are {}", known.join(", "))
            })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_fault_is_found_by_its_name() {
        for fault in Fault::all() {
            assert!(!fault.description().is_empty(), "{fault:?}");
            assert_eq!(fault.as_str().parse(), Ok(fault));
        }
        let error = "stuck-c".parse::<Fault>().unwrap_err();
        assert!(error.starts_with("no fault 'stuck-c'; there are stuck-a, "));
    }
}
