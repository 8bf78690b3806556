//! Injection of faults into the running board.

use rigless::emulator::{Host, Stop};
use rigless::mcu::Operate;
use rigless::session::Session;
use rigless::soc::Width;
use rigless::time::VirtualNanos;

use super::{COUNTERS, Lockstep};
use crate::board::{ControllerBoard, Part};
use crate::fault::Fault;
use crate::quadrature::{LARGE, SMALL};

/// Control register of the control tick's timer, TIM5.
const TICK_CONTROL: u64 = 0x4000_0C00;
/// Control register of the cycle counter; bit 0 enables it.
const CYCLES_CONTROL: u64 = 0xE000_1000;

/// Freeze register of the bus of TIM8, `DBGMCU_APB2_FZ`, and the bit `DBG_TIM8_STOP` in it.
const HALT_CONTROL: u64 = 0xE004_200C;
const STOPS_TIM8: u64 = 1 << 1;
/// Control and break register of TIM8, and the bit `MOE` of the latter.
const TIM8_CONTROL: u64 = 0x4001_0400;
const TIM8_BREAK: u64 = 0x4001_0444;
const OUTPUTS_ON: u64 = 1 << 15;
/// Key register of the watchdog, and the key that restarts its time.
const WATCHDOG_KEY: u64 = 0x4000_3000;
const WATCHDOG_FEED: u64 = 0xAAAA;

/// Voltage of a supply that has dropped, and of one that braking motors have charged, V.
const DROPPED_V: f64 = 18.0;
const RISEN_V: f64 = 31.0;

/// Time for which a glitch opens the interlock loop, ns.
const GLITCH_NS: u64 = 20_000;
/// Duration of a control task that is too long, periods.
const LONG_TASK: f64 = 1.2;
/// Time in which every control task is too long, ns.
const LONG_TASKS_NS: u64 = 10_000_000;
/// Time for which the task of lowest priority loops, ns.
const STARVED_NS: u64 = 40_000_000;
/// Time for which telemetry is not read, ns.
const PAUSE_NS: u64 = 300_000_000;

/// Temporary faults of the core, which a restart ends. Times in ns.
#[derive(Debug, Default)]
pub(super) struct Stalls {
    /// Time at which a halted core continues.
    pub(super) release: Option<u64>,
    /// Time at which the core continues that waits for the flash.
    pub(super) flash: Option<u64>,
    /// Registers that a halt by a debugger has changed, and their values before.
    halted: Vec<(u64, u64)>,
    /// Whether a debugger has frozen the watchdog.
    pub(super) frozen: bool,
    /// Whether the core does not continue at the end of any of these times.
    for_ever: bool,
    /// Time until which every control task is too long, and its duration.
    long_tasks: (u64, u64),
    /// Time for which the task of lowest priority is to loop after its next wake.
    hang: Option<u64>,
    /// Time at which the task of lowest priority continues.
    hung: Option<u64>,
    /// Whether the task of lowest priority is to panic at its next wake.
    panics: bool,
}

impl Stalls {
    /// Time at which a core continues that is held, ns.
    pub(super) fn next(&self) -> u64 {
        let times = [self.release, self.flash].into_iter().flatten();
        times.min().unwrap_or(u64::MAX)
    }

    /// Halts the core by a debugger, if it is not halted already.
    fn halt(&mut self, part: &mut Part, at: VirtualNanos) {
        if self.halted.is_empty() {
            self.halted = halt(part, at);
        }
    }

    /// Halts the core by a debugger that freezes the watchdog, until a reset.
    fn freeze(&mut self, part: &mut Part, at: VirtualNanos) {
        (self.frozen, self.for_ever) = (true, true);
        self.halt(part, at);
    }
}

