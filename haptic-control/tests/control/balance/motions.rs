//! Motions at the edges of the windows and of what is learned, which are balanced.

use estimator_core::Hertz;
use haptic_control::{Balance, DualStage, Motor};

use super::{DEVICE, NOMINAL, Shaft, True, WINDOW_S, current, found_by_s, found_s};

/// Windows begin 6 ticks after the start and each 20 ms. Both shafts turn back where every fourth one begins, and
/// move by more than four counts in each quarter beside it: by 6 with 785 rad/s^2. The friction is learned in both
/// directions, and neither is that of the time around the reversal. It is more than what the inertia is known to.
#[test]
fn motor_that_turns_back_where_a_window_begins_is_balanced() {
    let rough = True {
        friction: 4.0,
        ..NOMINAL
    };
    let large = Motor {
        coulomb_friction: rough.friction * DEVICE.large.coulomb_friction,
        ..DEVICE.large
    };
    let balance = Balance::new(&DualStage { large, ..DEVICE }, Hertz(10e3));
    for sign in [1.0, -1.0] {
        let shaft = Shaft(0.0, sign * 20.0, 1.0 / (8.0 * WINDOW_S));
        let angle = |t: f64| shaft.angle(t - 6e-4);
        let amps = |t: f64| current(rough, shaft, shaft, t - 6e-4);
        let found = found_by_s(&balance, 10e3, 2.0, angle, angle, amps);
        assert_eq!(found, None, "{sign}");
    }
}

/// At 12 Hz and 25 rad/s, by half an ampere of the large motor's current. What is learned of the friction while the
/// slip is small holds for both directions in which it changes.
#[test]
fn handle_that_is_shaken_is_balanced() {
    let (large, small) = (Shaft(5.0, 0.0, 1.0), Shaft(0.0, 25.0, 12.0));
    let amps = |t: f64| current(NOMINAL, large, small, t);
    for rate in [1e3, 10e3] {
        let found = found_s(rate, 3.0, |t| large.angle(t), |t| small.angle(t), amps);
        assert_eq!(found, None, "{rate} Hz");
    }
}
