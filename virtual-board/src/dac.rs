//! Model of the two-channel DAC.

use rigless::device::{Device, DeviceContext, RegisterFile};
use rigless::soc::stm32f427::generated::dac::Register;

/// The converter without triggers, waveforms and DMA, which the firmware does not use. A code written
/// to a holding register is at once on the pin if its channel is enabled.
#[derive(Debug, Default)]
pub struct Dac;

/// Enable bit of each channel in `CR`.
const ENABLES: [u64; 2] = [1, 1 << 16];

impl Dac {
    /// Codes on PA4 and PA5; `None` if the channel is off and the pin floats.
    #[must_use]
    pub fn codes(registers: &RegisterFile) -> [Option<u16>; 2] {
        let outputs = [Register::Dor1, Register::Dor2].map(|dor| registers.get(dor) as u16);
        let on = ENABLES.map(|bit| registers.get(Register::Cr) & bit != 0);
        [0, 1].map(|n| on[n].then_some(outputs[n]))
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
        for (dor, code) in [(Register::Dor1, first), (Register::Dor2, second)] {
            if let Some(code) = code {
                registers.set(dor, code);
            }
        }
    }
}
