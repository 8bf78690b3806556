//! Measured currents: zeros, means, and disagreement with the commands.

use std::f64::consts::TAU;

use estimator_core::{Amps, Hertz};
use haptic_control::{Ammeters, AmmetersState, Currents, DualStage, Flow, Stop};

const DEVICE: DualStage = DualStage::DEFAULT;
const RATE: Hertz = Hertz(10e3);
const AMMETERS: Ammeters = Ammeters::new(&DEVICE, RATE);
/// Ticks of 10 ms and of 50 ms.
const WAIT: usize = 100;
const SPAN: usize = 500;

fn currents([large, small]: [f64; 2]) -> Currents {
    Currents {
        large: Amps::new(large as f32),
        small: Amps::new(small as f32),
    }
}

/// Largest difference that agrees, A.
fn tolerances() -> [f64; 2] {
    [DEVICE.large, DEVICE.small].map(|motor| 0.08 * motor.current_limit)
}

/// The state of a device that is being armed, after monitors without an error.
fn armed(ammeters: &Ammeters) -> AmmetersState {
    let mut state = AmmetersState::START;
    for _ in 0..WAIT * 3 {
        ammeters.update(&mut state, &Currents::default(), None);
    }
    state.restart();
    state.take_means();
    state
}

/// Ticks until the mismatch, if one comes within `seconds`.
fn mismatch(
    rate: Hertz,
    seconds: f64,
    mut readings_and_commands: impl FnMut(f64) -> [[f64; 2]; 2],
) -> Option<usize> {
    let ammeters = Ammeters::new(&DEVICE, rate);
    let mut state = armed(&ammeters);
    (0..(seconds * rate.0) as usize).find(|tick| {
        let [readings, commands] = readings_and_commands(*tick as f64 / rate.0);
        let command = currents(commands);
        let flow = ammeters.update(&mut state, &currents(readings), Some(&command));
        assert!(flow.mismatch.is_none() || flow.mismatch == Some(Stop::CurrentMismatch));
        flow.mismatch.is_some()
    })
}

#[test]
fn constant_difference_stops_after_50_ms_if_it_is_above_the_tolerance() {
    for rate in [1e3, 10e3, 20e3].map(Hertz) {
        let expected = (0.05 * rate.0) as usize;
        for motor in [0, 1] {
            for sign in [1.0, -1.0] {
                let found = |part: f64| {
                    let mut readings = [0.4, -0.1];
                    readings[motor] += sign * part * tolerances()[motor];
                    mismatch(rate, 1.0, |_| [readings, [0.4, -0.1]])
                };
                assert_eq!(found(1.01), Some(expected), "{motor} {sign}");
                assert_eq!(found(0.99), None, "{motor} {sign}");
            }
        }
    }
}

/// A sine agrees while it is below the tolerance: for 2 asin(tolerance / amplitude) / π of the time. The
/// count grows by the rest less this part.
#[test]
fn open_lead_is_found_under_a_command_that_swings_through_zero() {
    for (motor, amplitude) in [(0, 1.2), (1, 0.3)] {
        let agrees = (tolerances()[motor] / amplitude).asin() * 4.0 / TAU;
        let expected = SPAN as f64 / (1.0 - 2.0 * agrees);
        let found = mismatch(RATE, 1.0, |t| {
            let mut commands = [0.0; 2];
            commands[motor] = amplitude * (TAU * 20.0 * t).sin();
            [[0.0; 2], commands]
        });
        // Half a swing of 20 Hz is 250 ticks.
        let off = (found.expect("a mismatch") as f64 - expected).abs();
        assert!(off < 250.0, "{motor}: {found:?}, {expected}");
    }
}

/// The amplifiers follow by a first-order lag of 80 us, and steps over the whole range every 2 ms
/// disagree for less than half of the time.
#[test]
fn amplifier_that_lags_behind_large_steps_agrees() {
    let lag = (-1.0 / (RATE.0 * DEVICE.amplifier_lag())).exp();
    let mut flows = [0.0; 2];
    let found = mismatch(RATE, 10.0, |t| {
        let sign = if (t / 2e-3) as u32 % 2 == 0 {
            1.0
        } else {
            -1.0
        };
        let commands = [DEVICE.large, DEVICE.small].map(|motor| sign * motor.current_limit);
        for (flow, command) in flows.iter_mut().zip(commands) {
            *flow = command + (*flow - command) * lag;
        }
        [flows, commands]
    });
    assert_eq!(found, None);
}

