//! The control tick and its bookkeeping in core clock cycles.

use cortex_m::peripheral::DWT;
use firmware_app::config::RATE_HZ;
use stm32f4xx_hal::pac::TIM5;
use stm32f4xx_hal::timer::{CounterHz, Flag};
use stm32f4xx_hal::{ClearFlags, ReadFlags};

use crate::board::CORE_HZ;

/// Core clock cycles of a control period.
const PERIOD: u32 = CORE_HZ / RATE_HZ;

/// The control tick: a timer's update interrupt.
pub(crate) struct Tick {
    timer: CounterHz<TIM5>,
    entered: u32,
    late: bool,
    cycles: u32,
}

impl Tick {
    /// The tick of a timer that runs since now.
    pub(crate) fn new(timer: CounterHz<TIM5>) -> Self {
        Self {
            timer,
            entered: DWT::cycle_count(),
            late: false,
            cycles: 0,
        }
    }

    /// First thing in the control task: takes the interrupt; the ticks missed since the last,
    /// counting one that the last task overran.
    pub(crate) fn enter(&mut self) -> u32 {
        self.timer.clear_flags(Flag::Update);
        let now = DWT::cycle_count();
        let periods = now.wrapping_sub(self.entered).saturating_add(PERIOD / 2) / PERIOD;
        self.entered = now;
        periods.saturating_sub(1).max(u32::from(self.late))
    }

    /// Last thing in the control task.
    pub(crate) fn leave(&mut self) {
        self.late = self.timer.flags().contains(Flag::Update);
        self.cycles = DWT::cycle_count().wrapping_sub(self.entered);
    }

    /// Cycles that the last control task took.
    pub(crate) fn cycles(&self) -> u32 {
        self.cycles
    }
}
