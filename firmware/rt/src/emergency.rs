//! Panics and exceptions: outputs off, then the cause stored for after the reset, then the log.

use core::panic::PanicInfo;

use cortex_m::peripheral::SCB;
use cortex_m_rt::{ExceptionFrame, exception};
use haptic_control::Stop;
use stm32f4xx_hal::pac;

use crate::{reset_cause, rtt};

/// The timer whose outputs enable the amplifiers. A board states it with
/// [`emergency_outputs!`](crate::emergency_outputs): as a constant in flash, because memory may be
/// corrupt when it is needed.
pub struct EmergencyOutputs {
    /// Address of the timer's BDTR.
    bdtr: usize,
    /// The bit in DBGMCU_APB2_FZ that disables the timer's outputs in a halt.
    pub(crate) off_in_halt: u32,
}

impl EmergencyOutputs {
    /// The outputs of TIM1 or TIM8.
    ///
    /// # Panics
    /// If the timer is another one: in a constant, the build stops.
    #[must_use]
    pub const fn new(timer: u8) -> Self {
        // BDTR is at 0x44 of each.
        match timer {
            1 => Self {
                bdtr: 0x4001_0044,
                off_in_halt: 1 << 0,
            },
            8 => Self {
                bdtr: 0x4001_0444,
                off_in_halt: 1 << 1,
            },
            _ => panic!("the timers with a break input are TIM1 and TIM8"),
        }
    }
}

/// States the timer whose outputs enable the amplifiers, as `timer: 8`; once in an image.
#[macro_export]
macro_rules! emergency_outputs {
    (timer: $timer:expr) => {
        // SAFETY: the name is the one that this crate declares, with its type.
        #[unsafe(no_mangle)]
        static EMERGENCY_OUTPUTS: $crate::EmergencyOutputs = $crate::EmergencyOutputs::new($timer);
    };
}

// SAFETY: `emergency_outputs!` defines it with this type; without that the image does not link.
unsafe extern "Rust" {
    pub(crate) safe static EMERGENCY_OUTPUTS: EmergencyOutputs;
}

/// Word for BDTR that makes the outputs inactive: `MOE` clear; inactive outputs are driven (`OSSI`)
/// to their idle level, low; the break input is enabled (`BKE`) and active low (`BKP` clear), so
/// that a broken wire is a break; only software enables the outputs (`AOE` clear). `LOCK` level 2
/// makes the first write after a reset final, except for `MOE`.
const OUTPUTS_OFF: u32 = BKE | OSSI | LOCK_LEVEL_2;
const BKE: u32 = 1 << 12;
const OSSI: u32 = 1 << 10;
const LOCK_LEVEL_2: u32 = 0b10 << 8;

/// Both DAC channels at mid-scale, as DAC_DHR12RD takes them: no current on a board that is not calibrated. A
/// calibrated zero is in memory, which may be corrupt here; with the farthest one that the settings admit, 200
/// codes at a gain of 1.25, this commands 0.74 A and 0.19 A to amplifiers that are disabled.
const MID_SCALE: u32 = 2048 << 16 | 2048;

/// Disables both amplifiers and commands mid-scale, from any context.
pub fn outputs_safe() {
    // SAFETY: two stores of constants, of which BDTR's address is that of a timer by construction.
    // They have no side effects but the outputs and need no lock, because both registers are written
    // whole, and every caller interrupts for good whatever else writes there. Before their clocks
    // run, they do nothing.
    unsafe {
        (EMERGENCY_OUTPUTS.bdtr as *mut u32).write_volatile(OUTPUTS_OFF);
        (*pac::DAC::ptr()).dhr12rd().write(|w| w.bits(MID_SCALE));
    }
}

/// Disables the outputs, stores the cause, logs `message` and waits for the watchdog, which runs since
/// before the clocks. A message that does not fit into the log's buffer is repeated while a probe
/// empties the buffer.
fn stop(cause: Stop, message: impl Fn()) -> ! {
    cortex_m::interrupt::disable();
    outputs_safe();
    reset_cause::store(cause);
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

/// Disables the outputs, stores the cause and restarts the chip.
pub fn restart(cause: Stop) -> ! {
    cortex_m::interrupt::disable();
    outputs_safe();
    reset_cause::store(cause);
    SCB::sys_reset()
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
