//! Why the chip was reset, and whether its crystal runs.

use haptic_control::Stop;
use stm32f4xx_hal::pac::{FLASH, RCC};

/// Reads and clears the reset flags: what stopped the device, or nothing for a reset on purpose.
pub(super) fn cause(rcc: &RCC) -> Stop {
    let flags = rcc.csr().read();
    rcc.csr().modify(|_, w| w.rmvf().set_bit());
    let left = firmware_rt::take();
    if flags.porrstf().bit_is_set() {
        // Power came: memory holds nothing that was left on purpose.
        Stop::None
    } else if let Some(left) = left {
        left
    } else if flags.wdgrstf().bit_is_set() || flags.wwdgrstf().bit_is_set() {
        Stop::Watchdog
    } else if flags.borrstf().bit_is_set() {
        Stop::BrownOut
    } else {
        Stop::None
    }
}

/// Whether the option bytes have the chip reset below the highest of its thresholds, 2.7 V. Level 3
/// has the code 0; the names that the register's description gives these codes are wrong.
pub(super) fn by_brown_out(flash: &FLASH) -> bool {
    flash.optcr().read().bor_lev().bits() == 0
}

/// Starts the external clock, a square wave from ST-LINK; whether it runs. `wait` calls what it is
/// given until that is true or it has waited long enough, and says which. The clock stays on, so that
/// it is noticed when it comes later: see [`LateCrystal`].
pub(super) fn crystal_runs(rcc: &RCC, wait: impl FnOnce(&dyn Fn() -> bool) -> bool) -> bool {
    rcc.cr().modify(|_, w| w.hsebyp().set_bit());
    rcc.cr().modify(|_, w| w.hseon().set_bit());
    wait(&|| rcc.cr().read().hserdy().bit_is_set())
}

/// The crystal of a board that had to start without it. The outputs are off then and arming is
/// refused; once the crystal has run for [`Self::LOOKS`] looks in a row, the board starts again.
pub(super) struct LateCrystal {
    /// Looks left; none on a board that started with its crystal.
    left: Option<u8>,
}

impl LateCrystal {
    /// Looks, one a frame: 0.1 s.
    const LOOKS: u8 = 100;

    /// `runs`: whether the board started with its crystal.
    pub(super) fn new(runs: bool) -> Self {
        Self {
            left: (!runs).then_some(Self::LOOKS),
        }
    }

    /// Looks at the crystal, and restarts the board if it has run for long enough. The board comes
    /// up safe, with the clock failure as its cause, so that nothing arms by itself.
    pub(super) fn look(&mut self) {
        let Some(left) = &mut self.left else {
            return;
        };
        *left = if firmware_rt::crystal_is_ready() {
            *left - 1
        } else {
            Self::LOOKS
        };
        if *left == 0 {
            firmware_rt::restart(Stop::ClockFailure);
        }
    }
}
