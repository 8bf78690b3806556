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
