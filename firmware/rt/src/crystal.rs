//! The crystal of a board that runs without it.

use stm32f4xx_hal::pac;

/// Whether the external clock runs, which was switched on at boot. For the task of lowest priority:
/// the clock tree belongs to the control task.
pub fn crystal_is_ready() -> bool {
    // SAFETY: a read without side effects.
    let cr = unsafe { (*pac::RCC::ptr()).cr().read() };
    cr.hserdy().bit_is_set()
}
