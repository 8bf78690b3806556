//! The debug probe, and whoever sits at its keyboard.

use std::collections::VecDeque;

use rigless::emulator::Memory;

use crate::command::Command;
use crate::rtt::Rtt;
use crate::run::Setup;

const KEEP_ALIVE_NS: u64 = 50_000_000;

/// Looks at the target every now and then: takes its telemetry, gives it what is due.
#[derive(Debug)]
pub(crate) struct Probe {
    /// What came out of up channel 0.
    pub(crate) stream: Vec<u8>,
    /// Whether anything is taken.
    pub(crate) drains: bool,
    rtt: Rtt,
    to_send: VecDeque<(u64, Vec<u8>)>,
    next_keep_alive: Option<u64>,
}

/// What happens when, in order, ns.
pub(crate) fn schedule<T>(list: impl Iterator<Item = (f64, T)>) -> VecDeque<(u64, T)> {
    let mut list: Vec<_> = list.map(|(at, what)| ((at * 1e9) as u64, what)).collect();
    list.sort_by_key(|(at, _)| *at);
    list.into()
}

impl Probe {
    pub(crate) fn new(rtt: u64, setup: &Setup) -> Self {
        let commands = setup.commands.iter();
        let commands = commands.map(|(at, command)| (*at, command.encode().to_vec()));
        Self {
            stream: Vec::new(),
            drains: true,
            rtt: Rtt(rtt),
            to_send: schedule(commands.chain(setup.garbage.iter().cloned())),
            next_keep_alive: setup.keep_alive.then_some(KEEP_ALIVE_NS),
        }
    }

    pub(crate) fn look(&mut self, now_ns: u64, memory: &mut dyn Memory) {
        if self.drains {
            self.rtt.drain(memory, &mut self.stream);
        }
        if let Some(next) = self.next_keep_alive.filter(|next| *next <= now_ns) {
            let bytes = Command::KeepAlive.encode().to_vec();
            self.to_send.push_back((now_ns, bytes));
            self.to_send.make_contiguous().sort_by_key(|(due, _)| *due);
            self.next_keep_alive = Some(next + KEEP_ALIVE_NS);
        }
        while let Some((_, bytes)) = self.to_send.front_mut().filter(|(due, _)| *due <= now_ns) {
            let put = self.rtt.feed(memory, bytes);
            bytes.drain(..put);
            if !bytes.is_empty() {
                break;
            }
            self.to_send.pop_front();
        }
    }
}
