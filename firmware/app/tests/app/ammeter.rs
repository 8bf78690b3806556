//! Measured currents in the control task.

use estimator_core::Amps;
use firmware_app::ammeter::{Ammeter, Measure};
use haptic_control::{Currents, Mode, Request, Stop};

use crate::bench::{Bench, CALM, ZERO, ticks};

/// An amplifier that drives although nothing is commanded. An image that measures nothing goes on.
#[test]
fn current_that_is_not_commanded_stops_the_device_after_50_ms() {
    let mut bench = Bench::start(0);
    bench.readings = Some(Currents {
        large: Amps::new(0.5),
        ..ZERO
    });
    bench.run(ticks(0.05));
    assert_eq!(bench.state(), (Mode::Armed, Stop::None));
    bench.run(1);
    let expected = match <Ammeter as Measure>::WANTED {
        true => (Mode::Safe, Stop::CurrentMismatch),
        false => (Mode::Armed, Stop::None),
    };
    assert_eq!(bench.state(), expected);
}

/// The zeros of both monitors are off by more than 8 % of the limits, 0.48 A and 0.12 A.
#[test]
fn device_whose_monitors_are_not_connected_cannot_be_armed() {
    for (large, small) in [(0.6, 0.0), (0.0, 0.15)] {
        let mut bench = Bench::new();
        bench.readings = Some(Currents {
            large: Amps::new(large),
            small: Amps::new(small),
        });
        for _ in 0..ticks(0.3) {
            bench.step(&CALM);
        }
        bench.request(Request::Arm);
        bench.run(1);
        let is_enabled = bench.state().0.is_enabled();
        assert_eq!(is_enabled, !<Ammeter as Measure>::WANTED, "{large} {small}");
    }
}
