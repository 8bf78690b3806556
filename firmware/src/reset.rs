//! Why the chip was reset, and whether its crystal runs.

use haptic_control::Stop;
use stm32f4xx_hal::pac::RCC;

/// Reads and clears the reset flags: what stopped the device, or nothing for a reset on purpose.
pub(crate) fn cause(rcc: &RCC) -> Stop {
    let flags = rcc.csr().read();
    rcc.csr().modify(|_, w| w.rmvf().set_bit());
    let left = bare::take();
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

/// Looks at the crystal's ready flag so often: 10 ms or so on the internal oscillator.
const PATIENCE: u32 = 20_000;

/// Starts the external clock, a square wave from ST-LINK; whether it runs.
pub(crate) fn crystal_runs(rcc: &RCC) -> bool {
    rcc.cr().modify(|_, w| w.hsebyp().set_bit());
    rcc.cr().modify(|_, w| w.hseon().set_bit());
    let ready = (0..PATIENCE).any(|_| rcc.cr().read().hserdy().bit_is_set());
    if !ready {
        rcc.cr().modify(|_, w| w.hseon().clear_bit());
        rcc.cr().modify(|_, w| w.hsebyp().clear_bit());
    }
    ready
}
