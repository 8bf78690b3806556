//! The supply of the amplifiers in the control task.

use drivers::Settings;
use estimator_core::{Count, Sample};
use firmware_app::config::{AUTO_ARM, DECIMATION};
use firmware_app::control::Control;
use firmware_app::supply::{Voltmeter, Watch};
use haptic_control::{Mode, Request, Stop};

use crate::bench::{Bench, CALM, NO_PULSE, ZERO, readings, supply, ticks};

const WANTED: bool = <Voltmeter as Watch>::WANTED;
/// Ticks of three readings.
const THREE: u32 = 3 * DECIMATION;

/// The first reading of a voltage comes in at most [`DECIMATION`] ticks. An image that reads none goes on.
#[test]
fn supply_that_leaves_its_range_stops_the_device_after_three_readings() {
    for volts in [0.0, 20.3, 28.9, f32::NAN] {
        let mut bench = Bench::start(0);
        bench.run(ticks(0.1));
        bench.supply = volts;
        bench.run(THREE - DECIMATION);
        assert_eq!(bench.state(), (Mode::Armed, Stop::None), "{volts} V");
        bench.run(DECIMATION + 1);
        let expected = match WANTED {
            true => (Mode::Safe, Stop::Supply),
            false => (Mode::Armed, Stop::None),
        };
        assert_eq!(bench.state(), expected, "{volts} V");
    }
}

#[test]
fn supply_at_the_ends_of_its_range_and_one_wrong_reading_go_on() {
    for volts in [20.5, 28.7] {
        let mut bench = Bench::start(0);
        bench.supply = volts;
        bench.run(ticks(0.1));
        for _ in 0..100 {
            bench.supply = 0.0;
            bench.run(DECIMATION);
            bench.supply = volts;
            bench.run(DECIMATION);
        }
        assert_eq!(bench.state(), (Mode::Armed, Stop::None), "{volts} V");
    }
}

/// No current flows and no amplifier is enabled, not for a tick, until the supply is back.
#[test]
fn device_without_its_supply_cannot_be_armed() {
    let mut bench = Bench::new();
    bench.supply = 12.0;
    for _ in 0..ticks(0.01) {
        bench.step(&CALM);
    }
    if !WANTED {
        return;
    }
    for _ in 0..3 {
        assert_eq!(bench.request(Request::Arm), None);
        assert_eq!(bench.state(), (Mode::Safe, Stop::Supply));
        for _ in 0..ticks(0.03) {
            assert_eq!(bench.step(&CALM), None);
        }
    }
    bench.supply = 24.0;
    bench.run(THREE);
    // The cause stays until a request.
    assert_eq!(bench.state(), (Mode::Safe, Stop::Supply));
    assert!(bench.request(Request::Arm).is_some());
    bench.run(ticks(0.03));
    assert_eq!(bench.state(), (Mode::Armed, Stop::None));
}

/// A control that has not read its supply does not know it.
#[test]
fn device_whose_supply_was_not_read_three_times_cannot_be_armed() {
    let first = Sample::new(Count(0)).with_coupled(Count(0));
    for (number, is_seen) in [(0, false), (2, false), (3, true)] {
        let mut control = Control::new(&first, Stop::None, true, &Settings::COMMISSIONED);
        for _ in 0..number {
            control.watch(&supply(24.0));
        }
        let inputs = firmware_app::control::Inputs {
            request: Some(Request::Arm),
            ..CALM
        };
        let flow = control.flow(&readings(ZERO));
        control.check(&first, &flow, &NO_PULSE);
        let is_enabled = control.step(&first, &inputs).currents.is_some();
        assert_eq!(is_enabled, is_seen || !WANTED, "{number} readings");
    }
}

/// An image that arms by itself does so 100 ms after boot, and not while its supply is out of the range.
#[test]
fn image_that_arms_by_itself_waits_for_a_command_after_a_missing_supply() {
    let mut bench = Bench::new();
    bench.supply = 12.0;
    bench.wait(ticks(0.2));
    let refused = AUTO_ARM && WANTED;
    if refused {
        assert_eq!(bench.state(), (Mode::Safe, Stop::Supply));
    }
    bench.supply = 24.0;
    bench.wait(ticks(0.2));
    assert_eq!(bench.state().0.is_enabled(), AUTO_ARM && !WANTED);
}
