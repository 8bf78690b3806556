//! What happens when nothing else can be trusted: outputs first, then a word for after the reset,
//! then the log.

use core::panic::PanicInfo;

use cortex_m::peripheral::SCB;
use cortex_m_rt::{ExceptionFrame, exception};
use haptic_control::Stop;
use stm32f4xx_hal::pac;

use crate::{last_words, rtt};

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

/// Disables the outputs, leaves the cause, says `message` and waits for the watchdog, which runs
/// from before the clocks. A message that finds no place in the log's buffer is said again while a
/// probe makes place.
fn stop(cause: Stop, message: impl Fn()) -> ! {
    cortex_m::interrupt::disable();
    outputs_safe();
    last_words::leave(cause);
    rtt::take_over();
    loop {
        let lost = rtt::lost();
        message();
        if rtt::lost() == lost {
            break;
        }
    }
    #[allow(clippy::empty_loop, reason = "nothing is left to do")]
    loop {}
}

#[panic_handler]
fn panic(info: &PanicInfo) -> ! {
    stop(Stop::Panic, || {
        defmt::error!("{}", defmt::Display2Format(info));
    })
}

// SAFETY: the signature is that of the vector; nothing of the program is touched but the outputs.
#[exception]
unsafe fn HardFault(frame: &ExceptionFrame) -> ! {
    stop(Stop::HardFault, || {
        // SAFETY: reads without side effects.
        let (cfsr, hfsr, mmfar, bfar) = unsafe {
            let scb = &*SCB::PTR;
            (
                scb.cfsr.read(),
                scb.hfsr.read(),
                scb.mmfar.read(),
                scb.bfar.read(),
            )
        };
        defmt::error!(
            "hard fault at {=u32:#x} lr={=u32:#x} cfsr={=u32:#x} hfsr={=u32:#x} mmfar={=u32:#x} bfar={=u32:#x}",
            frame.pc(),
            frame.lr(),
            cfsr,
            hfsr,
            mmfar,
            bfar
        );
    })
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
    stop(Stop::ClockFailure, || defmt::error!("clock failure"))
}

// SAFETY: as above. Nothing enables another interrupt or exception, so whatever comes here is an
// error of the chip or of the program.
#[exception]
unsafe fn DefaultHandler(interrupt: i16) {
    stop(Stop::Exception, || {
        defmt::error!("exception {=i16}", interrupt);
    })
}
