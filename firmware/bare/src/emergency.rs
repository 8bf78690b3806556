//! What happens when nothing else can be trusted: outputs first, then a word for after the reset.

use core::panic::PanicInfo;

use cortex_m::asm;
use cortex_m_rt::{ExceptionFrame, exception};
use haptic_control::Stop;
use stm32f4xx_hal::pac;

use crate::last_words;

/// PE4 and PE5, the amplifiers' enables, as GPIOE_BSRR resets them.
const ENABLES_LOW: u32 = 1 << (16 + 4) | 1 << (16 + 5);
/// Both DAC channels at mid-scale, as DAC_DHR12RD takes them: no current.
const MID_SCALE: u32 = 2048 << 16 | 2048;

/// Disables both amplifiers and commands no current, from any context.
pub fn outputs_safe() {
    // SAFETY: two stores of constants to write-only registers. They have no side effects but the
    // outputs, need no lock, because BSRR and DHR12RD are written whole, and whoever else writes
    // there is interrupted for good by every caller. Before their clocks run, they do nothing.
    unsafe {
        (*pac::GPIOE::ptr()).bsrr().write(|w| w.bits(ENABLES_LOW));
        (*pac::DAC::ptr()).dhr12rd().write(|w| w.bits(MID_SCALE));
    }
}

/// Leaves the cause and waits for the watchdog, which has been running since before the clocks:
/// meanwhile a probe can drain the log.
fn stop(cause: Stop) -> ! {
    last_words::leave(cause);
    loop {
        asm::nop();
    }
}

#[panic_handler]
fn panic(info: &PanicInfo) -> ! {
    cortex_m::interrupt::disable();
    outputs_safe();
    defmt::error!("{}", defmt::Display2Format(info));
    stop(Stop::Panic)
}

// SAFETY: the signature is that of the vector; nothing of the program is touched but the outputs.
#[exception]
unsafe fn HardFault(frame: &ExceptionFrame) -> ! {
    outputs_safe();
    defmt::error!("hard fault at {=u32:#x}", frame.pc());
    stop(Stop::HardFault)
}

// SAFETY: as above. The only source is the clock security system: the crystal stopped, and the
// core runs on the internal oscillator.
#[exception]
unsafe fn NonMaskableInt() {
    outputs_safe();
    // SAFETY: sets the one bit that acknowledges; nobody else writes RCC_CIR.
    unsafe {
        (*pac::RCC::ptr()).cir().modify(|_, w| w.cssc().clear());
    }
    defmt::error!("clock failure");
    stop(Stop::ClockFailure)
}
