//! The heat of the windings, by the definition of the filter.

use estimator_core::{Amps, Hertz};
use haptic_control::{Currents, DualStage, Stop, Windings, WindingsState};

const DEVICE: DualStage = DualStage::DEFAULT;
/// Time between two looks at the heat, s.
const SLOT_S: f64 = 0.01;

/// The currents with `amps` in one motor, 0 is the large one.
fn only(motor: usize, amps: f64) -> Currents {
    let mut both = [Amps::ZERO; 2];
    both[motor] = Amps::new(amps as f32);
    let [large, small] = both;
    Currents { large, small }
}

/// Continuous current, A, and time constant, s.
fn constants(motor: usize) -> [f64; 2] {
    let motor = [DEVICE.large, DEVICE.small][motor];
    [motor.continuous_current, motor.winding_time_constant]
}

/// Time until the overload, if one comes within `seconds`.
fn overload_s(
    rate: f64,
    state: &mut WindingsState,
    seconds: f64,
    applied: impl Fn(u32) -> Currents,
) -> Option<f64> {
    let windings = Windings::new(&DEVICE, Hertz(rate));
    let tick = (0..(seconds * rate) as u32).find(|tick| {
        let found = windings.check(state, &applied(*tick));
        assert!(found.is_none() || found == Some(Stop::Overload));
        found.is_some()
    })?;
    Some(f64::from(tick) / rate)
}

/// A slot of delay, and a thousandth of the time for the steps of the filter, dt / 2τ, and for
/// rounding, which is 1e-4 of the heat.
fn assert_near(found: Option<f64>, expected: f64, what: &str) {
    let off = (found.expect(what) - expected).abs();
    assert!(
        off < SLOT_S + 2e-3 * expected,
        "{what}: {found:?}, expected {expected}"
    );
}

#[test]
fn constant_current_stops_after_the_time_of_the_definition() {
    for rate in [1e3, 10e3, 20e3] {
        for motor in [0, 1] {
            let [continuous, tau] = constants(motor);
            for ratio in [1.2_f64, 2.0, 2.5] {
                let expected = tau * (1.0 / (1.0 - 1.0 / (ratio * ratio))).ln();
                for sign in [1.0, -1.0] {
                    let current = only(motor, sign * ratio * continuous);
                    let found = overload_s(rate, &mut WindingsState::cold(), 100.0, |_| current);
                    assert_near(found, expected, &format!("{rate} Hz, {motor}, {ratio}"));
                }
            }
        }
    }
}

#[test]
fn current_up_to_the_continuous_one_never_stops() {
    let windings = Windings::new(&DEVICE, Hertz(1e3));
    let both = Currents {
        large: Amps::new((0.999 * DEVICE.large.continuous_current) as f32),
        small: Amps::new((0.999 * DEVICE.small.continuous_current) as f32),
    };
    let mut state = WindingsState::cold();
    // 20 time constants of the slower winding.
    for _ in 0..600_000 {
        assert_eq!(windings.check(&mut state, &both), None);
    }
}

#[test]
fn alternating_current_heats_by_its_mean_square() {
    for motor in [0, 1] {
        let [continuous, tau] = constants(motor);
        let amps = 2.0 * continuous;
        let expected = tau * (4.0_f64 / 3.0).ln();
        let square = |tick: u32| only(motor, if tick % 2 == 0 { amps } else { -amps });
        let found = overload_s(10e3, &mut WindingsState::cold(), 60.0, square);
        assert_near(found, expected, "square wave");
        // The current flows in one tick of four, at twice the amplitude: the same mean square.
        let pulses = |tick: u32| only(motor, if tick % 4 == 0 { 2.0 * amps } else { 0.0 });
        let found = overload_s(10e3, &mut WindingsState::cold(), 60.0, pulses);
        assert_near(found, expected, "pulses");
    }
}

#[test]
fn heat_of_an_earlier_current_shortens_the_time() {
    let [continuous, tau] = constants(1);
    let (limit, square) = (continuous * continuous, 4.0 * continuous * continuous);
    let mut state = WindingsState::cold();
    let first = overload_s(1e3, &mut state, 60.0, |_| only(1, 2.0 * continuous));
    assert_near(first, tau * (4.0_f64 / 3.0).ln(), "from the cold");
    // Half a time constant without current; the overload is over in the next slot.
    let rest = 0.5 * tau;
    let windings = Windings::new(&DEVICE, Hertz(1e3));
    let hot = (0..(rest * 1e3) as u32)
        .filter(|_| windings.check(&mut state, &Currents::default()).is_some())
        .count();
    assert!(hot <= 10, "{hot} ms");
    let heat = limit * (-0.5_f64).exp();
    let expected = tau * ((square - heat) / (square - limit)).ln();
    let again = overload_s(1e3, &mut state, 60.0, |_| only(1, 2.0 * continuous));
    assert_near(again, expected, "again");
}

#[test]
fn current_that_is_not_a_number_is_no_current() {
    let windings = Windings::new(&DEVICE, Hertz(1e3));
    let current = Currents {
        large: Amps::new(f32::NAN),
        small: Amps::new(f32::INFINITY),
    };
    let mut state = WindingsState::cold();
    for _ in 0..1000 {
        assert_eq!(windings.check(&mut state, &current), None);
    }
    assert_eq!(state, WindingsState::cold());
}

#[test]
fn limit_that_is_not_a_number_stops() {
    for set in [
        |device: &mut DualStage| device.large.continuous_current = f64::NAN,
        |device: &mut DualStage| device.small.winding_time_constant = f64::NAN,
    ] {
        let mut device = DEVICE;
        set(&mut device);
        let windings = Windings::new(&device, Hertz(1e3));
        let mut state = WindingsState::cold();
        let stopped = (0..10).find_map(|_| windings.check(&mut state, &Currents::default()));
        assert_eq!(stopped, Some(Stop::Overload));
    }
}
