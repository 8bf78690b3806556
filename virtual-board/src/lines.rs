//! The encoders' lines on the timers' pins.

use rigless::device::Level;
use rigless::soc::stm32f427::peripherals::tim::Channel;
use rigless::time::VirtualNanos;

use crate::board::Part;
use crate::pins::{self, Wire};
use crate::quadrature::{LARGE, REFERENCE, SMALL, levels};

/// Number of edges of which the last ones are lost, and number of lost edges.
const LOSSY: (u32, u32) = (64, 4);

/// A timer by its number in the emulator's lists: TIM2, TIM3, TIM4, TIM5, and TIM1, TIM8.
#[derive(Clone, Copy, Debug)]
enum Timer {
    General(usize),
    Advanced(usize),
}

/// A timer with two input pins, and the encoder on these pins.
struct Port(Timer, &'static [Wire; 2], usize);

const PORTS: [Port; 4] = [
    Port(Timer::General(2), &pins::LARGE, LARGE),
    Port(Timer::General(1), &pins::SMALL, SMALL),
    Port(Timer::Advanced(0), &pins::REFERENCE, REFERENCE),
    Port(Timer::General(0), &pins::CAPTURE, LARGE),
];

/// The lines of the encoders as they are driven.
#[derive(Debug, Default)]
pub(crate) struct Lines {
    /// Present counts of the shafts.
    counts: [u32; 3],
    /// Levels of stuck lines of the large encoder.
    pub(crate) stuck: [Option<bool>; 2],
    /// Whether the large encoder's lines have changed places.
    pub(crate) swapped: bool,
    /// Edges of the large encoder since some of them are lost.
    pub(crate) lossy: Option<u32>,
    /// Levels on the pins; `None` before the first since a restart.
    driven: [[Option<bool>; 2]; PORTS.len()],
    wired: [bool; PORTS.len()],
}

impl Lines {
    pub(crate) fn at(counts: [u32; 3]) -> Self {
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

    /// Whether somebody reads the reference encoder.
    pub(crate) fn reads_reference(&self) -> bool {
        self.wired[REFERENCE]
    }

    /// The encoder has reached `count`: its lines follow, unless the edge is lost.
    pub(crate) fn reach(
        &mut self,
        part: &mut Part,
        at: VirtualNanos,
        (encoder, count): (usize, u32),
    ) {
        self.counts[encoder] = count;
        if let (LARGE, Some(edges)) = (encoder, &mut self.lossy) {
            *edges = (*edges + 1) % LOSSY.0;
            if *edges >= LOSSY.0 - LOSSY.1 {
                return;
            }
        }
        self.drive(part, at, encoder);
    }

    /// The reference encoder's count, kept up with while nobody reads it.
    pub(crate) fn pass(&mut self, count: u32) {
        self.counts[REFERENCE] = count;
    }

    /// Puts the levels of the encoder's count on its pins.
    fn drive(&mut self, part: &mut Part, at: VirtualNanos, encoder: usize) {
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
                let level = Level::from(level);
                match timer {
                    Timer::General(nth) => part.stm32.drive_timer(at, nth, |timer, r, context| {
                        timer.drive_input(channel, level, r, context);
                    }),
                    Timer::Advanced(nth) => {
                        part.stm32
                            .drive_advanced_timer(at, nth, |timer, r, context| {
                                timer.drive_input(channel, level, r, context);
                            });
                    }
                }
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
