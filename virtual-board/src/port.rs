//! The far end of the board's serial port, USART3, in place of the ST-LINK.

use std::collections::VecDeque;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use rigless::chip::Timeline;
use rigless::chip::uart::{Peer, Rate};
use rigless::snapshot::Store;
use rigless::time::VirtualNanos;

use crate::board::Part;
use crate::probe::schedule;
use crate::run::Setup;

/// Number of USART3 in the emulator's list of serial ports.
const USART3: usize = 2;

/// How bytes arrive at the board, from an instant on.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct LineErrors {
    /// Bytes of a million with noise: they arrive with other bits and the noise flag.
    pub noise: u32,
    /// Bytes of a million with a framing error: they arrive with other bits and the flag.
    pub framing: u32,
}

impl LineErrors {
    /// Every byte arrives with a framing error, as on a line that is shorted or has another rate.
    pub const EVERY_BYTE: Self = Self {
        noise: 0,
        framing: Rate::EVERY_WORD,
    };
}

/// Bytes on their way, each with its time in ns.
#[derive(Debug, Default)]
pub(crate) struct Wire {
    /// Bytes to the board: the earliest time at which each can begin.
    pub(crate) down: VecDeque<(u64, u8)>,
    /// Bytes from the board: the end of the stop bit of each.
    pub(crate) up: Vec<(u64, u8)>,
}

/// The far end, which the emulator owns; the wire is shared with the lockstep.
#[derive(Debug)]
struct FarEnd(Arc<Mutex<Wire>>);

/// A panic elsewhere leaves bytes as they are.
fn locked(wire: &Mutex<Wire>) -> MutexGuard<'_, Wire> {
    wire.lock().unwrap_or_else(PoisonError::into_inner)
}

impl Store for FarEnd {}

impl Peer for FarEnd {
    fn receive(&mut self, word: u16, timeline: &mut Timeline<'_, '_>) {
        let at = timeline.now().0;
        locked(&self.0).up.push((at, word as u8));
    }

    fn transmit(&mut self, now: VirtualNanos) -> Option<u16> {
        let mut wire = locked(&self.0);
        let byte = wire.down.pop_front_if(|(at, _)| *at <= now.0);
        byte.map(|(_, byte)| u16::from(byte))
    }
}

/// The far end as the lockstep works it.
#[derive(Debug)]
pub(crate) struct Port {
    wire: Arc<Mutex<Wire>>,
    errors: VecDeque<(u64, LineErrors)>,
    seed: u64,
}

impl Port {
    /// The far end that sends what the setup has for it.
    pub(crate) fn new(setup: &Setup) -> Self {
        let bursts = schedule(setup.port.iter().cloned());
        let down = bursts
            .into_iter()
            .flat_map(|(at, bytes)| bytes.into_iter().map(move |byte| (at, byte)));
        let wire = Wire {
            down: down.collect(),
            up: Vec::new(),
        };
        Self {
            wire: Arc::new(Mutex::new(wire)),
            errors: schedule(setup.port_errors.iter().copied()),
            seed: setup.seed,
        }
    }

    /// Connects the far end to the board.
    pub(crate) fn attach(&self, part: &mut Part) {
        part.stm32.usart[USART3].attach(FarEnd(Arc::clone(&self.wire)));
    }

    /// Sets the errors of the line that begin now.
    pub(crate) fn look(&mut self, part: &mut Part, now_ns: u64) {
        while let Some((_, errors)) = self.errors.pop_front_if(|(at, _)| *at <= now_ns) {
            let rate = |name, per_million| Rate { name, per_million };
            let line = part.stm32.usart[USART3].errors_mut();
            line.noise = rate("noise", errors.noise);
            line.framing = rate("framing", errors.framing);
            line.seed = self.seed;
        }
    }

    /// The bytes on their way.
    pub(crate) fn wire(&self) -> MutexGuard<'_, Wire> {
        locked(&self.wire)
    }
}