impl Lockstep {
    pub(super) fn fail(
        &mut self,
        fault: Fault,
        session: &mut Session<ControllerBoard>,
        stop: Stop,
        host: &mut dyn Host,
    ) {
        let at = stop.at;
        let now = [LARGE, SMALL].map(|encoder| self.lines.now(encoder));
        let [large, small] = &mut self.lines.broken;
        let part = &mut session.board_mut().part;
        match fault {
            Fault::StuckA => large.stuck[0] = Some(now[LARGE][0]),
            Fault::StuckB => large.stuck[1] = Some(now[LARGE][1]),
            Fault::StuckBoth => large.stuck = now[LARGE].map(Some),
            Fault::SmallStuck => small.stuck = now[SMALL].map(Some),
            Fault::Swapped => large.swapped = true,
            Fault::SmallSwapped => small.swapped = true,
            Fault::LostCounts => large.lossy = Some(0),
            Fault::AmplifierFault => self.amplifiers.each[LARGE].unready = true,
            Fault::SmallAmplifierFault => self.amplifiers.each[SMALL].unready = true,
            Fault::BrokenReadyWire => self.amplifiers.each[LARGE].cut = true,
            Fault::Unpowered => self.amplifiers.each[LARGE].powered = false,
            Fault::OpenLead => self.amplifiers.each[LARGE].open = true,
            Fault::SmallOpenLead => self.amplifiers.each[SMALL].open = true,
            Fault::SmallReversed => self.amplifiers.each[SMALL].reversed = true,
            Fault::BrokenMonitorWire => self.amplifiers.each[LARGE].monitor_cut = true,
            Fault::SupplyDrop => self.supply_v = DROPPED_V,
            Fault::SupplyRise => self.supply_v = RISEN_V,
            Fault::EmergencyStop => self.amplifiers.stop_until(u64::MAX),
            Fault::InterlockGlitch => self.amplifiers.stop_until(at.0 + GLITCH_NS),
            Fault::HungCore => {
                host.hold(true);
                self.stalls.for_ever = true;
            }
            Fault::Halt(ms) => {
                host.hold(true);
                let release = at.0 + 1_000_000 * u64::from(ms);
                self.stalls.release = self.stalls.release.max(Some(release));
                self.stalls.halt(part, at);
            }
            Fault::FrozenHalt => {
                host.hold(true);
                self.stalls.freeze(part, at);
            }
            Fault::FrozenHaltTimerOn => {
                host.hold(true);
                change(part, at, HALT_CONTROL, |bits| bits & !STOPS_TIM8);
                self.stalls.freeze(part, at);
            }
            Fault::LongTasks => {
                let task_ns = (LONG_TASK * self.recorded.period_ns()) as u64;
                self.stalls.long_tasks = (at.0 + LONG_TASKS_NS, task_ns);
            }
            Fault::HungControl => {
                change(part, at, TICK_CONTROL, |_| 0);
            }
            Fault::HungIdle => self.stalls.hang = Some(u64::MAX),
            Fault::StarvedIdle => self.stalls.hang = Some(STARVED_NS),
            Fault::Panic => self.stalls.panics = true,
            Fault::BusError => session.fail_next(COUNTERS[LARGE], COUNTERS[LARGE] + 4),
            // The board is built with these parts.
            Fault::DeadCrystal
            | Fault::SlowWatchdog
            | Fault::FastWatchdog
            | Fault::ReadyAfter(_) => {}
            Fault::CrystalFails => part.stm32.drive_clocks(at, |rcc, registers, context| {
                rcc.fail_hse(registers, context);
            }),
            Fault::NobodyDrains => self.probe.pause_until(u64::MAX),
            Fault::DrainPause => self.probe.pause_until(at.0 + PAUSE_NS),
            Fault::CommandFlood => self.probe.floods = true,
            Fault::BrownOut => {
                part.brown_out = true;
                session.reset_by_pin(at, stop.instruction_count, host);
            }
        }
    }

