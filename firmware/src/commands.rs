//! Commands from RTT down channel 0 to the control task.

use drivers::Parser;
use haptic_control::Request;
use heapless::spsc::{Producer, Queue};

/// Requests that wait for the control task, which takes one a tick.
pub(crate) type Requests = Queue<Request, 8>;
/// Bytes that one look takes at most.
const BYTES: usize = 64;

/// The receiving end of the command channel.
pub(crate) struct Commands {
    parser: Parser,
    queue: Producer<'static, Request>,
    reported: u32,
    reports: u8,
}

impl Commands {
    /// A receiver that has seen nothing.
    pub(crate) fn new(queue: Producer<'static, Request>) -> Self {
        Self {
            parser: Parser::default(),
            queue,
            reported: 0,
            reports: 0,
        }
    }

    /// Takes what came down, while there is place for what it asks.
    pub(crate) fn receive(&mut self) {
        for _ in 0..BYTES {
            if !self.queue.ready() {
                return;
            }
            let Some(byte) = bare::receive() else {
                break;
            };
            if let Some(request) = self.parser.take(byte) {
                let _ = self.queue.enqueue(request);
            }
        }
    }

    /// Says at times, not for every byte of a flood, what was no command.
    pub(crate) fn report(&mut self) {
        self.reports = self.reports.wrapping_add(1);
        if self.reports == 0 && self.parser.garbage() != self.reported {
            self.reported = self.parser.garbage();
            defmt::warn!("garbage bytes={=u32}", self.reported);
        }
    }
}
