//! Check of the pins' configuration by the firmware.

use rigless::device::Level;
use rigless::mcu::Operate;
use rigless::soc::Width;
use rigless::soc::stm32f427::peripherals::gpio::{Gpio, Pin};
use rigless::soc::stm32f427::peripherals::tim::Channel;
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

/// The index lines of the large and the small encoder, of an image that captures them.
pub const INDICES: [Wire; 2] = [
    ('D', 14, Mode::Function(2), "large encoder index, TIM4_CH3"),
    ('B', 1, Mode::Function(2), "small encoder index, TIM3_CH4"),
];

/// The serial port to the host.
pub const PORT: [Wire; 2] = [
    ('D', 8, Mode::Function(7), "serial port out, USART3_TX"),
    ('D', 9, Mode::Function(7), "serial port in, USART3_RX"),
];

/// Set values, enables and ready lines of the amplifiers, large motor first, and the interlock loop.
pub(crate) const AMPLIFIERS: [Wire; 7] = [
    ('A', 4, Mode::Analog, "large set value, DAC_OUT1"),
    ('A', 5, Mode::Analog, "small set value, DAC_OUT2"),
    ('C', 8, Mode::Function(3), "large enable, TIM8_CH3"),
    ('C', 9, Mode::Function(3), "small enable, TIM8_CH4"),
    ('E', 2, Mode::Input, "large ready"),
    ('E', 6, Mode::Input, "small ready"),
    ('A', 6, Mode::Function(3), "interlock, TIM8_BKIN"),
];

/// The current monitors of the amplifiers, of an image that reads them.
pub const MONITORS: [Wire; 2] = [
    ('A', 3, Mode::Analog, "large current monitor, ADC1_IN3"),
    ('C', 0, Mode::Analog, "small current monitor, ADC2_IN10"),
];

/// The divider at the amplifiers' supply, of an image that reads it.
pub const SUPPLY: [Wire; 1] = [('F', 3, Mode::Analog, "supply voltage, ADC3_IN9")];

/// A pin: index of its port from A on, and its number.
#[derive(Clone, Copy, Debug)]
pub(crate) struct At(usize, u8);

/// Enables, high to enable; a pull-down holds an undriven line low.
const ENABLES: [At; 2] = [At(2, 8), At(2, 9)];
/// Channels of TIM8 on these pins.
const CHANNELS: [u8; 2] = [3, 4];
/// Ready lines, high if the amplifier is ready.
pub(crate) const READY: [At; 2] = [At(4, 2), At(4, 6)];
/// The interlock loop, high while it is closed.
pub(crate) const INTERLOCK: At = At(0, 6);
/// Number of the function that connects a pin to TIM8.
const TIM8_FUNCTION: u8 = 3;
/// Index of TIM8 among the advanced timers of the emulator.
const TIM8: usize = 1;

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
    let wires = LARGE.iter().chain(&SMALL).chain(&PORT).chain(&AMPLIFIERS);
    let wrong = wires.filter_map(|&(port, pin, wanted, what)| {
        let is = mode(part, port, pin);
        (is != wanted).then(|| format!("P{port}{pin} ({what}) is {is:?}; it must be {wanted:?}"))
    });
    wrong.collect()
}

/// Whether the enable of each amplifier is active.
pub(crate) fn enabled(part: &mut Part) -> [bool; 2] {
    let by_pin = ENABLES.map(|at| (function(part, at), level(part, at)));
    let (timer, registers) = part.stm32.advanced_timer(TIM8);
    let mut enabled = [false; 2];
    for (n, (function, level)) in by_pin.into_iter().enumerate() {
        enabled[n] = if function == Some(TIM8_FUNCTION) {
            let channel = Channel::new(CHANNELS[n]).expect("channels 3 and 4");
            timer.output(channel, registers) == Some(Level::High)
        } else {
            level
        };
    }
    enabled
}

/// Level of the interlock loop at the timer. The emulator has the input low while no pin is
/// connected.
pub(crate) fn interlock_level(part: &mut Part) -> bool {
    function(part, INTERLOCK) == Some(TIM8_FUNCTION) && level(part, INTERLOCK)
}

/// Sets the break input of TIM8.
pub(crate) fn drive_break(part: &mut Part, at: VirtualNanos, level: bool) {
    part.stm32
        .drive_advanced_timer(at, TIM8, |timer, registers, context| {
            timer.drive_break(Level::from(level), registers, context);
        });
}

/// Sets the level of an input; `None` if nothing drives its wire, which leaves the level to the
/// pull resistor of the pin. Without one the level stays as it was.
pub(crate) fn drive(part: &mut Part, at: VirtualNanos, pin: At, level: Option<bool>) {
    let At(port, pin) = pin;
    let pin = Pin::new(pin).expect("below 16");
    part.stm32.drive_port(at, port, |port, registers, context| {
        port.drive(pin, level.map(Level::from), registers, context);
    });
}

/// Connects the pull-downs of the enables, which outputs of the chip override.
pub(crate) fn pull_enables_down(part: &mut Part, at: VirtualNanos) {
    for pin in ENABLES {
        drive(part, at, pin, Some(false));
    }
}

/// Level of a pin.
fn level(part: &mut Part, At(port, pin): At) -> bool {
    let (port, registers) = part.stm32.port(port);
    port.level(Pin::new(pin).expect("below 16"), registers) == Level::High
}

/// Number of the alternate function of a pin.
fn function(part: &mut Part, At(port, pin): At) -> Option<u8> {
    let (_, registers) = part.stm32.port(port);
    Gpio::function(Pin::new(pin).expect("below 16"), registers)
}

#[cfg(test)]
mod tests {
    use std::num::NonZeroU64;

    use super::*;
    use crate::board::{CORE_HZ, ControllerBoard};

    /// A pin is an input after a reset, as those of the ready lines have to be.
    #[test]
    fn pins_that_are_not_configured_are_told() {
        let rate = NonZeroU64::new(CORE_HZ).unwrap();
        let mut part = ControllerBoard::new(8_000_000, rate).unwrap().part;
        let told = complaints(&mut part);
        assert_eq!(told.len(), 2 + 2 + 2 + 5, "{told:?}");
        for said in [
            "PD12 (large encoder A, TIM4_CH1) is Input; it must be Function(2)",
            "PC7 (small encoder B, TIM3_CH2) is Input; it must be Function(2)",
            "PD9 (serial port in, USART3_RX) is Input; it must be Function(7)",
            "PA4 (large set value, DAC_OUT1) is Input; it must be Analog",
            "PA6 (interlock, TIM8_BKIN) is Input; it must be Function(3)",
        ] {
            assert!(told.iter().any(|line| line == said), "{said}: {told:?}");
        }
    }
}
