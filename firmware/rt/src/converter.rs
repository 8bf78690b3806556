//! The channel of an analog-to-digital converter.

use stm32f4xx_hal::pac::adc1::RegisterBlock;

/// Has a converter convert this channel alone.
pub fn convert_channel(converter: &RegisterBlock, channel: u8) {
    converter.sqr1().reset();
    converter.sqr3().write(|w| {
        // SAFETY: the field names one of the converter's inputs, which a conversion only reads. A
        // number without an input converts nothing of use, and the field has no other meaning.
        unsafe { w.sq1().bits(channel) }
    });
}
