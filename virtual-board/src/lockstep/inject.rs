//! Faults done to the running board.

use rigless::emulator::{Host, Stop};
use rigless::mcu::Operate;
use rigless::session::Session;
use rigless::soc::Width;

use super::{COUNTERS, Lockstep};
use crate::board::ControllerBoard;
use crate::fault::Fault;
use crate::pins;
use crate::quadrature::LARGE;

/// Control register of the control tick's timer, TIM5.
const TICK_CONTROL: u64 = 0x4000_0C00;
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
            Fault::AmplifierFault => pins::drive(part, at, pins::FAULTS[0], false),
            Fault::HungCore => host.hold(true),
            Fault::HungControl => {
                // The timer is there: the write cannot be refused.
                let _ = part.write(at, TICK_CONTROL, Width::W32, 0);
            }
            Fault::HungIdle => self.hang = true,
            Fault::BusError => session.fail_next(COUNTERS[LARGE], COUNTERS[LARGE] + 4),
            // The board was built without.
            Fault::DeadCrystal => {}
            Fault::CrystalFails => part.stm32.drive_clocks(at, |rcc, registers, context| {
                rcc.fail_hse(registers, context);
            }),
            Fault::NobodyDrains => self.probe.drains = false,
            Fault::CommandFlood => self.probe.floods = true,
            Fault::BrownOut => {
                part.brown_out = true;
                session.reset_by_pin(at, stop.instruction_count, host);
            }
        }
    }

    /// The control task has just woken the processor: it will return not behind the instruction
    /// that waits, but into a loop without end, which the exception's frame on the stack says.
    pub(super) fn hang(&mut self, host: &mut dyn Host) {
        let behind = self.wait + 2;
        for at in self.stack.words() {
            if host.read(at, Width::W32).ok() == Some(behind) {
                // It is RAM: the write cannot be refused.
                let _ = host.write(at, Width::W32, self.for_ever);
                self.hang = false;
            }
        }
    }
}
