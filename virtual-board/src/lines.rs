//! The encoders' lines on the timers' pins.

use rigless::device::Level;
use rigless::soc::stm32f427::peripherals::tim::Channel;
use rigless::time::VirtualNanos;

use crate::board::Part;
use crate::pins::{self, Wire};
use crate::quadrature::{LARGE, SMALL, levels};

/// A timer that two lines go to: its number in the emulator's list TIM2, TIM3, TIM4, TIM5, its
/// pins, and the encoder that is on them.
struct Port(usize, &'static [Wire; 2], usize);

const PORTS: [Port; 3] = [
    Port(2, &pins::LARGE, LARGE),
    Port(1, &pins::SMALL, SMALL),
    Port(0, &pins::CAPTURE, LARGE),
];

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
    driven: [[Option<bool>; 2]; PORTS.len()],
    wired: [bool; PORTS.len()],
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
        self.wired = Default::default();
    }

    /// Looks whether the pins are the timers', and drives them if so.
    pub(crate) fn look(&mut self, part: &mut Part, at: VirtualNanos) {
        for (n, Port(_, wires, encoder)) in PORTS.iter().enumerate() {
            self.wired[n] = pins::wired(part, *wires);
            self.drive(part, at, *encoder);
        }
    }

    /// Puts the levels of the encoder's count on its pins.
    pub(crate) fn drive(&mut self, part: &mut Part, at: VirtualNanos, encoder: usize) {
        let wanted = self.wanted(encoder);
        for (n, &Port(timer, _, on_it)) in PORTS.iter().enumerate() {
            if !self.wired[n] || on_it != encoder {
                continue;
            }
            for (line, level) in wanted.into_iter().enumerate() {
                if self.driven[n][line].replace(level) == Some(level) {
                    continue;
                }
                let channel = Channel::new(line as u8 + 1).expect("channels 1 and 2");
                part.stm32
                    .drive_timer(at, timer, |timer, registers, context| {
                        timer.drive_input(channel, Level::from(level), registers, context);
                    });
            }
        }
    }

    /// Levels that the encoder's lines should have, with what has happened to them.
    fn wanted(&self, encoder: usize) -> [bool; 2] {
        let mut wanted = levels(self.counts[encoder]);
        if encoder == LARGE {
            if self.swapped {
                wanted.swap(0, 1);
            }
            for (level, stuck) in wanted.iter_mut().zip(self.stuck) {
                *level = stuck.unwrap_or(*level);
            }
        }
        wanted
    }
}
