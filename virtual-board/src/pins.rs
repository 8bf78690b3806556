//! Check of the pins' configuration by the firmware.

use rigless::device::Level;
use rigless::mcu::Operate;
use rigless::soc::Width;
use rigless::soc::stm32f427::peripherals::gpio::Pin;
use rigless::time::VirtualNanos;

use crate::board::Part;

/// Mode of a pin.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Mode {
    /// Digital input.
    Input,
    /// Digital output.
    Output,
    /// Alternate function of this number.
    Function(u8),
    /// Analogue.
    Analog,
}

/// A wired pin: port letter, number, mode, and the connected signal.
pub type Wire = (char, u8, Mode, &'static str);

/// The large motor's encoder.
pub const LARGE: [Wire; 2] = [
    ('D', 12, Mode::Function(2), "large encoder A, TIM4_CH1"),
    ('D', 13, Mode::Function(2), "large encoder B, TIM4_CH2"),
];

/// The large motor's encoder on the timer that stamps its edges.
pub const CAPTURE: [Wire; 2] = [
    ('A', 15, Mode::Function(1), "large encoder A, TIM2_CH1"),
    ('B', 3, Mode::Function(1), "large encoder B, TIM2_CH2"),
];

/// The handle's encoder.
pub const SMALL: [Wire; 2] = [
    ('C', 6, Mode::Function(2), "small encoder A, TIM3_CH1"),
    ('C', 7, Mode::Function(2), "small encoder B, TIM3_CH2"),
];

/// The reference encoder on the large motor, of an image that reads it.
pub const REFERENCE: [Wire; 2] = [
    ('E', 9, Mode::Function(1), "reference encoder A, TIM1_CH1"),
    ('E', 11, Mode::Function(1), "reference encoder B, TIM1_CH2"),
];

/// Set values, enable and fault lines of the amplifiers, large motor first.
pub const AMPLIFIERS: [Wire; 6] = [
    ('A', 4, Mode::Analog, "large set value, DAC_OUT1"),
    ('A', 5, Mode::Analog, "small set value, DAC_OUT2"),
    ('E', 4, Mode::Output, "large enable"),
    ('E', 5, Mode::Output, "small enable"),
    ('E', 2, Mode::Input, "large fault"),
    ('E', 6, Mode::Input, "small fault"),
];

/// Enable lines, high to enable; a pull-down holds an undriven line low.
pub(crate) const ENABLES: [u8; 2] = [4, 5];
/// Fault lines, low on a fault.
pub(crate) const FAULTS: [u8; 2] = [2, 6];
/// Port of enable and fault lines.
pub(crate) const AMPLIFIER_PORT: usize = 4;

/// The pin's mode as configured by the firmware.
fn mode(part: &mut Part, port: char, pin: u8) -> Mode {
    let base = 0x4002_0000 + 0x400 * (u64::from(u32::from(port)) - u64::from(u32::from('A')));
    let mut read = |offset: u64| {
        part.peek(VirtualNanos(0), base + offset, Width::W32)
            .unwrap_or(0)
    };
    match (read(0x00) >> (2 * pin)) & 3 {
        0 => Mode::Input,
        1 => Mode::Output,
        2 => Mode::Function(((read(0x20 + 4 * u64::from(pin / 8)) >> (4 * (pin % 8))) & 15) as u8),
        _ => Mode::Analog,
    }
}

/// Whether all pins of `wires` have their required mode.
#[must_use]
pub fn wired(part: &mut Part, wires: &[Wire]) -> bool {
    wires
        .iter()
        .all(|&(port, pin, wanted, _)| mode(part, port, pin) == wanted)
}

/// One line for each pin with a wrong mode.
#[must_use]
pub fn complaints(part: &mut Part) -> Vec<String> {
    let wires = LARGE.iter().chain(&SMALL).chain(&AMPLIFIERS);
    let wrong = wires.filter_map(|&(port, pin, wanted, what)| {
        let is = mode(part, port, pin);
        (is != wanted).then(|| format!("P{port}{pin} ({what}) is {is:?}; it must be {wanted:?}"))
    });
    wrong.collect()
}

/// Whether each amplifier is enabled.
pub(crate) fn enabled(part: &mut Part) -> [bool; 2] {
    let (port, registers) = part.stm32.port(AMPLIFIER_PORT);
    ENABLES.map(|pin| {
        let pin = Pin::new(pin).expect("below 16");
        port.level(pin, registers) == Level::High
    })
}

/// Sets the level of an input of the amplifiers' port.
pub(crate) fn drive(part: &mut Part, at: VirtualNanos, pin: u8, level: bool) {
    let pin = Pin::new(pin).expect("below 16");
    part.stm32
        .drive_port(at, AMPLIFIER_PORT, |port, registers, context| {
            port.drive(pin, Some(Level::from(level)), registers, context);
        });
}
