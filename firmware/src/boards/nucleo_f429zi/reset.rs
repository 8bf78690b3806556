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
/// given until that is true or it has waited long enough, and says which.
pub(super) fn crystal_runs(rcc: &RCC, wait: impl FnOnce(&dyn Fn() -> bool) -> bool) -> bool {
    rcc.cr().modify(|_, w| w.hsebyp().set_bit());
    rcc.cr().modify(|_, w| w.hseon().set_bit());
    let ready = wait(&|| rcc.cr().read().hserdy().bit_is_set());
    if !ready {
        rcc.cr().modify(|_, w| w.hseon().clear_bit());
        rcc.cr().modify(|_, w| w.hsebyp().clear_bit());
    }
    ready
}
