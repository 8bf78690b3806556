//! The amplifiers' driver against mocked outputs and pins, and a mocked PWM channel.

use std::cell::RefCell;

use drivers::{Amplifier, Amplifiers, CurrentOutput, Enables, PwmCurrent};
use embedded_hal_mock::eh1::digital::{Mock as Pin, State, Transaction as On};
use embedded_hal_mock::eh1::pwm::{Mock as Pwm, Transaction as Duty};
use estimator_core::Amps;
use haptic_control::Currents;

/// A call of an output, in order.
#[derive(Debug, PartialEq)]
enum Event {
    Command(f32),
    Enable,
    Renew,
    Disable,
}

/// Outputs that write to one journal.
#[derive(Clone, Copy)]
struct Journal<'a>(&'a RefCell<Vec<Event>>);

impl CurrentOutput for Journal<'_> {
    fn command(&mut self, current: Amps) {
        self.0.borrow_mut().push(Event::Command(current.get()));
    }
}

impl Enables for Journal<'_> {
    fn enable(&mut self) {
        self.0.borrow_mut().push(Event::Enable);
    }

    fn renew(&mut self) {
        self.0.borrow_mut().push(Event::Renew);
    }

    fn disable(&mut self) {
        self.0.borrow_mut().push(Event::Disable);
    }
}

fn currents(large: f32, small: f32) -> Currents {
    Currents {
        large: Amps::new(large),
        small: Amps::new(small),
    }
}

/// The enable is given once. If hardware withdraws it, only disabling gives it again.
#[test]
fn command_precedes_enable_and_disable_precedes_command() {
    use Event::{Command, Disable, Enable, Renew};
    let journal = RefCell::new(Vec::new());
    let output = Journal(&journal);
    let (mut large, mut small) = (Pin::new(&[]), Pin::new(&[]));
    let mut amplifiers = Amplifiers::new(
        Amplifier::new(output, large.clone()),
        Amplifier::new(output, small.clone()),
        output,
    );
    let disabled = [Disable, Command(0.0), Command(0.0)];
    assert_eq!(journal.take(), disabled);
    for _ in 0..2 {
        amplifiers.drive(currents(0.5, 0.125));
        assert_eq!(journal.take(), [Command(0.5), Command(0.125), Enable]);
        for _ in 0..2 {
            amplifiers.drive(currents(-0.25, 1.0));
            assert_eq!(journal.take(), [Command(-0.25), Command(1.0), Renew]);
        }
        amplifiers.disable();
        assert_eq!(journal.take(), disabled);
    }
    large.done();
    small.done();
}

#[test]
fn low_or_unreadable_ready_line_is_not_ready() {
    let unreadable = On::get(State::High).with_error(embedded_hal_mock::eh1::MockError::Io(
        std::io::ErrorKind::Other,
    ));
    let (high, low) = (On::get(State::High), On::get(State::Low));
    for (large, small, ready) in [
        (high.clone(), Some(high.clone()), true),
        (high.clone(), Some(low.clone()), false),
        (high.clone(), Some(unreadable.clone()), false),
        // The small amplifier is not asked.
        (low, None, false),
        (unreadable, None, false),
    ] {
        let journal = RefCell::new(Vec::new());
        let output = Journal(&journal);
        let small: Vec<_> = small.into_iter().collect();
        let (mut large, mut small) = (Pin::new(&[large]), Pin::new(&small));
        let mut amplifiers = Amplifiers::new(
            Amplifier::new(output, large.clone()),
            Amplifier::new(output, small.clone()),
            output,
        );
        assert_eq!(amplifiers.are_ready(), ready);
        large.done();
        small.done();
    }
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
