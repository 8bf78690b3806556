//! A current amplifier: command, enable, fault.

use embedded_hal::digital::{InputPin, OutputPin};
use estimator_core::Amps;

/// An output for a current command: a DAC channel, for which embedded-hal has no trait, or a
/// [`PwmCurrent`](crate::PwmCurrent).
pub trait CurrentOutput {
    /// Commands a current.
    fn command(&mut self, current: Amps);
}

/// A current amplifier with an enable input, active high, and a fault output, active low.
///
/// While the amplifier is disabled, its command is zero current.
pub struct Amplifier<C, E, F> {
    output: C,
    enable: E,
    fault: F,
    enabled: bool,
}

impl<C: CurrentOutput, E: OutputPin, F: InputPin> Amplifier<C, E, F> {
    /// The amplifier, disabled and at zero current.
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

    /// Disables the amplifier and commands zero current.
    pub fn disable(&mut self) {
        self.enabled = false;
        // A pin of the chip itself cannot fail; one behind a bus that did would show as a fault.
        let _ = self.enable.set_low();
        self.output.command(Amps::ZERO);
    }

    /// Commands a current and then enables the amplifier, if it is not enabled yet.
    pub fn drive(&mut self, current: Amps) {
        self.output.command(current);
        if !self.enabled {
            self.enabled = self.enable.set_high().is_ok();
        }
    }

    /// Whether the amplifier reports a fault. A pin that cannot be read counts as a fault.
    pub fn is_faulty(&mut self) -> bool {
        !matches!(self.fault.is_high(), Ok(true))
    }
}