#[test]
fn zero_is_the_mean_while_the_amplifiers_are_disabled() {
    let mut state = AmmetersState::START;
    // The current falls for 10 ms, and is no part of the mean.
    for _ in 0..WAIT {
        AMMETERS.update(&mut state, &currents([3.0, 1.0]), None);
    }
    for tick in 0..SPAN {
        let noise = if tick % 2 == 0 { 0.02 } else { -0.02 };
        AMMETERS.update(&mut state, &currents([0.3 + noise, -0.05 + noise]), None);
    }
    let commands = currents([1.0, 0.5]);
    let exact = currents([1.3, 0.45]);
    let mut flow = Flow::default();
    for _ in 0..2 {
        flow = AMMETERS.update(&mut state, &exact, Some(&commands));
    }
    for (found, expected) in [
        (flow.currents.large.get(), 1.0),
        (flow.currents.small.get(), 0.5),
    ] {
        assert!((found - expected).abs() < 1e-4, "{found}");
    }
    // Enabled amplifiers leave the zeros as they are.
    for _ in 0..10 * SPAN {
        AMMETERS.update(&mut state, &currents([1.4, 0.45]), Some(&commands));
    }
    let large = AMMETERS
        .update(&mut state, &exact, Some(&commands))
        .currents
        .large;
    assert!((large.get() - 1.05).abs() < 1e-4, "{large:?}");
}

#[test]
fn monitor_that_is_not_connected_is_a_mismatch_of_disabled_amplifiers() {
    let mut state = AmmetersState::START;
    let low = currents([-7.5, 0.0]);
    let update = |state: &mut _| AMMETERS.update(state, &low, None).mismatch.is_some();
    let ticks = (0..2000).take_while(|_| !update(&mut state)).count();
    assert_eq!(ticks, SPAN);
    // A start does not wait for it again.
    state.restart();
    assert!(update(&mut state));
}

#[test]
fn start_forgets_currents_that_were_not_the_commanded_ones() {
    let mut state = armed(&AMMETERS);
    let command = currents([1.0, 0.0]);
    let mut ticks = || {
        let update = |state: &mut _| AMMETERS.update(state, &currents([0.0; 2]), Some(&command));
        let ticks = (0..2000).take_while(|_| update(&mut state).mismatch.is_none());
        let ticks = ticks.count();
        state.restart();
        ticks
    };
    assert_eq!([ticks(), ticks()], [SPAN; 2]);
}

#[test]
fn disagreement_of_the_past_is_counted_down() {
    let mut state = armed(&AMMETERS);
    let mut after = |ticks, reading| {
        let flows = (0..ticks).map(|_| {
            AMMETERS.update(
                &mut state,
                &currents([reading, 0.0]),
                Some(&currents([0.0; 2])),
            )
        });
        flows.last().unwrap().mismatch.is_some()
    };
    assert!(after(100_000, 1.0));
    assert!(after(1, 1.0));
    assert!(!after(1, 0.0));
    assert!(!after(SPAN, 0.0));
    assert!(!after(SPAN, 1.0));
    assert!(after(1, 1.0));
}

/// A monitor that breaks must not drive what takes the currents.
#[test]
fn current_that_disagrees_is_replaced_by_the_command() {
    let mut state = armed(&AMMETERS);
    let command = currents([0.25, -0.1]);
    for (readings, expected) in [
        ([0.25, -0.1], [0.125, -0.05]),
        ([-7.5, -0.1], [0.25, -0.1]),
        ([0.25, 1.8], [0.25, -0.1]),
    ] {
        let flow = AMMETERS.update(&mut state, &currents(readings), Some(&command));
        assert_eq!(flow.currents, currents(expected));
        assert_eq!(state.take_means(), currents(readings));
    }
}

