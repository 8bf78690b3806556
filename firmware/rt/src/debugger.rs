//! Debugger settings that persist and decide on the outputs while the core is halted.

use cortex_m::peripheral::DCB;
use stm32f4xx_hal::pac;

use crate::emergency::EMERGENCY_OUTPUTS;

/// Vector catches, `DEMCR.VC_*`: the core halts in place of its reset or fault handler.
const CATCHES: u32 = 0x07F1;
/// `DBGMCU_APB1_FZ`: in a halt TIM2 to TIM5, the window watchdog (bit 11) and the independent
/// watchdog (bit 12) stop.
const FREEZES: u32 = 1 << 12 | 1 << 11 | 0xF;

/// Clears vector catches, lets timers and watchdogs run on while the core is halted, and has a halt
/// disable the amplifiers. A system reset changes none of these settings. Called at boot and in the
/// task of lowest priority.
pub fn undo_debugger() {
    let off_in_halt = EMERGENCY_OUTPUTS.off_in_halt;
    // SAFETY: three registers that nothing else here writes. The bits act on a halted core alone.
    unsafe {
        (*DCB::PTR).demcr.modify(|bits| bits & !CATCHES);
        (*pac::DBGMCU::ptr())
            .apb1_fz()
            .modify(|r, w| w.bits(r.bits() & !FREEZES));
        (*pac::DBGMCU::ptr())
            .apb2_fz()
            .modify(|r, w| w.bits(r.bits() | off_in_halt));
    }
}

/// Whether one of the settings is not as [`undo_debugger`] makes it.
pub fn debugger_interferes() -> bool {
    // SAFETY: three reads without side effects.
    let (catches, freezes, halts) = unsafe {
        (
            (*DCB::PTR).demcr.read(),
            (*pac::DBGMCU::ptr()).apb1_fz().read().bits(),
            (*pac::DBGMCU::ptr()).apb2_fz().read().bits(),
        )
    };
    let holds_outputs = halts & EMERGENCY_OUTPUTS.off_in_halt == 0;
    catches & CATCHES != 0 || freezes & FREEZES != 0 || holds_outputs
}
