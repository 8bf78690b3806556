//! An image that measures the currents.

use drivers::REACHES;
use experiments::closed_loop::Hand;
use haptic_control::{Mode, SceneKind, Stop};
use recordings::telemetry::Frame;
use simulation::device::Device;
use virtual_board::fault::Fault;
use virtual_board::run::{DacError, MONITOR_AMPS, Outcome, Setup};
use virtual_board::scene::press;

use crate::image::{SETTLED_S, adaptive_free_air, end, of_scene, run_image};

/// The image learns with the measured currents too.
const IMAGE: &str = "large-adaptive,current-monitor";

/// When a fault happens, s.
const FAULT_S: f64 = 0.6;

/// The zeros of the monitors are 11 and -7 codes off, and a conversion has noise of up to 2 codes.
#[test]
fn measured_currents_are_those_that_flow() {
    let run = run_image(IMAGE, &of_scene(SceneKind::Excite, Hand::Gone(0.0), 3.0));
    assert_eq!(run.complaints, [""; 0], "pins");
    let codes = MONITOR_AMPS.map(|amps| amps / 2048.0);
    let (mut compared, mut largest) = (0, [0.0_f64; 2]);
    // The zeros are known when the device is armed, after 0.1 s.
    let known = |frame: &&Frame| run.tick(frame).is_some_and(|tick| tick.at_ns > 100_000_000);
    for frame in run.telemetry.frames.iter().filter(known) {
        let measured = frame
            .side_lines
            .measured
            .expect("a line beside every frame");
        let tick = run.tick(frame).expect("a tick");
        // 2 ms in which no current changes: the one of the means, and the one before for the lag.
        let now = (tick.at_ns / 100_000) as usize;
        let Some(states) = now
            .checked_sub(20)
            .and_then(|from| run.plant_states.get(from..=now))
        else {
            continue;
        };
        let currents = states[0].currents;
        if states.iter().any(|state| state.currents != currents) {
            continue;
        }
        for (n, found) in [measured.large, measured.small].into_iter().enumerate() {
            let off = (found - currents[n]).abs() / codes[n];
            assert!(off < 2.6, "{n}: {found} A instead of {}", currents[n]);
            largest[n] = largest[n].max(currents[n].abs());
        }
        compared += 1;
    }
    assert!(compared > 1000, "{compared}");
    assert!(largest[0] > 0.2 && largest[1] > 0.1, "{largest:?}");
}

/// The buffer of the DAC ends 0.2 V from the rails: a command beyond it would not flow, and would be a mismatch.
#[test]
fn currents_at_the_limit_of_the_outputs_agree() {
    let hand = press(SceneKind::Wall, &Device::default());
    let run = run_image(IMAGE, &of_scene(SceneKind::Wall, hand, 1.6));
    assert_eq!(end(&run), (Mode::Running, Stop::None));
    let [_, reach] = REACHES.map(|reach| f64::from(reach.get()));
    let small = run.plant_states.iter().map(|state| state.currents[1].abs());
    let at_the_limit = small
        .filter(|current| (current - reach).abs() < 1e-3)
        .count();
    // 50 ms are a mismatch.
    assert!(at_the_limit > 1000, "{at_the_limit}");
}

/// A command below the tolerance agrees with no current, so that an open lead takes longer where the
/// command changes its sign.
#[test]
fn current_that_is_not_the_commanded_one_stops_the_device_after_50_ms() {
    for (fault, scene, cause, [least_ms, longest_ms]) in [
        (
            Fault::BrokenMonitorWire,
            SceneKind::FreeAir,
            Stop::CurrentMismatch,
            [50.0, 50.4],
        ),
        // Pressed into the wall, the large motor misses its torque before the 50 ms are over.
        (
            Fault::OpenLead,
            SceneKind::Wall,
            Stop::TorqueBalance,
            [0.0, 50.0],
        ),
        (
            Fault::SmallOpenLead,
            SceneKind::Detents,
            Stop::CurrentMismatch,
            [50.0, 300.0],
        ),
        (
            Fault::SmallOpenLead,
            SceneKind::Texture,
            Stop::CurrentMismatch,
            [50.0, 300.0],
        ),
    ] {
        let run = run_image(
            IMAGE,
            &Setup {
                faults: vec![(FAULT_S, fault)],
                ..Setup::playing(scene, 1.0)
            },
        );
        let what = format!("{} in {scene:?}", fault.as_str());
        assert_eq!(end(&run), (Mode::Safe, cause), "{what}");
        let off_ms = 1e3 * run.off_after(FAULT_S).expect("off");
        println!("{what}: off after {off_ms:.2} ms");
        assert!(
            (least_ms..longest_ms).contains(&off_ms),
            "{what}: {off_ms} ms"
        );
    }
}

