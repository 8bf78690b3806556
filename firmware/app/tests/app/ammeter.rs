//! Measured currents in the control task.

use estimator_core::{Amps, Count, Sample};
use firmware_app::ammeter::{Ammeter, Measure};
use firmware_app::config::{DEVICE, RATE_HZ};
use firmware_app::control::Inputs;
use haptic_control::{Currents, Flow, Mode, Request, Stop};

use crate::bench::{Bench, CALM, NO_PULSE, ZERO, ticks};

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

#[test]
fn device_that_is_armed_again_may_disagree_for_50_ms_again() {
    let wrong = Some(Currents {
        large: Amps::new(0.5),
        ..ZERO
    });
    let mut bench = Bench::start(0);
    bench.readings = wrong;
    bench.run(ticks(0.05) + 1);
    bench.readings = None;
    bench.run(2);
    bench.request(Request::Arm);
    bench.readings = wrong;
    bench.run(ticks(0.049));
    assert_eq!(bench.state(), (Mode::Armed, Stop::None));
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
        for _ in 0..2 {
            let is_enabled = bench.request(Request::Arm).is_some();
            assert_eq!(is_enabled, !<Ammeter as Measure>::WANTED, "{large} {small}");
        }
    }
}

/// No current is commanded.
#[test]
fn overload_is_that_of_the_currents_that_have_flowed() {
    let mut bench = Bench::start(0);
    let at_rest = Sample::new(Count(0)).with_coupled(Count(0));
    let flow = Flow {
        currents: Currents {
            small: Amps::new(1.5),
            ..ZERO
        },
        mismatch: None,
    };
    let inputs = Inputs {
        request: Some(Request::KeepAlive),
        ..CALM
    };
    let mut held = 0;
    while bench.state().0 == Mode::Armed && held < ticks(4.0) {
        bench.control.check(&at_rest, &flow, &NO_PULSE);
        bench.control.step(&at_rest, &inputs);
        held += 1;
    }
    assert_eq!(bench.state(), (Mode::Safe, Stop::Overload));
    // From the cold, in slots of 10 ms.
    let part = (DEVICE.small.continuous_current / 1.5).powi(2);
    let expected = DEVICE.small.winding_time_constant * -(1.0 - part).ln();
    let held_s = f64::from(held) / f64::from(RATE_HZ);
    assert!((held_s - expected).abs() < 0.02, "{held_s} s of {expected}");
}
