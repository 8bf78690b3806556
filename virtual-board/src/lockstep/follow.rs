//! Follows selected calls of the control task instruction by instruction.

use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

use rigless::emulator::{Host, Watch};

use crate::cycles;
use crate::fetch::{Fetch, Fetches};
use crate::image::Image;
use crate::run::Setup;
use crate::thumb::is_wide;

pub(super) struct Follow {
    /// Ticks to follow.
    ticks: BTreeSet<usize>,
    /// Both halves of every instruction that the control task reaches, by address.
    code: Arc<BTreeMap<u64, [u16; 2]>>,
    /// Addresses of `instructions` whose watchpoints are always set.
    watched: BTreeSet<u64>,
    watching: bool,
    /// The tick that is followed.
    now: Option<Path>,
}

/// The followed part of a tick.
#[derive(Default)]
struct Path {
    /// The latest instruction, which has not been counted.
    at: Option<u64>,
    instructions: u32,
    cycles: u32,
    fetch: Fetch,
}

impl Follow {
    pub(super) fn new(image: &Image, setup: &Setup) -> Self {
        Self {
            ticks: setup.follow.clone(),
            code: Arc::clone(&image.control),
            watched: image.exits.iter().copied().chain([image.entry]).collect(),
            watching: false,
            now: None,
        }
    }

    fn watches(&self) -> impl Iterator<Item = Watch> {
        let others = self.code.keys().filter(|at| !self.watched.contains(at));
        others.map(|at| Watch::Instruction(*at))
    }

    /// Begins a tick. Setting watchpoints takes long, so they stay set between consecutive ticks.
    pub(super) fn enter(&mut self, tick: usize, host: &mut dyn Host) {
        let wanted = self.ticks.contains(&tick);
        self.now = wanted.then(Path::default);
        if wanted != self.watching {
            self.watching = wanted;
            for watch in self.watches() {
                if wanted {
                    host.watch(watch);
                } else {
                    host.unwatch(watch);
                }
            }
        }
    }

    /// Counts the instruction at which the processor has stopped.
    pub(super) fn pass(&mut self, address: u64) {
        let Some(path) = &mut self.now else {
            return;
        };
        path.instructions += 1;
        if let Some(at) = path.at.replace(address)
            && let Some([first, second]) = self.code.get(&at)
        {
            let next = at + if is_wide(*first) { 4 } else { 2 };
            path.cycles += cycles::of(*first, *second, address != next);
        }
        if let Some([first, _]) = self.code.get(&address) {
            path.fetch
                .instruction(address, is_wide(*first), path.cycles);
        }
    }

    /// Ends the tick with the latest instruction. Returns the cycles from the interrupt on and the fetches;
    /// `None` if some of the `instructions` of the tick were not observed.
    pub(super) fn leave(&mut self, instructions: u32) -> Option<(u32, Fetches)> {
        let path = self.now.take()?;
        let [first, second] = path.at.and_then(|at| self.code.get(&at))?;
        // Instructions after the return are part of the interrupt's cycles.
        let last = cycles::of(*first, *second, false);
        let cycles = path.cycles + last + cycles::INTERRUPT;
        (path.instructions == instructions).then(|| (cycles, path.fetch.fetches()))
    }
}
