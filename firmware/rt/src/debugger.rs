//! Debugger settings that persist and keep the outputs while the core is halted.

use cortex_m::peripheral::DCB;
use stm32f4xx_hal::pac;

/// Vector catches, `DEMCR.VC_*`: the core halts in place of its reset or fault handler.
const CATCHES: u32 = 0x07F1;
/// `DBGMCU_APB1_FZ`: in a halt TIM2 to TIM5, the window watchdog (bit 11) and the independent
/// watchdog (bit 12) stop.
const FREEZES: u32 = 1 << 12 | 1 << 11 | 0xF;

/// Clears vector catches, and lets timers and watchdogs run on while the core is halted. Neither
/// ends by a system reset. Called at boot and in the task of lowest priority.
pub fn undo_debugger() {
    // SAFETY: two registers that nothing else here writes. The bits act on a halted core alone.
    unsafe {
        (*DCB::PTR).demcr.modify(|bits| bits & !CATCHES);
        (*pac::DBGMCU::ptr())
            .apb1_fz()
            .modify(|r, w| w.bits(r.bits() & !FREEZES));
    }
}

/// Whether one of the bits is set that [`undo_debugger`] clears.
pub fn debugger_interferes() -> bool {
    // SAFETY: two reads without side effects.
    let (catches, freezes) = unsafe {
        (
            (*DCB::PTR).demcr.read(),
            (*pac::DBGMCU::ptr()).apb1_fz().read().bits(),
        )
    };
    catches & CATCHES != 0 || freezes & FREEZES != 0
}
