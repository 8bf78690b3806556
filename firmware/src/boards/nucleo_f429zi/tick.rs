//! The control tick and its bookkeeping, on one timer that counts for ever.
//!
//! The timer counts on while a debugger holds the core, so that the first tick after a halt knows
//! how many it missed. The core's cycle counter stops then.

use firmware_app::config::{RATE_HZ, TIMER_HZ};
use haptic_control::Grid;
use stm32f4xx_hal::pac::TIM5;
use stm32f4xx_hal::rcc::{Enable, Rcc, Reset};

use super::parts::CORE_HZ;

/// Counts of a control period.
const PERIOD: u32 = TIMER_HZ / RATE_HZ;

/// Times that a poll may ask in a count. One pass takes several counts on the chip; on the emulated board
/// the core is ten times as fast as the timer until the clocks are set up, and a pass takes half a count.
const PER_COUNT: u32 = 4;

/// A timer that counts from 0 to 2^32 - 1 and starts again, at the rate of its bus.
pub(super) struct Clock(TIM5);

impl Clock {
    /// Starts it.
    pub(super) fn start(timer: TIM5, rcc: &mut Rcc) -> Self {
        TIM5::enable(rcc);
        TIM5::reset(rcc);
        timer.arr().write(|w| w.arr().set(u32::MAX));
        timer.cr1().write(|w| w.cen().set_bit());
        Self(timer)
    }

    /// Asks `done` until it is true, at most for so many counts; whether it was. Without a running
    /// clock it gives up by the number of times, [`PER_COUNT`] for a count.
    pub(super) fn poll(&self, counts: u32, mut done: impl FnMut() -> bool) -> bool {
        let since = self.now();
        for _ in 0..counts.saturating_mul(PER_COUNT) {
            if done() {
                return true;
            }
            if self.now().wrapping_sub(since) >= counts {
                break;
            }
        }
        false
    }

    /// The count now.
    pub(super) fn now(&self) -> u32 {
        self.0.cnt().read().bits()
    }
}

/// The control tick: the interrupt of a comparison with the clock.
pub(super) struct Tick {
    clock: Clock,
    grid: Grid<PERIOD>,
}

impl Tick {
    /// Ticks from a period after now.
    pub(super) fn new(clock: Clock) -> Self {
        let grid = Grid::new(clock.now());
        clock.0.sr().reset();
        clock.0.dier().write(|w| w.cc1ie().set_bit());
        let tick = Self { clock, grid };
        tick.await_next();
        tick
    }

    /// First thing in the control task: takes the interrupt; the ticks missed since the last,
    /// counting one that the last task overran.
    pub(super) fn enter(&mut self) -> u32 {
        self.clock.0.sr().reset();
        let missed = self.grid.begin(self.clock.now());
        self.await_next();
        missed
    }

    /// Last thing in the control task.
    pub(super) fn leave(&mut self) {
        if self.grid.end(self.clock.now()) {
            // A comparison with a count that had passed before it was set, as after a halt of the core at
            // the begin of the task, would come after a turn of the counter.
            self.clock.0.egr().write(|w| w.cc1g().set_bit());
        }
    }

    /// Core cycles of the longest control task since this was last asked for, from the instant at
    /// which it was due.
    pub(super) fn take_longest(&mut self) -> u32 {
        self.grid.take_longest() * (CORE_HZ / TIMER_HZ)
    }

    /// Has the clock interrupt at the next tick.
    fn await_next(&self) {
        self.clock.0.ccr1().write(|w| w.ccr().set(self.grid.due()));
    }
}
