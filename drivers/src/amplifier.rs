//! The current amplifiers: commands, enables, ready lines.

use embedded_hal::digital::InputPin;
use estimator_core::Amps;
use haptic_control::Currents;

/// An output for a current command: a DAC channel, for which embedded-hal has no trait, or a
/// [`PwmCurrent`](crate::PwmCurrent).
pub trait CurrentOutput {
    /// Commands a current.
    fn command(&mut self, current: Amps);
}

/// The enables of both amplifiers, which hardware may withdraw at any time.
///
/// An enable that hardware has withdrawn stays withdrawn until [`Self::disable`] and then
/// [`Self::enable`] are called.
pub trait Enables {
    /// Enables both amplifiers. While hardware reports a fault, the amplifiers stay disabled.
    fn enable(&mut self);

    /// Extends the time for which the amplifiers stay enabled.
    fn renew(&mut self);

    /// Disables both amplifiers.
    fn disable(&mut self);
}

/// A current amplifier with a ready output: high while the amplifier can drive its motor.
pub struct Amplifier<C, R> {
    output: C,
    ready: R,
}

impl<C: CurrentOutput, R: InputPin> Amplifier<C, R> {
    /// The amplifier behind these pins.
    pub const fn new(output: C, ready: R) -> Self {
        Self { output, ready }
    }

    /// Whether the amplifier is ready. An amplifier whose pin cannot be read is not ready.
    fn is_ready(&mut self) -> bool {
        matches!(self.ready.is_high(), Ok(true))
    }
}

/// Both amplifiers. While they are disabled, their command is zero current.
pub struct Amplifiers<L, S, E> {
    large: L,
    small: S,
    enables: E,
    enabled: bool,
}

impl<CL, RL, CS, RS, E> Amplifiers<Amplifier<CL, RL>, Amplifier<CS, RS>, E>
where
    CL: CurrentOutput,
    RL: InputPin,
    CS: CurrentOutput,
    RS: InputPin,
    E: Enables,
{
    /// Both amplifiers, disabled and at zero current.
    pub fn new(large: Amplifier<CL, RL>, small: Amplifier<CS, RS>, enables: E) -> Self {
        let mut amplifiers = Self {
            large,
            small,
            enables,
            enabled: false,
        };
        amplifiers.disable();
        amplifiers
    }

    /// Disables both amplifiers and commands zero current.
    pub fn disable(&mut self) {
        self.enabled = false;
        self.enables.disable();
        self.command(Currents::default());
    }

    /// Commands both currents. Then enables the amplifiers, or renews their enables.
    pub fn drive(&mut self, currents: Currents) {
        self.command(currents);
        if self.enabled {
            self.enables.renew();
        } else {
            self.enabled = true;
            self.enables.enable();
        }
    }

    /// Whether both amplifiers are ready.
    pub fn are_ready(&mut self) -> bool {
        self.large.is_ready() && self.small.is_ready()
    }

    /// The outputs of the commands, large and small. A change of an output acts from the next command on.
    pub const fn outputs(&mut self) -> (&mut CL, &mut CS) {
        (&mut self.large.output, &mut self.small.output)
    }

    /// The enables.
    pub const fn enables(&self) -> &E {
        &self.enables
    }

    fn command(&mut self, currents: Currents) {
        self.large.output.command(currents.large);
        self.small.output.command(currents.small);
    }
}