    /// Continues a halted core at the end of its halt.
    pub(super) fn release(
        &mut self,
        session: &mut Session<ControllerBoard>,
        at: VirtualNanos,
        host: &mut dyn Host,
    ) {
        if self.stalls.flash.take_if(|over| *over <= at.0).is_some()
            && self.stalls.release.is_none()
        {
            host.hold(self.stalls.for_ever);
        }
        if self.stalls.release.is_some_and(|release| release <= at.0) {
            self.stalls.release = None;
            host.hold(self.stalls.for_ever);
            if self.stalls.for_ever {
                return;
            }
            let part = &mut session.board_mut().part;
            for (register, value) in self.stalls.halted.drain(..) {
                // A write to an existing register cannot fail.
                let _ = part.write(at, register, Width::W32, value);
            }
        }
    }

    /// Keeps a frozen watchdog from counting. The emulator has no freeze bits: the watchdog is fed.
    pub(super) fn hold_watchdog(&self, part: &mut Part, at: VirtualNanos) {
        if self.stalls.frozen {
            change(part, at, WATCHDOG_KEY, |_| WATCHDOG_FEED);
        }
    }

    /// Called when the control task has read the large counter. If control tasks are to be too
    /// long, the core stops here, so that the task has the duration of the fault.
    pub(super) fn lengthen(&mut self, at: VirtualNanos, host: &mut dyn Host) {
        let (Some((tick, _)), Some(last)) = (&self.running, self.recorded.ticks.last()) else {
            return;
        };
        let (until, task_ns) = self.stalls.long_tasks;
        if at.0 < until && self.stalls.release.is_none() {
            let own_ns = (f64::from(last.instructions) * self.instruction_ns) as u64;
            self.stalls.release = Some(tick.at_ns + task_ns.saturating_sub(own_ns));
            host.hold(true);
        }
    }

    /// Called when the control task begins. If the control task has woken the processor and the
    /// task of lowest priority is to loop, the return address in the exception frame is changed to
    /// an endless loop, and changed back at the end of the loop's time. If the task of lowest
    /// priority is to panic, the return address is changed to the function that a failed assertion
    /// calls.
    pub(super) fn hang(&mut self, at: VirtualNanos, host: &mut dyn Host) {
        let (behind, for_ever) = (self.wait + 2, self.for_ever);
        if self.asleep && std::mem::take(&mut self.stalls.panics) {
            self.exchange(behind, self.panic, host);
        } else if self.asleep
            && let Some(how_long) = self.stalls.hang.take()
        {
            self.stalls.hung = Some(at.0.saturating_add(how_long));
            self.exchange(behind, for_ever, host);
        } else if self.stalls.hung.is_some_and(|until| until <= at.0) {
            self.stalls.hung = None;
            self.exchange(for_ever, behind, host);
        }
    }

    /// Replaces every occurrence of a word on the stack by another.
    fn exchange(&self, old: u64, new: u64, host: &mut dyn Host) {
        for at in self.stack.words() {
            if host.read(at, Width::W32).ok() == Some(old) {
                // A write to RAM cannot fail.
                let _ = host.write(at, Width::W32, new);
            }
        }
    }
}

/// Does what a halt of the core by a debugger does: stops the cycle counter, and, if
/// `DBG_TIM8_STOP` is set, stops TIM8 and disables its outputs as if `MOE` were clear. Returns the
/// changed registers and their values before.
fn halt(part: &mut Part, at: VirtualNanos) -> Vec<(u64, u64)> {
    let mut changed = vec![(
        CYCLES_CONTROL,
        change(part, at, CYCLES_CONTROL, |control| control & !1),
    )];
    let stops = part.peek(at, HALT_CONTROL, Width::W32).unwrap_or(0);
    if stops & STOPS_TIM8 != 0 {
        for (register, bit) in [(TIM8_CONTROL, 1), (TIM8_BREAK, OUTPUTS_ON)] {
            changed.push((register, change(part, at, register, |bits| bits & !bit)));
        }
    }
    changed
}

/// Changes an existing register and returns its value before.
fn change(part: &mut Part, at: VirtualNanos, register: u64, new: impl Fn(u64) -> u64) -> u64 {
    let before = part.peek(at, register, Width::W32).unwrap_or(0);
    // A write to an existing register cannot fail.
    let _ = part.write(at, register, Width::W32, new(before));
    before
}
