//! Follows selected calls of the control task instruction by instruction: watchpoints at the starts of straight
//! pieces of code tell the path.

use std::collections::BTreeSet;
use std::sync::Arc;

use rigless::emulator::{Host, Watch};

use crate::cycles;
use crate::fetch::Fetches;
use crate::image::Image;
use crate::pieces::{Path, Pieces};
use crate::run::Setup;

pub(super) struct Follow {
    /// Ticks to follow.
    ticks: BTreeSet<usize>,
    /// What the control task reaches.
    code: Arc<Pieces>,
    /// Starts of pieces whose watchpoints are always set.
    watched: BTreeSet<u64>,
    watching: bool,
    /// The tick that is followed.
    now: Option<Path>,
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
        let others = self.code.starts().difference(&self.watched);
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

    /// The processor has stopped at an address.
    pub(super) fn pass(&mut self, address: u64) {
        let Self { now, code, .. } = self;
        if let Some(path) = now.as_mut().filter(|_| code.starts().contains(&address)) {
            path.reach(code, address);
        }
    }

    /// Ends the tick with the instruction of the latest stop. Returns the cycles from the interrupt on and the
    /// fetches; `None` if some of the `instructions` of the tick were not observed.
    pub(super) fn leave(&mut self, instructions: u32) -> Option<(u32, Fetches)> {
        let mut path = self.now.take()?;
        path.end(&self.code);
        // Instructions after the return are part of the interrupt's cycles.
        let cycles = path.cycles() + cycles::INTERRUPT;
        (path.instructions() == instructions).then(|| (cycles, path.fetches()))
    }
}
