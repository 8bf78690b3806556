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
    /// The large motor's amplifier reports a fault. It goes on driving, so that only the firmware
    /// can stop it.
    AmplifierFault,
    /// The core stops: no task runs any more, until the watchdog resets it.
    HungCore,
    /// The control tick stops coming, while everything else runs on.
    HungControl,
    /// The next read of the large motor's counter is answered with a bus error.
    BusError,
    /// Nobody drains the telemetry any more.
    NobodyDrains,
    /// The crystal stops.
    CrystalFails,
}

impl Fault {
    /// All of them.
    pub const ALL: [Self; 10] = [
        Self::StuckA,
        Self::StuckB,
        Self::StuckBoth,
        Self::Swapped,
        Self::AmplifierFault,
        Self::HungCore,
        Self::HungControl,
        Self::BusError,
        Self::NobodyDrains,
        Self::CrystalFails,
    ];

    /// Name on the command line.
    #[must_use]
    pub const fn as_str(self) -> &'static str {
        match self {
            Self::StuckA => "stuck-a",
            Self::StuckB => "stuck-b",
            Self::StuckBoth => "stuck-both",
            Self::Swapped => "swapped",
            Self::AmplifierFault => "amplifier-fault",
            Self::HungCore => "hung-core",
            Self::HungControl => "hung-control",
            Self::BusError => "bus-error",
            Self::NobodyDrains => "nobody-drains",
            Self::CrystalFails => "crystal-fails",
        }
    }
}

impl std::str::FromStr for Fault {
    type Err = String;

    fn from_str(name: &str) -> Result<Self, String> {
        let found = Self::ALL.into_iter().find(|fault| fault.as_str() == name);
        found.ok_or_else(|| {
            let known: Vec<_> = Self::ALL.into_iter().map(Self::as_str).collect();
            format!("no fault '{name}'; there are {}", known.join(", "))
        })
    }
}
