//! Injection of faults into the running board.

use rigless::emulator::{Host, Stop};
use rigless::mcu::Operate;
use rigless::session::Session;
use rigless::soc::Width;
use rigless::time::VirtualNanos;

use super::{COUNTERS, Lockstep};
use crate::board::{ControllerBoard, Part};
use crate::fault::Fault;
use crate::pins;
use crate::quadrature::{LARGE, SMALL};
use crate::run::RATE_HZ;

/// Control register of the control tick's timer, TIM5.
const TICK_CONTROL: u64 = 0x4000_0C00;
/// Control register of the cycle counter; bit 0 enables it.
const CYCLES_CONTROL: u64 = 0xE000_1000;

/// Duration of a control task that is too long, ns.
const LONG_TASK_NS: u64 = (1.2e9 / RATE_HZ) as u64;
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
    /// The cycle counter's control register before a debugger halted the core.
    cycles_control: Option<u64>,
    /// Time until which every control task is too long.
    long_tasks: u64,
    /// Time for which the task of lowest priority is to loop after its next wake.
    hang: Option<u64>,
    /// Time at which the task of lowest priority continues.
    hung: Option<u64>,
    /// Whether the task of lowest priority is to panic at its next wake.
    panics: bool,
}

impl Lockstep {
    pub(super) fn fail(
        &mut self,
        fault: Fault,
        session: &mut Session<ControllerBoard>,
        stop: Stop,
        host: &mut dyn Host,
    ) {
        let (at, now) = (stop.at, self.lines.now());
        let part = &mut session.board_mut().part;
        match fault {
            Fault::StuckA => self.lines.stuck[0] = Some(now[0]),
            Fault::StuckB => self.lines.stuck[1] = Some(now[1]),
            Fault::StuckBoth => self.lines.stuck = now.map(Some),
            Fault::Swapped => self.lines.swapped = true,
            Fault::LostCounts => self.lines.lossy = Some(0),
            Fault::AmplifierFault => pins::drive(part, at, pins::FAULTS[LARGE], false),
            Fault::SmallAmplifierFault => pins::drive(part, at, pins::FAULTS[SMALL], false),
            Fault::HungCore => host.hold(true),
            Fault::Halt(ms) => {
                host.hold(true);
                self.stalls.release = Some(at.0 + 1_000_000 * u64::from(ms));
                self.stalls.cycles_control = Some(stop_cycles(part, at));
            }
            Fault::LongTasks => self.stalls.long_tasks = at.0 + LONG_TASKS_NS,
            Fault::HungControl => {
                // A write to an existing timer cannot fail.
                let _ = part.write(at, TICK_CONTROL, Width::W32, 0);
            }
            Fault::HungIdle => self.stalls.hang = Some(u64::MAX),
            Fault::StarvedIdle => self.stalls.hang = Some(STARVED_NS),
            Fault::Panic => self.stalls.panics = true,
            Fault::BusError => session.fail_next(COUNTERS[LARGE], COUNTERS[LARGE] + 4),
            // The board is built with these parts.
            Fault::DeadCrystal | Fault::SlowWatchdog | Fault::FastWatchdog => {}
            Fault::CrystalFails => part.stm32.drive_clocks(at, |rcc, registers, context| {
                rcc.fail_hse(registers, context);
            }),
            Fault::NobodyDrains => self.probe.drains_from = u64::MAX,
            Fault::DrainPause => self.probe.drains_from = at.0 + PAUSE_NS,
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
        if self.stalls.release.is_some_and(|release| release <= at.0) {
            self.stalls.release = None;
            host.hold(false);
            if let Some(control) = self.stalls.cycles_control.take() {
                // A write to the existing counter cannot fail.
                let part = &mut session.board_mut().part;
                let _ = part.write(at, CYCLES_CONTROL, Width::W32, control);
            }
        }
    }

    /// Called when the control task has read the large counter. If control tasks are to be too
    /// long, the core stops here, so that the task has the duration of the fault.
    pub(super) fn lengthen(&mut self, at: VirtualNanos, host: &mut dyn Host) {
        let (Some((tick, _)), Some(last)) = (&self.running, self.recorded.ticks.last()) else {
            return;
        };
        if at.0 < self.stalls.long_tasks && self.stalls.release.is_none() {
            let own_ns = (f64::from(last.instructions) * self.instruction_ns) as u64;
            self.stalls.release = Some(tick.at_ns + LONG_TASK_NS.saturating_sub(own_ns));
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

/// Stops the cycle counter, as the debug state does, and returns its control register.
fn stop_cycles(part: &mut Part, at: VirtualNanos) -> u64 {
    let control = part.peek(at, CYCLES_CONTROL, Width::W32).unwrap_or(0);
    // A write to the existing counter cannot fail.
    let _ = part.write(at, CYCLES_CONTROL, Width::W32, control & !1);
    control
}