#[test]
fn reported_current_is_the_mean_since_the_last_report() {
    let mut state = armed(&AMMETERS);
    for readings in [[0.0, 0.25], [0.5, -0.25], [1.0, -0.75]] {
        AMMETERS.update(&mut state, &currents(readings), Some(&currents(readings)));
    }
    assert_eq!(state.take_means(), currents([0.5, -0.25]));
    assert_eq!(state.take_means(), currents([0.0, 0.0]));
}

#[test]
fn mismatch_is_that_of_the_latest_tick() {
    let mut state = armed(&AMMETERS);
    let off = currents([1.0, 0.0]);
    for _ in 0..2 * SPAN {
        let flow = AMMETERS.update(&mut state, &off, Some(&Currents::default()));
        assert_eq!(AMMETERS.mismatch(&state), flow.mismatch);
    }
    assert_eq!(AMMETERS.mismatch(&state), Some(Stop::CurrentMismatch));
    // The amplifiers are disabled, and no current flows.
    AMMETERS.update(&mut state, &Currents::default(), None);
    assert_eq!(AMMETERS.mismatch(&state), None);
}

#[test]
fn current_of_a_period_is_the_mean_of_its_ends() {
    let mut state = armed(&AMMETERS);
    for k in 0..20 {
        let reading = [0.01 * f64::from(k), -0.02 * f64::from(k)];
        let flow = AMMETERS.update(&mut state, &currents(reading), Some(&currents(reading)));
        if k > 0 {
            let middle = f64::from(k) - 0.5;
            let off = [
                f64::from(flow.currents.large.get()) - 0.01 * middle,
                f64::from(flow.currents.small.get()) + 0.02 * middle,
            ];
            assert!(off.iter().all(|x| x.abs() < 1e-6), "{off:?}");
        }
    }
}

/// A device that is armed right after its boot does not know the zeros.
#[test]
fn currents_are_not_taken_before_the_zeros_are_known() {
    let mut state = AmmetersState::START;
    let command = currents([0.25, -0.1]);
    let mut update = |readings| AMMETERS.update(&mut state, &readings, Some(&command));
    for tick in 0..SPAN {
        let flow = update(currents([0.3, -0.15]));
        assert_eq!(flow.mismatch, None, "{tick}");
        assert!(tick == 0 || flow.currents == command);
    }
    assert_eq!(update(command).mismatch, Some(Stop::CurrentMismatch));
}

/// The current of a motor flows on for 10 ms after its amplifier is disabled.
#[test]
fn zeros_are_readings_from_10_ms_after_disabling_on() {
    // Nothing would agree with a zero of this size.
    let flowing = currents([1.0, 0.5]);
    let zero = currents([0.02, -0.01]);
    let command = currents([0.4, 0.2]);
    let reading = currents([0.42, 0.19]);
    let mut enabled = armed(&AMMETERS);
    AMMETERS.update(&mut enabled, &reading, Some(&command));
    let agrees = |before: AmmetersState, flowing_ticks: usize| {
        let mut state = before;
        for tick in 0..=WAIT {
            let reading = if tick < flowing_ticks { flowing } else { zero };
            AMMETERS.update(&mut state, &reading, None);
        }
        state.restart();
        (0..=SPAN).all(|_| {
            AMMETERS
                .update(&mut state, &reading, Some(&command))
                .mismatch
                .is_none()
        })
    };
    for before in [AmmetersState::START, enabled] {
        assert!(agrees(before, WAIT));
        assert!(!agrees(before, WAIT + 1));
    }
}

/// The zero moves with the temperature of the amplifier: after 50 ms 1/e of a step is left.
#[test]
fn zero_follows_a_drift_however_long_the_device_has_been_disabled() {
    let mut state = AmmetersState::START;
    for _ in 0..100 * SPAN {
        AMMETERS.update(&mut state, &Currents::default(), None);
    }
    let drifted = currents([0.1, -0.02]);
    for _ in 0..SPAN {
        AMMETERS.update(&mut state, &drifted, None);
    }
    state.take_means();
    AMMETERS.update(&mut state, &drifted, None);
    let means = state.take_means();
    let left = [means.large.get() / 0.1, means.small.get() / -0.02];
    let expected = (-1.0_f32).exp();
    assert!(
        left.iter().all(|part| (part - expected).abs() < 0.01),
        "{left:?}"
    );
}
