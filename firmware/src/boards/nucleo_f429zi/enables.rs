//! The amplifiers' enables, outputs of TIM8 that switch off without the firmware.
//!
//! Both outputs are active while the bit `MOE` of the timer is set. Hardware clears `MOE`:
//!
//! * when the interlock loop at the break input opens, without a clock;
//! * when the clock security system finds that the crystal has stopped.
//!
//! A halted core has the outputs inactive (`DBG_TIM8_STOP`, set by `firmware_rt`). The outputs also
//! become inactive when the counter reaches [`LAPSE`], because the control task has not restarted
//! it: for a core that hangs without being halted.

use drivers::Enables;
use firmware_app::config::RATE_HZ;
use stm32f4xx_hal::gpio::{Input, PA6, PC8, PC9, Pull};
use stm32f4xx_hal::pac::TIM8;
use stm32f4xx_hal::rcc::{Enable, Rcc, Reset};

use super::parts::CORE_HZ;

/// Number of the timer, for the exception handlers.
pub(super) const TIMER: u8 = 8;

/// Counts per second. The timer is clocked like the core.
const COUNTS_HZ: u32 = 1_000_000;
/// Control periods after which the outputs become inactive unless the control task restarts the
/// counter. The firmware itself stops after 4 missed ticks.
const PERIODS: u32 = 16;
/// The same time in counts.
const LAPSE: u16 = {
    let counts = PERIODS * (COUNTS_HZ / RATE_HZ);
    assert!(counts <= u16::MAX as u32, "the counter has 16 bits");
    counts as u16
};

/// The enables of both amplifiers.
pub(super) struct Outputs(TIM8);

impl Outputs {
    /// Takes the timer, with both outputs inactive. The pins are not connected yet.
    pub(super) fn new(timer: TIM8, rcc: &mut Rcc) -> Self {
        TIM8::enable(rcc);
        TIM8::reset(rcc);
        // The first write to `BDTR` after the reset locks what it sets.
        firmware_rt::outputs_safe();
        timer
            .psc()
            .write(|w| w.psc().set((CORE_HZ / COUNTS_HZ - 1) as u16));
        timer.arr().write(|w| w.arr().set(u16::MAX));
        timer.ccr3().write(|w| w.ccr().set(LAPSE));
        timer.ccr4().write(|w| w.ccr().set(LAPSE));
        timer.ccer().write(|w| w.cc3e().set_bit().cc4e().set_bit());
        // The prescaler takes effect at an update.
        timer.egr().write(|w| w.ug().set_bit());
        timer.cr1().write(|w| w.cen().set_bit());
        Self(timer)
    }

    /// Connects the pins: the enables of the large and of the small amplifier, and the interlock
    /// loop. The loop is high while it is closed. A broken wire leaves it to the pull-down.
    pub(super) fn connect(large: PC8<Input>, small: PC9<Input>, interlock: PA6<Input>) {
        let _ = (
            large.into_alternate::<3>(),
            small.into_alternate::<3>(),
            interlock
                .into_alternate::<3>()
                .internal_resistor(Pull::Down),
        );
    }

    /// Whether the interlock loop is open, or was open since the amplifiers were last disabled. The
    /// stop of the crystal shows here too.
    pub(super) fn interlock_was_open(&self) -> bool {
        self.0.sr().read().bif().bit_is_set()
    }
}

impl Enables for Outputs {
    fn enable(&mut self) {
        self.renew();
        let modes = self.0.ccmr2_output();
        modes.write(|w| w.oc3m().force_active().oc4m().force_active());
        modes.write(|w| w.oc3m().inactive_on_match().oc4m().inactive_on_match());
        // An open loop holds the bit clear.
        self.0.bdtr().modify(|_, w| w.moe().set_bit());
    }

    fn renew(&mut self) {
        self.0.cnt().reset();
    }

    fn disable(&mut self) {
        self.0.bdtr().modify(|_, w| w.moe().clear_bit());
        // An open loop sets the flag again.
        self.0.sr().reset();
    }
}
