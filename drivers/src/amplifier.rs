//! A current amplifier: command, enable, fault.

use embedded_hal::digital::{InputPin, OutputPin};
use estimator_core::Amps;

/// Something that takes a current command: a DAC channel, which embedded-hal has no trait for, or
/// a [`PwmCurrent`](crate::PwmCurrent).
pub trait CurrentOutput {
    /// Commands a current.
    fn command(&mut self, current: Amps);
}

/// A current amplifier with an enable input, active high, and a fault output, active low.
///
/// While it is disabled, its command is no current.
pub struct Amplifier<C, E, F> {
    output: C,
    enable: E,
    fault: F,
    enabled: bool,
}

impl<C: CurrentOutput, E: OutputPin, F: InputPin> Amplifier<C, E, F> {
    /// The amplifier, disabled and at no current.
    pub fn new(output: C, enable: E, fault: F) -> Self {
        let mut amplifier = Self {
            output,
            enable,
            fault,
            enabled: false,
        };
        amplifier.disable();
        amplifier
    }

    /// Disables it and commands no current.
    pub fn disable(&mut self) {
        self.enabled = false;
        // A pin of the chip itself cannot fail; one behind a bus that did would show as a fault.
        let _ = self.enable.set_low();
        self.output.command(Amps::ZERO);
    }

    /// Commands a current and enables it, if that is not done yet; the command comes first.
    pub fn drive(&mut self, current: Amps) {
        self.output.command(current);
        if !self.enabled {
            self.enabled = self.enable.set_high().is_ok();
        }
    }

    /// Whether it reports a fault; a pin that cannot be read is one.
    pub fn is_faulty(&mut self) -> bool {
        !matches!(self.fault.is_high(), Ok(true))
    }
}
