//! The amplifier's driver against mocked pins and a mocked PWM channel.

use std::cell::RefCell;
use std::convert::Infallible;

use drivers::{Amplifier, CurrentOutput, PwmCurrent};
use embedded_hal::digital::{ErrorType, OutputPin};
use embedded_hal_mock::eh1::digital::{Mock as Pin, State, Transaction as On};
use embedded_hal_mock::eh1::pwm::{Mock as Pwm, Transaction as Duty};
use estimator_core::Amps;

/// What reaches an amplifier's inputs, in order.
#[derive(Debug, PartialEq)]
enum Event {
    Command(f32),
    Enable(bool),
}

/// Outputs that write to one journal.
struct Journal<'a>(&'a RefCell<Vec<Event>>);

impl CurrentOutput for Journal<'_> {
    fn command(&mut self, current: Amps) {
        self.0.borrow_mut().push(Event::Command(current.get()));
    }
}

impl ErrorType for Journal<'_> {
    type Error = Infallible;
}

impl OutputPin for Journal<'_> {
    fn set_low(&mut self) -> Result<(), Infallible> {
        self.0.borrow_mut().push(Event::Enable(false));
        Ok(())
    }

    fn set_high(&mut self) -> Result<(), Infallible> {
        self.0.borrow_mut().push(Event::Enable(true));
        Ok(())
    }
}

#[test]
fn command_precedes_enable_and_disable_precedes_command() {
    use Event::{Command, Enable};
    let journal = RefCell::new(Vec::new());
    let mut fault = Pin::new(&[]);
    let mut amplifier = Amplifier::new(Journal(&journal), Journal(&journal), fault.clone());
    assert_eq!(journal.take(), [Enable(false), Command(0.0)]);
    for _ in 0..2 {
        amplifier.drive(Amps::new(0.5));
        assert_eq!(journal.take(), [Command(0.5), Enable(true)]);
        // Once enabled, the pin is left alone.
        amplifier.drive(Amps::new(-0.25));
        assert_eq!(journal.take(), [Command(-0.25)]);
        amplifier.disable();
        assert_eq!(journal.take(), [Enable(false), Command(0.0)]);
    }
    fault.done();
}

#[test]
fn failed_enable_is_repeated() {
    let refused = On::set(State::High).with_error(embedded_hal_mock::eh1::MockError::Io(
        std::io::ErrorKind::Other,
    ));
    let mut enable = Pin::new(&[On::set(State::Low), refused, On::set(State::High)]);
    let mut fault = Pin::new(&[]);
    let commands = RefCell::new(Vec::new());
    let mut amplifier = Amplifier::new(Journal(&commands), enable.clone(), fault.clone());
    amplifier.drive(Amps::ZERO);
    amplifier.drive(Amps::ZERO);
    enable.done();
    fault.done();
}

#[test]
fn low_or_unreadable_fault_input_is_a_fault() {
    let unreadable = On::get(State::High).with_error(embedded_hal_mock::eh1::MockError::Io(
        std::io::ErrorKind::Other,
    ));
    let mut enable = Pin::new(&[On::set(State::Low)]);
    let mut fault = Pin::new(&[On::get(State::High), On::get(State::Low), unreadable]);
    let commands = RefCell::new(Vec::new());
    let mut amplifier = Amplifier::new(Journal(&commands), enable.clone(), fault.clone());
    assert_eq!([(); 3].map(|()| amplifier.is_faulty()), [false, true, true]);
    enable.done();
    fault.done();
}

/// The duties of these currents, of a channel whose largest is `top`, at a full scale.
fn duties(top: u16, full_scale: f32, commands: &[(f32, u16)]) {
    let mut expected = Vec::new();
    for (_, duty) in commands {
        expected.extend([Duty::max_duty_cycle(top), Duty::set_duty_cycle(*duty)]);
    }
    let mut channel = Pwm::new(&expected);
    let mut output = PwmCurrent::new(channel.clone(), Amps::new(full_scale));
    for (current, _) in commands {
        output.command(Amps::new(*current));
    }
    channel.done();
}

#[test]
fn pwm_duty_is_half_at_zero_current_and_10_and_90_percent_at_full_scale() {
    duties(
        1000,
        6.0,
        &[(0.0, 500), (6.0, 900), (-6.0, 100), (1.5, 600), (-3.0, 300)],
    );
    // To the nearest step of a coarse channel: 5 + 4 / 6 and 5 - 4 / 6 of 10.
    duties(10, 6.0, &[(1.0, 6), (-1.0, 4), (0.6, 5), (-0.6, 5)]);
    duties(50_000, 1.5, &[(0.0, 25_000), (1.5, 45_000), (-1.5, 5000)]);
}

#[test]
fn pwm_duty_saturates_beyond_full_scale() {
    duties(1000, 6.0, &[(600.0, 900), (-600.0, 100), (f32::MAX, 900)]);
}

#[test]
fn pwm_duty_is_half_without_a_full_scale() {
    duties(1000, 0.0, &[(0.0, 500), (1.0, 500), (-1.0, 500)]);
}
