//! Quadrature encoders on hardware timers.

use estimator_core::Count;
use stm32f4xx_hal::pac;

/// A timer in quadrature mode, of which the low 16 bits are enough.
pub(super) trait Counter {
    /// The counter as it stands.
    fn raw(&self) -> u16;
    /// Filters both inputs: a level counts when it has stood for 95 ns.
    fn filter(&self);
}

/// Timers with the setting of their filter, which is of 8 samples: at 84 MHz each of them, at
/// 168 MHz every other one.
macro_rules! counter {
    ($($timer:ty: $filter:ident),+) => {$(
        impl Counter for $timer {
            fn raw(&self) -> u16 {
                self.cnt().read().cnt().bits() as u16
            }

            fn filter(&self) {
                self.ccmr1_input()
                    .modify(|_, w| w.ic1f().$filter().ic2f().$filter());
            }
        }
    )+};
}

counter!(pac::TIM1: fdts_div2_n8, pac::TIM3: fck_int_n8, pac::TIM4: fck_int_n8);

/// An encoder: its counter widened to 32 bits, right as long as it is read before it has moved
/// by 2^15 counts.
pub(super) struct Encoder<T> {
    pub(super) timer: T,
    /// The count as read last.
    pub(super) count: Count,
}

impl<T: Counter> Encoder<T> {
    /// The encoder on a timer that already counts.
    pub(super) fn new(timer: T) -> Self {
        timer.filter();
        let count = Count(u32::from(timer.raw()));
        Self { timer, count }
    }

    /// The count now.
    pub(super) fn read(&mut self) -> Count {
        self.take(self.timer.raw())
    }

    /// The count of a capture that is at most 2^15 counts away from the count as read last.
    pub(super) fn captured(&self, raw: u16) -> Count {
        self.count.extended(raw)
    }

    /// The count that `raw` stands for, read from the timer just now.
    pub(super) fn take(&mut self, raw: u16) -> Count {
        self.count = self.count.extended(raw);
        self.count
    }
}