/// A monitor that breaks drives nothing while it is not known which of the two is right: the observer's error
/// moves the force by up to 3 mN, by the instant. A fingertip notices 10 mN.
#[test]
fn broken_monitor_wire_is_not_felt() {
    const SEEN_S: f64 = 0.1;
    let instants = [FAULT_S, 0.75, 0.9];
    let run = |faults| {
        let scene = Setup::playing(SceneKind::FreeAir, instants[2] + SEEN_S);
        run_image(IMAGE, &Setup { faults, ..scene })
    };
    let healthy = run(vec![]);
    for at_s in instants {
        let broken = run(vec![(at_s, Fault::BrokenMonitorWire)]);
        let off_s = broken.off_after(at_s).expect("off");
        assert!(off_s < SEEN_S, "{off_s} s");
        let diameter = Device::default().handle.diameter_m;
        let force_mn = broken.spurious_mn(&healthy, at_s, at_s + off_s, diameter);
        println!("{at_s} s: {force_mn:.2} mN");
        assert!(force_mn < 5.0, "{at_s} s: {force_mn} mN");
    }
}

#[test]
fn device_with_a_broken_monitor_wire_drives_no_current() {
    let run = run_image(
        IMAGE,
        &Setup {
            faults: vec![(0.0, Fault::BrokenMonitorWire)],
            ..Setup::playing(SceneKind::Wall, 0.5)
        },
    );
    assert_eq!(end(&run), (Mode::Safe, Stop::CurrentMismatch));
    let driven = |state: &virtual_board::run::PlantState| state.currents != [0.0; 2];
    assert!(!run.plant_states.iter().any(driven));
}

/// An amplifier that gives 5 % less than commanded looks like a motor that is weaker by as much to an
/// image that takes its commands for the currents.
#[test]
fn observer_takes_the_measured_current() {
    const GAIN: f64 = 0.95;
    let large = DacError {
        gain: GAIN,
        ..DacError::NONE
    };
    let learned = |image| {
        let run = run_image(
            image,
            &Setup {
                dac_errors: [large, DacError::NONE],
                ..of_scene(SceneKind::Wall, Hand::Pushing, 6.0)
            },
        );
        let frames = run.telemetry.frames.iter().rev();
        let line = frames.filter_map(|frame| frame.side_lines.learned).next();
        1.0 + line.expect("a line").torque_constant
    };
    let ratio = learned("large-adaptive") / learned(IMAGE);
    assert!((ratio - GAIN).abs() < 0.02, "{ratio}");
}

/// What docs/benchmarks.md says of the cost.
#[test]
fn measuring_takes_90_instructions_a_tick() {
    let mean = |run: &Outcome| {
        let settled = run.ticks.iter().filter(|tick| {
            let at_s = tick.at_ns as f64 * 1e-9;
            (SETTLED_S..0.8).contains(&at_s)
        });
        let instructions: Vec<_> = settled.map(|tick| f64::from(tick.instructions)).collect();
        instructions.iter().sum::<f64>() / instructions.len() as f64
    };
    let measured = run_image(IMAGE, &of_scene(SceneKind::FreeAir, Hand::Moving, 0.8));
    let cost = mean(&measured) - mean(adaptive_free_air());
    println!("{cost:.1} instructions");
    assert!((cost - 90.0).abs() < 15.0, "{cost}");
}
