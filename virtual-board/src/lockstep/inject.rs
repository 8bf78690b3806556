//! Faults done to the running board.

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

/// How long a control task is that is too long, ns.
const LONG_TASK_NS: u64 = (1.2e9 / RATE_HZ) as u64;
/// How long control tasks are too long.
const LONG_TASKS_NS: u64 = 10_000_000;
/// How long the task of lowest priority starves.
const STARVED_NS: u64 = 40_000_000;
/// How long nobody drains the telemetry in a pause.
const PAUSE_NS: u64 = 300_000_000;

/// What faults do to the core for a time; a restart ends all of it. Instants in ns.
#[derive(Debug, Default)]
pub(super) struct Stalls {
    /// When the core that is held is let go.
    pub(super) release: Option<u64>,
    /// The cycle counter's control register before a debugger halted the core.
    cycles_control: Option<u64>,
    /// Until then every control task is too long.
    long_tasks: u64,
    /// How long the task of lowest priority is to hang from its next wake on.
    hang: Option<u64>,
    /// When the task of lowest priority is to go on.
    hung: Option<u64>,
    /// Whether the task of lowest priority is to panic from its next wake on.
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
                // The timer is there: the write cannot be refused.
                let _ = part.write(at, TICK_CONTROL, Width::W32, 0);
            }
            Fault::HungIdle => self.stalls.hang = Some(u64::MAX),
            Fault::StarvedIdle => self.stalls.hang = Some(STARVED_NS),
            Fault::Panic => self.stalls.panics = true,
            Fault::BusError => session.fail_next(COUNTERS[LARGE], COUNTERS[LARGE] + 4),
            // The board was built so.
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

    /// Lets the core go if its time has come.
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
                // The counter is there: the write cannot be refused.
                let part = &mut session.board_mut().part;
                let _ = part.write(at, CYCLES_CONTROL, Width::W32, control);
            }
        }
    }

    /// The control task has read the large counter: where its tasks are too long, the core stands
    /// until only the rest of the task is left of that time.
    pub(super) fn lengthen(&mut self, at: VirtualNanos, host: &mut dyn Host) {
        let (Some((tick, _)), Some(last)) = (&self.running, self.seen.ticks.last()) else {
            return;
        };
        if at.0 < self.stalls.long_tasks && self.stalls.release.is_none() {
            let own_ns = (f64::from(last.instructions) * self.instruction_ns) as u64;
            self.stalls.release = Some(tick.at_ns + LONG_TASK_NS.saturating_sub(own_ns));
            host.hold(true);
        }
    }

    /// The control task begins. If it has woken the processor and the task of lowest priority is to
    /// hang, it returns not behind the instruction that waits, but into a loop without end, which
    /// the exception's frame on the stack says; and back when the time is over. If the task is to
    /// panic, it returns to where a failed assertion ends.
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

    /// Exchanges a word on the stack for another wherever it is.
    fn exchange(&self, old: u64, new: u64, host: &mut dyn Host) {
        for at in self.stack.words() {
            if host.read(at, Width::W32).ok() == Some(old) {
                // It is RAM: the write cannot be refused.
                let _ = host.write(at, Width::W32, new);
            }
        }
    }
}

/// Stops the cycle counter, as the debug state does; what its control register was.
fn stop_cycles(part: &mut Part, at: VirtualNanos) -> u64 {
    let control = part.peek(at, CYCLES_CONTROL, Width::W32).unwrap_or(0);
    // The counter is there: the write cannot be refused.
    let _ = part.write(at, CYCLES_CONTROL, Width::W32, control & !1);
    control
}
