//! The instant of the large encoder's latest edge, captured in hardware.
//!
//! A and B go to channels 1 and 2 of TIM2 as well. Its XOR input makes one signal of them, which
//! changes at every count, and both edges of that are captured: one register holds the instant of
//! the latest count, whichever line moved. No interrupt is taken, so edges cost nothing.

use estimator_core::{ClockTicks, Count, Edge, Skip};
use stm32f4xx_hal::gpio::{Debugger, PA15, PB3};
use stm32f4xx_hal::pac::{TIM2, TIM4};
use stm32f4xx_hal::rcc::{Enable, Rcc, Reset};

use super::encoder::{Counter as _, Encoder};

/// Readings of counter and capture that may disagree before the stamp of this tick is given up.
/// One takes some 150 ns: at the filter's limit of 10 MHz of edges none would agree.
const READINGS: u32 = 4;

/// Ticks of the capture clock that both input filters take alike: 8 samples agree.
const FILTER: u32 = 8;

/// Least age of a capture that is taken, ticks of the clock: the two timers may see an edge some ticks
/// apart, and the last reading of the counter is up to 8 ticks old.
const SETTLED: u32 = 16;

/// The pins of channels 1 and 2; the debug port's after a reset.
pub(super) type Pins = (PA15<Debugger>, PB3<Debugger>);

/// Stamps the edges of the large encoder: [`Capture`], or no stamps.
pub(super) trait Stamps: Sized {
    /// Takes timer and pins.
    fn new(timer: TIM2, pins: Pins, rcc: &mut Rcc) -> Self;

    /// The count now, and its latest edge.
    fn read(&mut self, encoder: &mut Encoder<TIM4>) -> (Count, Option<Edge>);
}

/// The image's source of stamps.
#[cfg(feature = "edge-capture")]
pub(super) type Source = Capture;
#[cfg(not(feature = "edge-capture"))]
pub(super) type Source = Skip;

/// A board without the wires: no code.
impl Stamps for Skip {
    fn new(_: TIM2, _: Pins, _: &mut Rcc) -> Self {
        Self
    }

    fn read(&mut self, encoder: &mut Encoder<TIM4>) -> (Count, Option<Edge>) {
        (encoder.read(), None)
    }
}

/// TIM2 as a clock of `TIMER_HZ`, 32 bits wide, that both edges of A xor B capture.
pub(super) struct Capture {
    timer: TIM2,
    /// The clock at the last reading.
    now: u32,
    /// The captured value.
    instant: u32,
    latest: Option<Edge>,
}

/// Counter and capture, read one after the other.
#[derive(Clone, Copy, PartialEq)]
struct Reading {
    raw: u16,
    downwards: bool,
    instant: u32,
}

impl Stamps for Capture {
    fn new(timer: TIM2, (a, b): Pins, rcc: &mut Rcc) -> Self {
        let _ = (
            a.into_input().into_alternate::<1>(),
            b.into_input().into_alternate::<1>(),
        );
        TIM2::enable(rcc);
        TIM2::reset(rcc);
        timer.cr2().write(|w| w.ti1s().xor());
        // The same filter as the encoder's, so that count and capture keep together.
        timer
            .ccmr1_input()
            .write(|w| w.cc1s().ti1().ic1f().fck_int_n8());
        timer
            .ccer()
            .write(|w| w.cc1p().set_bit().cc1np().set_bit().cc1e().set_bit());
        timer.arr().write(|w| w.arr().set(u32::MAX));
        timer.cr1().write(|w| w.cen().set_bit());
        Self {
            timer,
            now: 0,
            instant: 0,
            latest: None,
        }
    }

    fn read(&mut self, encoder: &mut Encoder<TIM4>) -> (Count, Option<Edge>) {
        // Reading the capture clears the flag: look at it first.
        let flagged = self.timer.sr().read().cc1if().bit_is_set();
        let mut reading = self.reading(encoder);
        let mut now = 0;
        let mut agreed = false;
        for _ in 1..READINGS {
            let again = self.reading(encoder);
            now = self.timer.cnt().read().bits();
            agreed = again == reading && now.wrapping_sub(again.instant) >= SETTLED;
            reading = again;
            if agreed {
                break;
            }
        }
        let passed = now.wrapping_sub(self.now);
        self.now = now;
        let before = encoder.count;
        let count = encoder.take(reading.raw);
        let fresh = flagged || reading.instant != self.instant;
        self.instant = reading.instant;
        self.latest = match (agreed, fresh) {
            (true, true) => Some(Edge {
                boundary: Count(count.0.wrapping_add(u32::from(reading.downwards))),
                age: ClockTicks(now.wrapping_sub(reading.instant).saturating_add(FILTER)),
            }),
            // Nothing since: the edge of before is a period older.
            (true, false) if count == before => self.latest.map(|edge| Edge {
                age: ClockTicks(edge.age.0.saturating_add(passed)),
                ..edge
            }),
            // Count and capture are of different edges.
            _ => None,
        };
        (count, self.latest)
    }
}

impl Capture {
    fn reading(&self, encoder: &Encoder<TIM4>) -> Reading {
        Reading {
            raw: encoder.timer.raw(),
            downwards: encoder.timer.cr1().read().dir().is_down(),
            instant: self.timer.ccr1().read().bits(),
        }
    }
}
