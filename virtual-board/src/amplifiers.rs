//! The amplifiers behind the board's connectors: their enables, ready lines, and the interlock
//! loop with the emergency stop.

use rigless::time::VirtualNanos;

use crate::board::Part;
use crate::fault::Fault;
use crate::pins::{self, INTERLOCK, READY};
use crate::quadrature::LARGE;

/// Time from the enable of an amplifier until it is ready and follows its command, ns.
const READY_AFTER_NS: u64 = 5_000_000;

/// Middle of the range of an analogue input, codes.
const MIDDLE: f64 = 2048.0;

/// An analogue input for a current monitor.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Monitor {
    /// Error of the zero, codes.
    pub(crate) offset: f64,
    /// Current from the middle of the range to its ends, A.
    pub(crate) amps: f64,
}

/// An amplifier and the wires to it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Amplifier {
    /// Whether it has supply. Without supply it does not drive, is not ready, and opens the
    /// interlock loop.
    pub(crate) powered: bool,
    /// Whether it reports that it is not ready. It continues to drive.
    pub(crate) unready: bool,
    /// Whether the wire of its ready line is broken.
    pub(crate) cut: bool,
    /// Whether a lead of its motor is open: no current flows.
    pub(crate) open: bool,
    /// Whether the leads of its motor are exchanged: the torque has the other sign.
    pub(crate) reversed: bool,
    /// Whether the wire of its current monitor is broken. A pull-down at the board holds the input low.
    pub(crate) monitor_cut: bool,
    /// Time from its enable until it is ready, ns.
    pub(crate) ready_after_ns: u64,
    /// Time since which it is enabled, ns.
    enabled_ns: Option<u64>,
}

impl Amplifier {
    const WELL: Self = Self {
        powered: true,
        unready: false,
        cut: false,
        open: false,
        reversed: false,
        monitor_cut: false,
        ready_after_ns: READY_AFTER_NS,
        enabled_ns: None,
    };

    /// Whether it follows its command.
    fn drives(&self, now_ns: u64) -> bool {
        let ready = |since| now_ns >= since + self.ready_after_ns;
        self.powered && self.enabled_ns.is_some_and(ready)
    }

    /// Level of its current monitor at this current, codes.
    fn monitor(&self, current: f64, Monitor { offset, amps }: Monitor) -> f64 {
        if self.monitor_cut || !self.powered {
            return 0.0;
        }
        MIDDLE + offset + current / amps * MIDDLE
    }

    /// Level on the wire of its ready line: high, or nothing drives the wire.
    fn ready(&self, now_ns: u64) -> Option<bool> {
        (self.drives(now_ns) && !self.unready && !self.cut).then_some(true)
    }
}

/// Both amplifiers, large motor first, and the emergency stop.
#[derive(Debug)]
pub(crate) struct Amplifiers {
    pub(crate) each: [Amplifier; 2],
    /// Time until which the emergency stop opens the interlock loop, ns.
    stop_until_ns: u64,
    /// Levels on the wires; `None` until they are set after a restart.
    driven: Option<Wires>,
}

/// Levels on the wires to the board; `None` for a wire that nothing drives.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Wires {
    ready: [Option<bool>; 2],
    interlock: Option<bool>,
    /// Level at the break input of the timer, behind the pin.
    broken: bool,
}

/// Outputs of the board and of the amplifiers at an instant.
pub(crate) struct Enabled {
    /// Whether the enable of each amplifier is active.
    pub(crate) enables: [bool; 2],
    /// Whether each amplifier follows its command and a current can flow.
    pub(crate) drives: [bool; 2],
}

impl Amplifiers {
    /// Both amplifiers with supply and closed loop, and with those faults that exist from power-up
    /// on.
    pub(crate) fn new(faults: &[(f64, Fault)]) -> Self {
        let mut each = [Amplifier::WELL; 2];
        for (_, fault) in faults {
            if let Fault::ReadyAfter(ms) = fault {
                each[LARGE].ready_after_ns = 1_000_000 * u64::from(*ms);
            }
        }
        Self {
            each,
            stop_until_ns: 0,
            driven: None,
        }
    }

    /// Restores the levels of the wires after a restart of the processor.
    pub(crate) fn restart(&mut self, part: &mut Part, at: VirtualNanos) {
        pins::pull_enables_down(part, at);
        self.driven = None;
        self.follow(part, at);
    }

    /// Opens the interlock loop until this time at least, ns.
    pub(crate) fn stop_until(&mut self, ns: u64) {
        self.stop_until_ns = self.stop_until_ns.max(ns);
    }

