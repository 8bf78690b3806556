//! The emulator's calls, recorded if the run is traced.

use rigless::emulator::{Driver, Host, Settled, Stop};
use rigless::session::Session;
use rigless::time::VirtualNanos;

use super::Lockstep;
use crate::board::ControllerBoard;
use crate::trace::Recorder;

impl Driver<ControllerBoard> for Lockstep {
    fn on_settled(
        &mut self,
        session: &mut Session<ControllerBoard>,
        host: &mut dyn Host,
        settled: Settled,
    ) {
        let Some(mut trace) = self.trace.take() else {
            return self.settled(session, host, settled);
        };
        trace.settled(&settled);
        let at = match settled {
            Settled::Access { access, .. } => access.instruction_count,
            Settled::Hit(hit) => hit.instruction_count,
            Settled::Stop(stop) => {
                trace.reset(session.resets().len(), stop.instruction_count);
                stop.instruction_count
            }
            _ => 0,
        };
        let mut recorder = Recorder {
            trace: &mut trace,
            host,
            at,
        };
        self.settled(session, &mut recorder, settled);
        self.trace = Some(trace);
    }

    fn on_stop(
        &mut self,
        session: &mut Session<ControllerBoard>,
        stop: Stop,
        host: &mut dyn Host,
    ) -> Option<VirtualNanos> {
        let Some(mut trace) = self.trace.take() else {
            return self.stopped(session, stop, host);
        };
        let at = stop.instruction_count;
        if self.steps == 0 {
            trace.begin(host);
        }
        let mut recorder = Recorder {
            trace: &mut trace,
            host,
            at,
        };
        let next = self.stopped(session, stop, &mut recorder);
        if next.is_none() {
            trace.end(host, at);
        }
        self.trace = Some(trace);
        next
    }
}
