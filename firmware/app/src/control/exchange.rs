//! What the control task takes and gives in a tick.

use drivers::Settings;
use haptic_control::{Action, Currents, Request};

use crate::large::Choice;
use crate::scene::Tuned;

/// Inputs of a tick besides its sample.
#[derive(Clone, Copy)]
pub struct Inputs {
    /// Faults of the hardware.
    pub faults: Faults,
    /// Control ticks missed since the last one.
    pub missed: u32,
    /// Whether debug settings are on that would hold the outputs in a halt; asked when the device is armed.
    pub debugger: fn() -> bool,
    /// A request to the safety machine.
    pub request: Option<Request>,
}

/// Faults of the hardware, of which one comparison tells that there are none.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Faults(u32);

impl Faults {
    /// None.
    pub const NONE: Self = Self(0);
    /// An amplifier is not ready.
    pub const NOT_READY: Self = Self(1);
    /// The interlock loop is open, or was open since the amplifiers were last disabled.
    pub const INTERLOCK: Self = Self(2);
    /// The core does not run on its crystal.
    pub const CLOCK: Self = Self(4);

    /// These faults, and `fault` if it is `present`.
    #[must_use]
    #[inline]
    pub const fn with(self, fault: Self, present: bool) -> Self {
        Self(self.0 | (fault.0 * present as u32))
    }

    pub(super) const fn contain(self, fault: Self) -> bool {
        self.0 & fault.0 != 0
    }
}

/// Outputs of a tick.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Outputs {
    /// The currents to apply; `None` disables the amplifiers.
    pub currents: Option<Currents>,
    /// The action, for a [`Record`](crate::telemetry::Record). Its currents are those that are applied, zero without.
    pub action: Action,
}

/// A command on its way to the control task.
#[derive(Clone, Copy)]
pub enum Message {
    /// A request to the safety state machine.
    Request(Request),
    /// A change of a scene's parameters.
    Tuned(Tuned),
    /// Selection of the large motor's estimator. An image of one estimator has no such message.
    Estimator(Choice),
    /// Changed settings, and the request that comes with them.
    Settings(Settings, Request),
}
