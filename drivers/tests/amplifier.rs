//! The amplifier's driver against mocked pins and a mocked PWM channel.

use drivers::{Amplifier, CurrentOutput, PwmCurrent};
use embedded_hal_mock::eh1::digital::{Mock as Pin, State, Transaction as On};
use embedded_hal_mock::eh1::pwm::{Mock as Pwm, Transaction as Duty};
use estimator_core::Amps;

/// Remembers what was commanded.
struct Commands<'a>(&'a mut Vec<f32>);

impl CurrentOutput for Commands<'_> {
    fn command(&mut self, current: Amps) {
        self.0.push(current.get());
    }
}

#[test]
fn it_starts_disabled_is_enabled_once_and_disabled_at_no_current() {
    let mut enable = Pin::new(&[
        On::set(State::Low),
        On::set(State::High),
        On::set(State::Low),
    ]);
    let mut fault = Pin::new(&[]);
    let mut commands = Vec::new();
    let mut amplifier = Amplifier::new(Commands(&mut commands), enable.clone(), fault.clone());
    amplifier.drive(Amps::new(0.5));
    amplifier.drive(Amps::new(-0.25));
    amplifier.disable();
    assert_eq!(commands, [0.0, 0.5, -0.25, 0.0]);
    enable.done();
    fault.done();
}

#[test]
fn an_enable_that_failed_is_tried_again() {
    let refused = On::set(State::High).with_error(embedded_hal_mock::eh1::MockError::Io(
        std::io::ErrorKind::Other,
    ));
    let mut enable = Pin::new(&[On::set(State::Low), refused, On::set(State::High)]);
    let mut fault = Pin::new(&[]);
    let mut commands = Vec::new();
    let mut amplifier = Amplifier::new(Commands(&mut commands), enable.clone(), fault.clone());
    amplifier.drive(Amps::ZERO);
    amplifier.drive(Amps::ZERO);
    enable.done();
    fault.done();
}

#[test]
fn low_or_unreadable_is_a_fault() {
    let unreadable = On::get(State::High).with_error(embedded_hal_mock::eh1::MockError::Io(
        std::io::ErrorKind::Other,
    ));
    let mut enable = Pin::new(&[On::set(State::Low)]);
    let mut fault = Pin::new(&[On::get(State::High), On::get(State::Low), unreadable]);
    let mut commands = Vec::new();
    let mut amplifier = Amplifier::new(Commands(&mut commands), enable.clone(), fault.clone());
    assert_eq!([(); 3].map(|()| amplifier.is_faulty()), [false, true, true]);
    enable.done();
    fault.done();
}

#[test]
fn a_pwm_command_is_half_duty_at_no_current_and_saturates() {
    let duties = [500, 900, 100, 900, 600, 500];
    let mut expected = Vec::new();
    for duty in duties {
        expected.extend([Duty::max_duty_cycle(1000), Duty::set_duty_cycle(duty)]);
    }
    let mut channel = Pwm::new(&expected);
    let mut output = PwmCurrent::new(channel.clone(), Amps::new(6.0));
    for amps in [0.0, 6.0, -6.0, 600.0, 1.5, f32::NAN] {
        output.command(Amps::new(amps));
    }
    channel.done();
}
