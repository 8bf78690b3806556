//! Watchpoints at the start and the end of the control task.

use rigless::emulator::{Hit, Host};
use rigless::session::Session;

use super::Lockstep;
use crate::board::ControllerBoard;
use crate::pins;
use crate::run::ControlTick;

impl Lockstep {
    pub(super) fn hit(
        &mut self,
        session: &mut Session<ControllerBoard>,
        host: &mut dyn Host,
        hit: &Hit,
    ) {
        if hit.address == self.entry {
            self.follow.enter(self.recorded.ticks.len(), host);
        }
        self.follow.pass(hit.address);
        if hit.address == self.wait {
            self.asleep = true;
        } else if hit.address == self.entry {
            self.enter(session, hit);
        } else if self.exits.contains(&hit.address)
            && let Some((mut tick, start)) = self.running.take()
        {
            // The return instruction has not run yet.
            tick.instructions = (hit.instruction_count - start + 1) as u32;
            (tick.cycles, tick.fetches) = self.follow.leave(tick.instructions).unzip();
            let part = &mut session.board_mut().part;
            tick.codes = part.dac_codes();
            tick.enabled = pins::enabled(part);
            self.recorded.ticks.push(tick);
            self.asleep = false;
        }
    }

    fn enter(&mut self, session: &mut Session<ControllerBoard>, hit: &Hit) {
        if self.recorded.ticks.is_empty() {
            self.recorded.complaints = pins::complaints(&mut session.board_mut().part);
        }
        self.recorded.unclosed += u32::from(self.running.is_some());
        let since = self.since_tick();
        let tick = ControlTick {
            at_ns: hit.at.0,
            asleep: self.asleep,
            instructions: 0,
            cycles: None,
            fetches: None,
            counts: [None; 2],
            stamp_clock_read_ns: None,
            codes: [None; 2],
            enabled: [false; 2],
            large: self.bench.plant.large(),
            handle: self.bench.plant.small(),
            felt: self.bench.plant.handle_torque(&self.grip, since),
        };
        self.running = Some((tick, hit.instruction_count));
    }
}
