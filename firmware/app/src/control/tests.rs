use super::*;
use haptic_control::{NewtonMetres, RadPerS};

/// The number of the tick is modulo 2^32: it comes again after 5 days at 10 kHz, or 30 h at 40 kHz.
#[test]
fn image_that_arms_by_itself_does_so_once() {
    let at_rest = Sample::default();
    let mut control = Control::new(&at_rest, Stop::None, true, &Settings::COMMISSIONED);
    control.auto_arm = true;
    let mut requests = heapless::Vec::<_, 4>::new();
    while control.auto_arm {
        control.phase = control.phase.next();
        if control.phase == Phase::FRAME {
            control.period = control.period.wrapping_add(1);
        }
        let command = Some(Request::KeepAlive);
        let request = control.arm_by_itself(command);
        if request != command {
            requests.push((control.tick(), request)).unwrap();
        }
    }
    let armed = RATE_HZ / 10;
    let select = (armed - 1, Some(Request::Select(FIRST)));
    assert_eq!(requests, [select, (armed, Some(Request::Arm))]);
}

#[test]
fn action_with_one_non_finite_number_is_detected() {
    let both = |action: &Action| [has_finite_sum(action), are_finite(action)];
    assert_eq!(both(&Action::default()), [true; 2]);
    // A sum that is too large says nothing.
    let large = Action {
        large_velocity: RadPerS(3e38),
        handle_velocity: RadPerS(3e38),
        ..Action::default()
    };
    assert_eq!(both(&large), [false, true]);
    let zero = Action::default;
    for number in [f32::NAN, f32::INFINITY] {
        let actions = [
            Action {
                torque: NewtonMetres(number),
                ..zero()
            },
            Action {
                large_velocity: RadPerS(number),
                ..zero()
            },
            Action {
                handle_velocity: RadPerS(number),
                ..zero()
            },
        ];
        for action in actions {
            assert_eq!(both(&action), [false; 2]);
        }
    }
}