    /// Levels of the current monitors, codes.
    pub(crate) fn monitors(&self, currents: [f64; 2], inputs: [Monitor; 2]) -> [f64; 2] {
        [0, 1].map(|n| self.each[n].monitor(currents[n], inputs[n]))
    }

    /// Sets the wires to the board for its present enables.
    pub(crate) fn follow(&mut self, part: &mut Part, at: VirtualNanos) -> Enabled {
        let closed = at.0 >= self.stop_until_ns && self.each.iter().all(|one| one.powered);
        let interlock = closed.then_some(true);
        if self.driven.is_none_or(|wires| wires.interlock != interlock) {
            pins::drive(part, at, INTERLOCK, interlock);
        }
        // The level at the timer follows the wire, and the configuration of the pin.
        let broken = !pins::interlock_level(part);
        if self.driven.is_none_or(|wires| wires.broken != broken) {
            pins::drive_break(part, at, !broken);
        }
        let enables = pins::enabled(part);
        for (amplifier, on) in self.each.iter_mut().zip(enables) {
            amplifier.enabled_ns = on.then(|| amplifier.enabled_ns.unwrap_or(at.0));
        }
        let ready = self.each.map(|amplifier| amplifier.ready(at.0));
        for n in 0..2 {
            if self.driven.is_none_or(|wires| wires.ready[n] != ready[n]) {
                pins::drive(part, at, READY[n], ready[n]);
            }
        }
        self.driven = Some(Wires {
            ready,
            interlock,
            broken,
        });
        Enabled {
            enables,
            drives: self
                .each
                .map(|amplifier| amplifier.drives(at.0) && !amplifier.open),
        }
    }
}

#[cfg(test)]
mod tests {
    use std::num::NonZeroU64;

    use super::*;
    use crate::board::{CORE_HZ, ControllerBoard};

    const ENABLED: Amplifier = Amplifier {
        enabled_ns: Some(0),
        ..Amplifier::WELL
    };

    /// Whether it drives, and the level on its ready line.
    #[test]
    fn amplifier_without_supply_or_enable_drives_nothing() {
        let [mut unready, mut cut, mut unpowered, mut disabled] = [ENABLED; 4];
        (unready.unready, cut.cut) = (true, true);
        (unpowered.powered, disabled.enabled_ns) = (false, None);
        for (it, expected) in [
            (ENABLED, (true, Some(true))),
            (unready, (true, None)),
            (cut, (true, None)),
            (unpowered, (false, None)),
            (disabled, (false, None)),
        ] {
            let now = READY_AFTER_NS;
            assert_eq!((it.drives(now), it.ready(now)), expected, "{it:?}");
            assert!(!it.drives(now - 1));
        }
    }

    #[test]
    fn monitor_has_half_of_its_range_at_half_of_its_current() {
        let input = Monitor {
            offset: 10.0,
            amps: 7.5,
        };
        assert_eq!(ENABLED.monitor(3.75, input), 2048.0 + 10.0 + 1024.0);
        let monitor_cut = Amplifier {
            monitor_cut: true,
            ..ENABLED
        };
        let unpowered = Amplifier {
            powered: false,
            ..ENABLED
        };
        for pulled_down in [monitor_cut, unpowered] {
            assert_eq!(pulled_down.monitor(3.75, input), 0.0);
        }
    }

    #[test]
    fn emergency_stop_and_lost_supply_open_the_loop() {
        let rate = NonZeroU64::new(CORE_HZ).unwrap();
        let mut part = ControllerBoard::new(8_000_000, rate).unwrap().part;
        let mut amplifiers = Amplifiers::new(&[]);
        let mut loop_at = |amplifiers: &mut Amplifiers, ns| {
            amplifiers.follow(&mut part, VirtualNanos(ns));
            amplifiers.driven.and_then(|wires| wires.interlock)
        };
        amplifiers.stop_until(20_000);
        assert_eq!(loop_at(&mut amplifiers, 19_999), None);
        assert_eq!(loop_at(&mut amplifiers, 20_000), Some(true));
        amplifiers.each[LARGE].powered = false;
        assert_eq!(loop_at(&mut amplifiers, 21_000), None);
        amplifiers.each[LARGE].powered = true;
        amplifiers.stop_until(u64::MAX);
        amplifiers.stop_until(50_000);
        assert_eq!(loop_at(&mut amplifiers, 60_000), None);
    }
}
