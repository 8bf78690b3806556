//! A current command by PWM.

use embedded_hal::pwm::SetDutyCycle;
use estimator_core::Amps;

use crate::amplifier::CurrentOutput;

/// A PWM channel as a current command, for amplifiers with a PWM set value: 50 % duty is zero
/// current, 10 % and 90 % are full scale. With a full scale of 0 the duty is always 50 %.
pub struct PwmCurrent<P> {
    channel: P,
    full_scale: Amps,
}

impl<P: SetDutyCycle> PwmCurrent<P> {
    /// The command on `channel`, with `full_scale` at 90 % duty.
    pub const fn new(channel: P, full_scale: Amps) -> Self {
        Self {
            channel,
            full_scale,
        }
    }
}

impl<P: SetDutyCycle> CurrentOutput for PwmCurrent<P> {
    fn command(&mut self, current: Amps) {
        let share = current.get() / self.full_scale.get();
        // Without a full scale no current can be commanded.
        let share = if share.is_finite() {
            share.clamp(-1.0, 1.0)
        } else {
            0.0
        };
        let top = f32::from(self.channel.max_duty_cycle());
        let duty = (0.5 + 0.4 * share) * top + 0.5;
        // The largest duty is a u16 and 0.9 of it is less; a channel that refuses keeps its last.
        let _ = self.channel.set_duty_cycle(duty as u16);
    }
}
