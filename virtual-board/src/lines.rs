//! The encoders' lines on the timers' pins.

use rigless::device::Level;
use rigless::soc::stm32f427::peripherals::tim::Channel;
use rigless::time::VirtualNanos;

use crate::board::Part;
use crate::pins::{self, Wire};
use crate::quadrature::{Index, LARGE, REFERENCE, SMALL, levels};

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

/// Faults of the lines of an encoder.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Broken {
    /// Levels of stuck lines.
    pub(crate) stuck: [Option<bool>; 2],
    /// Whether the lines A and B are exchanged.
    pub(crate) swapped: bool,
    /// Number of edges since the fault of lost edges began; `None` without it.
    pub(crate) lossy: Option<u32>,
}

/// An index line: number of its general timer, channel, and encoder.
struct IndexPort(usize, u8, usize);

/// At the places of [`pins::INDICES`].
const INDICES: [IndexPort; 2] = [IndexPort(2, 3, LARGE), IndexPort(1, 4, SMALL)];

/// An index line as it is.
#[derive(Clone, Copy, Debug, Default)]
struct IndexLine {
    index: Index,
    wired: bool,
    /// Level on the pin; `None` until one is set after a restart.
    driven: Option<bool>,
}

/// Levels of the encoders' lines.
#[derive(Debug, Default)]
pub(crate) struct Lines {
    /// Present counts of the shafts.
    counts: [u32; 3],
    /// Faults of the encoder of the large motor and of the small one.
    pub(crate) broken: [Broken; 2],
    /// Levels on the pins; `None` until a level is set after a restart.
    driven: [[Option<bool>; 2]; PORTS.len()],
    wired: [bool; PORTS.len()],
    indices: [IndexLine; INDICES.len()],
}

impl Lines {
    /// The lines at these counts of the shafts. `turns`: counts per turn of the large and the small
    /// encoder.
    pub(crate) fn at(counts: [u32; 3], turns: [u32; 2]) -> Self {
        Self {
            counts,
            indices: [LARGE, SMALL].map(|n| IndexLine {
                index: Index::new(turns[n], counts[n]),
                ..IndexLine::default()
            }),
            ..Self::default()
        }
    }

    /// Present levels of an encoder's lines.
    pub(crate) fn now(&self, encoder: usize) -> [bool; 2] {
        self.driven[encoder].map(Option::unwrap_or_default)
    }

    /// Resets the levels after a restart of the processor, whose timers have lost them.
    pub(crate) fn restart(&mut self) {
        self.driven = Default::default();
        self.wired = Default::default();
        for line in &mut self.indices {
            (line.wired, line.driven) = (false, None);
        }
    }

    /// Finds the pins that the firmware has connected to timers, and sets their levels.
    pub(crate) fn connect(&mut self, part: &mut Part, at: VirtualNanos) {
        for (n, Port(_, wires, encoder)) in PORTS.iter().enumerate() {
            self.wired[n] = pins::wired(part, *wires);
            self.drive(part, at, *encoder);
        }
        for (n, wire) in pins::INDICES.iter().enumerate() {
            self.indices[n].wired = pins::wired(part, &[*wire]);
            self.drive_index(part, at, n);
        }
    }

    /// Whether the firmware reads the reference encoder.
    pub(crate) fn reads_reference(&self) -> bool {
        self.wired[REFERENCE]
    }

    /// Sets the lines of an encoder to the levels of `count`. A lost edge is one of A and B.
    pub(crate) fn reach(
        &mut self,
        part: &mut Part,
        at: VirtualNanos,
        (encoder, count): (usize, u32),
    ) {
        self.counts[encoder] = count;
        self.follow(part, at, encoder);
        for (n, IndexPort(.., of)) in INDICES.iter().enumerate() {
            if *of == encoder {
                self.drive_index(part, at, n);
            }
        }
    }

    /// Sets the lines A and B of an encoder to its count, unless the edge is lost.
    fn follow(&mut self, part: &mut Part, at: VirtualNanos, encoder: usize) {
        let broken = self.broken.get_mut(encoder);
        if let Some(edges) = broken.and_then(|broken| broken.lossy.as_mut()) {
            *edges = (*edges + 1) % LOSSY.0;
            if *edges >= LOSSY.0 - LOSSY.1 {
                return;
            }
        }
        self.drive(part, at, encoder);
    }

    /// Stores the count of the reference encoder while the firmware does not read it.
    pub(crate) fn pass(&mut self, count: u32) {
        self.counts[REFERENCE] = count;
    }

    /// Sets the pins of an encoder to the levels of its lines.
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

    /// Sets the pin of an index line to the level of its shaft. It follows A and B at the same instant:
    /// an input that settles at the same sample is taken after them.
    fn drive_index(&mut self, part: &mut Part, at: VirtualNanos, n: usize) {
        let IndexPort(timer, channel, encoder) = INDICES[n];
        let line = &mut self.indices[n];
        let level = line.index.level(self.counts[encoder]);
        if !line.wired || line.driven.replace(level) == Some(level) {
            return;
        }
        let channel = Channel::new(channel).expect("channels 3 and 4");
        part.stm32.drive_timer(at, timer, |timer, r, context| {
            timer.drive_input(channel, Level::from(level), r, context);
        });
    }

    /// Levels of an encoder's lines for its count, with the injected faults.
    fn wanted(&self, encoder: usize) -> [bool; 2] {
        let mut wanted = levels(self.counts[encoder]);
        if let Some(broken) = self.broken.get(encoder) {
            if broken.swapped {
                wanted.swap(0, 1);
            }
            for (level, stuck) in wanted.iter_mut().zip(broken.stuck) {
                *level = stuck.unwrap_or(*level);
            }
        }
        wanted
    }
}
