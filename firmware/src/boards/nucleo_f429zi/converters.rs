//! What the analog-to-digital converters share.

use stm32f4xx_hal::pac::{ADC_COMMON, ADC1};
use stm32f4xx_hal::rcc::{Enable, Rcc, Reset};

/// Time for which a converter becomes stable after power-on, us. The datasheet has 3 us at most.
pub(super) const STABLE_US: u32 = 5;

/// Resets all converters, and sets their clock.
pub(super) fn prepare(common: &ADC_COMMON, rcc: &mut Rcc) {
    ADC1::enable(rcc);
    // It is the reset of all converters.
    ADC1::reset(rcc);
    // 21 MHz; the datasheet allows 36 MHz.
    common.ccr().write(|w| w.adcpre().div4());
}
