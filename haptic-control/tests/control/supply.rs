//! The supply's voltage against its range.

use estimator_core::Hertz;
use haptic_control::{Supply, SupplyFinding as _, SupplyState, Volts};

const LOW: f32 = 20.4;
const HIGH: f32 = 28.8;
/// Readings of telemetry.
const SUPPLY: Supply = Supply::new(Supply::RANGE_24_V, Hertz(1e3));

/// Whether the supply is outside after each of these readings, from a state.
fn outside(supply: &Supply, state: &mut SupplyState, readings: &[f32]) -> Vec<bool> {
    let after = |voltage: &f32| {
        supply.update(state, Volts(*voltage));
        state.is_outside()
    };
    readings.iter().map(after).collect()
}

/// A supply that has been inside for long.
fn inside() -> SupplyState {
    let mut state = SupplyState::START;
    let outside = outside(&SUPPLY, &mut state, &[24.0; 300]);
    assert_eq!(outside.last(), Some(&false));
    state
}

/// 15 % below and 20 % above 24 V.
#[test]
fn range_of_24_v_is_that_of_the_standard() {
    let [low, high] = Supply::RANGE_24_V.map(f64::from);
    assert!((low / (0.85 * 24.0) - 1.0).abs() < 1e-6, "{low}");
    assert!((high / (1.2 * 24.0) - 1.0).abs() < 1e-6, "{high}");
}

#[test]
fn both_ends_of_the_range_are_inside_and_what_is_beyond_or_no_number_is_outside() {
    for voltage in [LOW, 24.0, HIGH] {
        assert_eq!(outside(&SUPPLY, &mut inside(), &[voltage; 9]), [false; 9]);
    }
    for voltage in [
        f32::from_bits(LOW.to_bits() - 1),
        0.0,
        -24.0,
        f32::from_bits(HIGH.to_bits() + 1),
        f32::NAN,
        f32::INFINITY,
        f32::NEG_INFINITY,
    ] {
        let found = outside(&SUPPLY, &mut inside(), &[voltage; 4]);
        assert_eq!(found, [false, false, true, true], "{voltage} V");
    }
}

/// Nothing is known of a supply before its first readings.
#[test]
fn supply_is_outside_until_three_readings_are_inside() {
    let mut state = SupplyState::START;
    assert!(state.is_outside());
    let found = outside(&SUPPLY, &mut state, &[24.0; 4]);
    assert_eq!(found, [true, true, false, false]);
    // However long it was outside.
    outside(&SUPPLY, &mut state, &[0.0; 1000]);
    let found = outside(&SUPPLY, &mut state, &[24.0; 4]);
    assert_eq!(found, [true, true, false, false]);
}

#[test]
fn single_readings_outside_change_nothing() {
    let mut state = inside();
    for _ in 0..1000 {
        for noisy in [f32::NAN, 0.0, 36.0] {
            let found = outside(&SUPPLY, &mut state, &[noisy, 24.0]);
            assert_eq!(found, [false; 2]);
        }
    }
}

/// Of two readings outside for one inside, every three leave one more outside.
#[test]
fn readings_outside_that_prevail_are_found_between_readings_inside() {
    let mut state = inside();
    let found = outside(&SUPPLY, &mut state, &[0.0, 0.0, 24.0, 0.0, 0.0]);
    assert_eq!(found, [false, false, false, false, true]);
    // One inside is not enough to leave that.
    let found = outside(&SUPPLY, &mut state, &[24.0, 0.0, 24.0, 24.0, 24.0]);
    assert_eq!(found, [true, true, true, true, false]);
}

/// 3 ms at any rate, and one reading at least.
#[test]
fn time_until_a_supply_is_outside_is_3_ms() {
    for (rate, readings) in [(100.0, 1), (1e3, 3), (10e3, 30), (80e3, 240)] {
        let supply = Supply::new(Supply::RANGE_24_V, Hertz(rate));
        let mut state = SupplyState::START;
        let until = |state: &mut SupplyState, voltage, is: bool| {
            (1..=1000)
                .find(|_| outside(&supply, state, &[voltage]) == [is])
                .expect("found")
        };
        assert_eq!(until(&mut state, 24.0, false), readings, "{rate} Hz");
        assert_eq!(until(&mut state, 30.0, true), readings, "{rate} Hz");
    }
}
