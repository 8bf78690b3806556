//! What a tick finds.

use estimator_core::Skip;

use crate::stop::Stop;
use crate::supply::SupplyFinding;

/// Findings of one tick. `S` is the finding on the supply; [`Skip`] takes neither state nor code.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Findings<S = Skip> {
    /// Cause that a check has found and latched. A request to arm clears it.
    pub monitor: Option<Stop>,
    /// Cause that is present in this tick, such as a winding that is too hot. It refuses a request to arm.
    pub present: Option<Stop>,
    /// Both amplifiers are ready. Amplifiers may be not ready while they are disabled and for some
    /// time after they are enabled.
    pub amplifiers_ready: bool,
    /// The interlock loop is open, or was open since the amplifiers were last disabled: hardware
    /// has disabled the amplifiers.
    pub interlock: bool,
    /// The clock is not that of the crystal.
    pub clock_failure: bool,
    /// Torque and velocities are finite.
    pub finite: bool,
    /// Control ticks missed since the last one.
    pub missed: u32,
    /// Debug settings are on that would hold the outputs in a halt: a vector catch is set, or the
    /// watchdog is frozen in a halt.
    pub debugger: bool,
    /// The supply of the amplifiers.
    pub supply: S,
}

impl<S> Findings<S> {
    /// Findings of a tick without a fault, with this one on the supply.
    pub const fn well(supply: S) -> Self {
        Self {
            monitor: None,
            present: None,
            amplifiers_ready: true,
            interlock: false,
            clock_failure: false,
            finite: true,
            missed: 0,
            debugger: false,
            supply,
        }
    }
}

impl<S: SupplyFinding> Findings<S> {
    /// Whether nothing stops a device that is on.
    pub(super) fn are_well(&self) -> bool {
        self.missed == 0
            && self.monitor.is_none()
            && self.present.is_none()
            && self.amplifiers_ready
            && !self.interlock
            && !self.clock_failure
            && self.finite
            && !self.supply.is_outside()
    }
}

impl Findings {
    /// Findings of a tick without a fault.
    pub const WELL: Self = Self::well(Skip);
}
