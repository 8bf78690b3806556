//! Model of the analog-to-digital converters.

use rigless::device::{Device, DeviceContext, RegisterFile};
use rigless::soc::stm32f427::generated::adc1::Register;
use rigless::soc::stm32f427::generated::c_adc;

/// A converter that converts one channel, started by the program and again and again, which is what
/// the firmware does. In any other setting the result is 0.
#[derive(Debug)]
pub struct Adc {
    /// The channel of the wire.
    channel: u64,
    /// Level on the wire, codes of 12 bits; `None` for a pin that is not analogue.
    level: Option<f64>,
    started: bool,
    /// State of the noise.
    noise: u32,
}

/// Bits of `CR2`.
const ADON: u64 = 1;
const CONT: u64 = 1 << 1;
const SWSTART: u64 = 1 << 30;
/// Bit of `SR`: a conversion has started.
const STRT: u64 = 1 << 4;
/// Largest error of a conversion by noise, codes.
const NOISE: f64 = 2.0;

impl Adc {
    /// A converter whose wire is on this channel.
    #[must_use]
    pub fn new(channel: u8) -> Self {
        Self {
            channel: channel.into(),
            level: None,
            started: false,
            noise: channel.into(),
        }
    }

    /// Sets the level on the wire, codes.
    pub fn drive(&mut self, level: Option<f64>) {
        self.level = level;
    }

    /// The converter after a reset.
    pub fn reset(&mut self) {
        self.started = false;
    }

    /// The result of a conversion that ends now.
    fn convert(&mut self, registers: &RegisterFile) -> u64 {
        let control = registers.get(Register::Cr2);
        let scans = registers.get(Register::Sqr1) != 0;
        let converts = self.started && control & (ADON | CONT) == ADON | CONT && !scans;
        let level = self
            .level
            .filter(|_| converts && registers.get(Register::Sqr3) & 0x1F == self.channel);
        self.noise = self
            .noise
            .wrapping_mul(1_664_525)
            .wrapping_add(1_013_904_223);
        let noise = NOISE * (f64::from(self.noise) / f64::from(u32::MAX) * 2.0 - 1.0);
        level.map_or(0, |level| (level + noise).round().clamp(0.0, 4095.0) as u64)
    }
}

impl Device for Adc {
    type Register = Register;

    fn read(
        &mut self,
        register: Register,
        registers: &mut RegisterFile,
        _: &mut DeviceContext<'_>,
    ) -> Option<u64> {
        (register == Register::Dr).then(|| self.convert(registers))
    }

    fn write(
        &mut self,
        register: Register,
        value: u64,
        registers: &mut RegisterFile,
        _: &mut DeviceContext<'_>,
    ) {
        if register == Register::Cr2 {
            if value & ADON == 0 {
                self.started = false;
            } else if value & SWSTART != 0 {
                self.started = true;
                registers.set(Register::Sr, registers.get(Register::Sr) | STRT);
            }
            // Hardware clears the bit when the conversion starts.
            registers.set(Register::Cr2, value & !SWSTART);
        }
    }
}

/// The registers that the converters share. The prescaler in them does not matter to [`Adc`].
#[derive(Debug)]
pub struct Common;

impl Device for Common {
    type Register = c_adc::Register;
}

#[cfg(test)]
mod tests {
    use std::num::NonZeroU64;

    use rigless::mcu::Operate as _;
    use rigless::soc::Width;
    use rigless::time::VirtualNanos;

    use super::{ADON, CONT, NOISE, SWSTART};
    use crate::board::{CORE_HZ, ControllerBoard};

    /// `RCC_APB2ENR` and its bit `ADC1EN`, RM0090 6.3.14; `ADC_CR2`, `ADC_SQR1`, `ADC_SQR3` and `ADC_DR` of
    /// ADC1, 13.13.18.
    const RCC_APB2ENR: u64 = 0x4002_3844;
    const ADC1EN: u64 = 1 << 8;
    const CR2: u64 = 0x4001_2008;
    const SQR1: u64 = 0x4001_202C;
    const SQR3: u64 = 0x4001_2034;
    const DR: u64 = 0x4001_204C;
    /// Channel of PA3.
    const PA3: u64 = 3;

    /// The result with this level on PA3 after these values of `SQR1`, `SQR3` and `CR2`.
    fn result(level: Option<f64>, [sqr1, sqr3, cr2]: [u64; 3]) -> f64 {
        let rate = NonZeroU64::new(CORE_HZ).unwrap();
        let mut part = ControllerBoard::new(8_000_000, rate).unwrap().part;
        part.drive_analog([level, None, None]);
        let at = VirtualNanos(0);
        for (register, value) in [
            (RCC_APB2ENR, ADC1EN),
            (SQR1, sqr1),
            (SQR3, sqr3),
            (CR2, cr2),
        ] {
            part.write(at, register, Width::W32, value).unwrap();
        }
        part.read(at, DR, Width::W32).unwrap() as f64
    }

    #[test]
    fn converter_reads_its_channel_again_and_again_or_nothing() {
        let on = ADON | CONT | SWSTART;
        let read = result(Some(1000.0), [0, PA3, on]);
        assert!((read - 1000.0).abs() <= NOISE, "{read}");
        assert_eq!(result(Some(5000.0), [0, PA3, on]), 4095.0);
        // Not analogue; two channels; another channel; not started; once; off.
        assert_eq!(result(None, [0, PA3, on]), 0.0);
        for other in [
            [1 << 20, PA3, on],
            [0, PA3 + 1, on],
            [0, PA3, ADON | CONT],
            [0, PA3, ADON | SWSTART],
            [0, PA3, CONT | SWSTART],
        ] {
            assert_eq!(result(Some(1000.0), other), 0.0, "{other:?}");
        }
    }
}
