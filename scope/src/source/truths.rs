//! The tick of the emulated board that a telemetry frame tells of.

use std::collections::VecDeque;

use drivers::link::Frame;
use virtual_board::run::ControlTick;

/// Ticks that are kept: a frame comes later than its tick by much less.
const KEPT: usize = 400;
/// Numbers that the first tick after a start may have in telemetry.
const FIRSTS: u32 = 4;

/// The latest ticks since the board has started.
#[derive(Default)]
pub(super) struct Truths {
    ticks: VecDeque<ControlTick>,
    /// Number of ticks before those.
    gone: u32,
    /// Number of the first tick in telemetry that frames have ruled out so far, from 0.
    first: u32,
}

impl Truths {
    /// Takes the ticks since the last look.
    pub(super) fn add(&mut self, ticks: &[ControlTick]) {
        self.ticks.extend(ticks);
        while self.ticks.len() > KEPT {
            self.ticks.pop_front();
            self.gone += 1;
        }
    }

    /// The ticks of a frame, from `before` ticks before it to its own; `None` if its counts are not
    /// those of the frame.
    pub(super) fn of(&mut self, frame: &Frame, before: usize) -> Option<(ControlTick, u32)> {
        let counts = [
            Some(frame.counts_large as u16),
            Some(frame.counts_small as u16),
        ];
        let at = (self.first..FIRSTS).find_map(|first| {
            let index = frame.tick.checked_sub(first)?.checked_sub(self.gone)? as usize;
            let tick = self.ticks.get(index)?;
            (tick.counts == counts).then_some((first, index))
        });
        let (first, index) = at?;
        self.first = first;
        let ticks = self.ticks.range(index.saturating_sub(before)..=index);
        let most = ticks.map(|tick| tick.instructions).max().unwrap_or(0);
        Some((self.ticks[index], most))
    }
}
