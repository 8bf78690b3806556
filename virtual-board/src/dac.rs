//! Model of the two-channel DAC.

use rigless::device::{Device, DeviceContext, RegisterFile};
use rigless::soc::stm32f427::generated::dac::Register;

/// The converter without waveforms and DMA, which the firmware does not use, and with triggers that never
/// come. A code written to a holding register is at once on the pin if its channel is enabled and waits for
/// no trigger. With its buffer, a pin reaches from 0.2 V to 3.1 V (data sheet of the STM32F427 and F429).
#[derive(Debug, Default)]
pub struct Dac;

/// `EN`, `BOFF` and `TEN` of the first channel in `CR`, and the place of those of each channel.
const ENABLE: u64 = 1;
const UNBUFFERED: u64 = 1 << 1;
const TRIGGERED: u64 = 1 << 2;
const CHANNELS: [u32; 2] = [0, 16];

/// Codes of 0.2 V and 3.1 V at a supply of 3.3 V, 248.2 and 3847.8.
const BUFFERED: [u16; 2] = [249, 3847];

/// Resistance of an output without its buffer, ohm: the largest of the data sheet, table "DAC
/// characteristics".
const UNBUFFERED_OHM: f64 = 15e3;

/// The smallest load for which the data sheet states the range of a buffered output, ohm.
pub const LEAST_LOAD_OHM: f64 = 5e3;

impl Dac {
    /// Levels on PA4 and PA5 with loads to ground of at least 5 kOhm, as codes. A buffered output keeps its
    /// level; one without its buffer divides it.
    #[must_use]
    pub(crate) fn levels(registers: &RegisterFile, load_ohm: [f64; 2]) -> [Option<f64>; 2] {
        let control = registers.get(Register::Cr);
        let codes = Self::codes(registers);
        [0, 1].map(|n| {
            let is_buffered = (control >> CHANNELS[n]) & UNBUFFERED == 0;
            let divided = load_ohm[n] / (load_ohm[n] + UNBUFFERED_OHM);
            let kept = if is_buffered { 1.0 } else { divided };
            codes[n].map(|code| f64::from(code) * kept)
        })
    }

    /// Codes that the levels on PA4 and PA5 are those of; `None` if the channel is off and the pin floats.
    #[must_use]
    pub fn codes(registers: &RegisterFile) -> [Option<u16>; 2] {
        let control = registers.get(Register::Cr);
        let outputs = [Register::Dor1, Register::Dor2].map(|dor| registers.get(dor) as u16);
        [0, 1].map(|n| {
            let own = control >> CHANNELS[n];
            let [low, high] = BUFFERED;
            let level = if own & UNBUFFERED == 0 {
                outputs[n].clamp(low, high)
            } else {
                outputs[n]
            };
            (own & ENABLE != 0).then_some(level)
        })
    }
}

impl Device for Dac {
    type Register = Register;

    fn write(
        &mut self,
        register: Register,
        value: u64,
        registers: &mut RegisterFile,
        _: &mut DeviceContext<'_>,
    ) {
        let twelve = |shift: u32| (value >> shift) & 0xFFF;
        let eight = |shift: u32| ((value >> shift) & 0xFF) << 4;
        let [first, second] = match register {
            Register::Dhr12r1 => [Some(twelve(0)), None],
            Register::Dhr12l1 => [Some(twelve(4)), None],
            Register::Dhr8r1 => [Some(eight(0)), None],
            Register::Dhr12r2 => [None, Some(twelve(0))],
            Register::Dhr12l2 => [None, Some(twelve(4))],
            Register::Dhr8r2 => [None, Some(eight(0))],
            Register::Dhr12rd => [Some(twelve(0)), Some(twelve(16))],
            Register::Dhr12ld => [Some(twelve(4)), Some(twelve(20))],
            Register::Dhr8rd => [Some(eight(0)), Some(eight(8))],
            _ => [None, None],
        };
        let control = registers.get(Register::Cr);
        let channels = [(Register::Dor1, first), (Register::Dor2, second)];
        for ((dor, code), place) in channels.into_iter().zip(CHANNELS) {
            if let Some(code) = code
                && (control >> place) & TRIGGERED == 0
            {
                registers.set(dor, code);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use std::num::NonZeroU64;

    use rigless::mcu::Operate as _;
    use rigless::soc::Width;
    use rigless::time::VirtualNanos;

    use crate::board::{CORE_HZ, ControllerBoard, Part};

    /// `RCC_APB1ENR` and its bit `DACEN`, RM0090 6.3.13; `DAC_CR`, `DAC_DHR12R1` and `DAC_DHR12R2`,
    /// 14.5.14.
    const RCC_APB1ENR: u64 = 0x4002_3840;
    const DACEN: u64 = 1 << 29;
    const CR: u64 = 0x4000_7400;
    const HOLDING: [u64; 2] = [0x4000_7408, 0x4000_7414];

    fn set(part: &mut Part, register: u64, value: u64) {
        let written = part.write(VirtualNanos(0), register, Width::W32, value);
        written.unwrap();
    }

    /// Codes on the pins after these values of `CR` and of both holding registers.
    fn codes(control: u64, holding: [u64; 2]) -> [Option<u16>; 2] {
        let rate = NonZeroU64::new(CORE_HZ).unwrap();
        let mut part = ControllerBoard::new(8_000_000, rate).unwrap().part;
        set(&mut part, RCC_APB1ENR, DACEN);
        set(&mut part, CR, control);
        for (register, value) in HOLDING.into_iter().zip(holding) {
            set(&mut part, register, value);
        }
        part.dac_codes()
    }

    #[test]
    fn buffered_output_ends_0v2_from_both_rails() {
        assert_eq!(codes(1 << 16 | 1, [0, 4095]), [Some(249), Some(3847)]);
        assert_eq!(codes(1 << 16 | 1, [249, 3847]), [Some(249), Some(3847)]);
        assert_eq!(codes(1 << 16 | 1, [2048, 2049]), [Some(2048), Some(2049)]);
        // BOFF of the first channel, and of the second.
        assert_eq!(codes(1 << 16 | 0b11, [0, 0]), [Some(0), Some(249)]);
        assert_eq!(
            codes(0b11 << 16 | 1, [4095, 4095]),
            [Some(3847), Some(4095)]
        );
    }

    #[test]
    fn load_divides_the_level_of_an_output_without_its_buffer() {
        let rate = NonZeroU64::new(CORE_HZ).unwrap();
        let mut part = ControllerBoard::new(8_000_000, rate).unwrap().part;
        set(&mut part, RCC_APB1ENR, DACEN);
        // BOFF of the second channel.
        set(&mut part, CR, 0b11 << 16 | 1);
        for register in HOLDING {
            set(&mut part, register, 2048);
        }
        assert_eq!(part.dac_levels([5e3; 2]), [Some(2048.0), Some(512.0)]);
        assert_eq!(part.dac_levels([15e3; 2]), [Some(2048.0), Some(1024.0)]);
    }

    #[test]
    fn channel_that_is_off_or_waits_for_a_trigger_does_not_take_a_code() {
        assert_eq!(codes(1, [2000, 2000]), [Some(2000), None]);
        // TEN of the second channel: its output stays at 0, which the buffer does not reach.
        assert_eq!(
            codes(0b101 << 16 | 1, [2000, 2000]),
            [Some(2000), Some(249)]
        );
    }
}
