//! The debug probe: reads telemetry and sends the commands of a run.

use std::collections::VecDeque;

use rigless::emulator::Memory;

use crate::command::Command;
use crate::rtt::Rtt;
use crate::run::Setup;

const KEEP_ALIVE_NS: u64 = 50_000_000;

/// Polls the target: reads its telemetry and sends the commands that are due.
#[derive(Debug)]
pub(crate) struct DebugProbe {
    /// Bytes from up channel 0, the log.
    pub(crate) stream: Vec<u8>,
    /// Bytes from up channel 1, the link.
    pub(crate) link: Vec<u8>,
    /// Time from which telemetry is read, ns.
    drains_from: u64,
    /// Whether the command channel is kept full of random bytes.
    pub(crate) floods: bool,
    /// Bytes of the first pending command that the channel has accepted.
    taken: usize,
    /// Sent bytes, each with the time of the last byte, ns.
    pub(crate) sent: Vec<(u64, Vec<u8>)>,
    noise: u32,
    rtt: Rtt,
    to_send: VecDeque<(u64, Vec<u8>)>,
    next_keep_alive: Option<u64>,
}

/// Events in order of time, ns.
pub(crate) fn schedule<T>(list: impl Iterator<Item = (f64, T)>) -> VecDeque<(u64, T)> {
    let mut list: Vec<_> = list.map(|(at, what)| ((at * 1e9) as u64, what)).collect();
    list.sort_by_key(|(at, _)| *at);
    list.into()
}

impl DebugProbe {
    pub(crate) fn new(rtt: u64, setup: &Setup) -> Self {
        let commands = setup.commands.iter();
        let commands = commands.map(|(at, command)| (*at, command.encode().to_vec()));
        Self {
            stream: Vec::new(),
            link: Vec::new(),
            drains_from: 0,
            floods: false,
            taken: 0,
            sent: Vec::new(),
            noise: 0x2F6E_2B1D,
            rtt: Rtt(rtt),
            to_send: schedule(commands.chain(setup.garbage.iter().cloned())),
            next_keep_alive: setup.keep_alive.then_some(KEEP_ALIVE_NS),
        }
    }

    /// Reads no telemetry until this time at least, ns.
    pub(crate) fn pause_until(&mut self, ns: u64) {
        self.drains_from = self.drains_from.max(ns);
    }

    pub(crate) fn poll(&mut self, now_ns: u64, memory: &mut dyn Memory) {
        if now_ns >= self.drains_from {
            self.rtt.drain(0, memory, &mut self.stream);
            self.rtt.drain(1, memory, &mut self.link);
        }
        if let Some(next) = self.next_keep_alive.filter(|next| *next <= now_ns) {
            let bytes = Command::KeepAlive.encode().to_vec();
            self.to_send.push_back((now_ns, bytes));
            self.to_send.make_contiguous().sort_by_key(|(due, _)| *due);
            self.next_keep_alive = Some(next + KEEP_ALIVE_NS);
        }
        while let Some((_, bytes)) = self.to_send.front().filter(|(due, _)| *due <= now_ns) {
            self.taken += self.rtt.feed(memory, &bytes[self.taken..]);
            if self.taken < bytes.len() {
                return;
            }
            self.taken = 0;
            if let Some((_, bytes)) = self.to_send.pop_front() {
                self.sent.push((now_ns, bytes));
            }
        }
        while self.floods {
            self.noise ^= self.noise << 13;
            self.noise ^= self.noise >> 17;
            self.noise ^= self.noise << 5;
            if self.rtt.feed(memory, &self.noise.to_le_bytes()) < 4 {
                break;
            }
        }
    }
}
