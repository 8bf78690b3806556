//! The encoders' lines on the timers' pins.

use rigless::device::Level;
use rigless::soc::stm32f427::peripherals::tim::Channel;
use rigless::time::VirtualNanos;

use crate::board::Part;
use crate::pins;
use crate::quadrature::{LARGE, SMALL, levels};

/// Numbers of TIM4 (large) and TIM3 (small) in the emulator's list TIM2, TIM3, TIM4, TIM5.
const TIMERS: [usize; 2] = [2, 1];

/// The lines of both encoders as they are driven.
#[derive(Debug, Default)]
pub(crate) struct Lines {
    /// Counts that the shafts have reached.
    pub(crate) counts: [u32; 2],
    /// Levels that the large encoder's lines are stuck at.
    pub(crate) stuck: [Option<bool>; 2],
    /// Whether the large encoder's lines have changed places.
    pub(crate) swapped: bool,
    /// Levels on the pins; `None` before the first since a restart.
    driven: [[Option<bool>; 2]; 2],
    wired: [bool; 2],
}

impl Lines {
    pub(crate) fn at(counts: [u32; 2]) -> Self {
        Self {
            counts,
            ..Self::default()
        }
    }

    /// Levels of the large encoder's lines now.
    pub(crate) fn now(&self) -> [bool; 2] {
        self.driven[LARGE].map(Option::unwrap_or_default)
    }

    /// The processor has restarted: its timers know no levels.
    pub(crate) fn restart(&mut self) {
        self.driven = Default::default();
        self.wired = [false; 2];
    }

    /// Looks whether the pins are the timers', and drives them if so.
    pub(crate) fn look(&mut self, part: &mut Part, at: VirtualNanos) {
        for (encoder, wires) in [(LARGE, &pins::LARGE), (SMALL, &pins::SMALL)] {
            self.wired[encoder] = pins::wired(part, wires);
            self.drive(part, at, encoder);
        }
    }

    /// Puts the levels of the encoder's count on its pins.
    pub(crate) fn drive(&mut self, part: &mut Part, at: VirtualNanos, encoder: usize) {
        if !self.wired[encoder] {
            return;
        }
        let mut wanted = levels(self.counts[encoder]);
        if encoder == LARGE {
            if self.swapped {
                wanted.swap(0, 1);
            }
            for (level, stuck) in wanted.iter_mut().zip(self.stuck) {
                *level = stuck.unwrap_or(*level);
            }
        }
        for (line, (level, driven)) in wanted
            .into_iter()
            .zip(&mut self.driven[encoder])
            .enumerate()
        {
            if *driven == Some(level) {
                continue;
            }
            *driven = Some(level);
            let channel = Channel::new(line as u8 + 1).expect("channels 1 and 2");
            part.stm32
                .drive_timer(at, TIMERS[encoder], |timer, registers, context| {
                    timer.drive_input(channel, Level::from(level), registers, context);
                });
        }
    }
}
