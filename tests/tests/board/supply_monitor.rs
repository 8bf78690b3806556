//! An image that reads the supply of the amplifiers.

use haptic_control::{Mode, SceneKind, Stop};
use virtual_board::command::Command;
use virtual_board::fault::Fault;
use virtual_board::run::{Outcome, SUPPLY_FULL_SCALE_V, Setup};

use crate::image::{end, run_image};

/// The converters of the current monitors start beside that of the supply.
const IMAGE: &str = "large-adaptive,current-monitor,supply-monitor";
/// The image of the current monitors' tests.
const WITHOUT: &str = "large-adaptive,current-monitor";

/// When a fault happens, s.
const FAULT_S: f64 = 0.5;

/// The noise of a conversion and half a code, V.
const NOISE_V: f64 = 2.5 * SUPPLY_FULL_SCALE_V / 4096.0;

/// Voltages of the lines from so many s on, each with the time of its tick, s.
fn voltages(run: &Outcome, from_s: f64) -> Vec<(f64, f64)> {
    let lines = run.telemetry.frames.iter().filter_map(|frame| {
        let at_s = run.tick(frame)?.at_ns as f64 * 1e-9;
        Some((at_s, frame.side_lines.supply?))
    });
    lines.filter(|(at_s, _)| *at_s > from_s).collect()
}

#[test]
fn logged_voltage_is_that_of_the_supply() {
    for supply_v in [20.5, 24.0, 28.7] {
        let run = run_image(
            IMAGE,
            &Setup {
                supply_v,
                ..Setup::playing(SceneKind::FreeAir, 0.4)
            },
        );
        assert_eq!(run.complaints, [""; 0], "pins");
        assert_eq!(end(&run), (Mode::Running, Stop::None), "{supply_v} V");
        let found = voltages(&run, 0.05);
        let frames = run.telemetry.frames.len();
        assert!(frames - found.len() < 60, "a line beside every frame");
        for (at_s, volts) in &found {
            assert!(
                (volts - supply_v).abs() < NOISE_V,
                "{volts} V instead of {supply_v} V at {at_s} s"
            );
        }
    }
}

/// Three readings, 1 ms apart, of which the first comes within 1 ms; then the next tick, and a step of the
/// lockstep.
#[test]
fn supply_that_leaves_its_range_stops_the_device_within_3_2_ms() {
    for (fault, volts) in [(Fault::SupplyDrop, 18.0), (Fault::SupplyRise, 31.0)] {
        for at_s in [FAULT_S, FAULT_S + 0.2e-3, FAULT_S + 0.9e-3] {
            let run = run_image(
                IMAGE,
                &Setup {
                    faults: vec![(at_s, fault)],
                    ..Setup::playing(SceneKind::FreeAir, 0.7)
                },
            );
            let what = format!("{} at {at_s} s", fault.as_str());
            assert_eq!(end(&run), (Mode::Safe, Stop::Supply), "{what}");
            let off_ms = 1e3 * run.off_after(at_s).expect("off");
            println!("{what}: off after {off_ms:.2} ms");
            assert!((2.0..3.2).contains(&off_ms), "{what}: {off_ms} ms");
            // The log has the reason.
            let (_, last) = voltages(&run, at_s).pop().expect("a line");
            assert!((last - volts).abs() < NOISE_V, "{what}: {last} V");
        }
    }
}

/// Neither from the start nor after a stop is an amplifier enabled, or a current commanded.
#[test]
fn device_is_not_armed_while_its_supply_is_out_of_the_range() {
    for supply_v in [0.0, 20.3, 28.9] {
        let run = run_image(
            IMAGE,
            &Setup {
                supply_v,
                ..Setup::playing(SceneKind::FreeAir, 0.3)
            },
        );
        assert_eq!(end(&run), (Mode::Safe, Stop::Supply), "{supply_v} V");
        let on = run
            .enables
            .iter()
            .any(|(_, enables)| *enables != [false; 2]);
        assert!(!on, "{supply_v} V: {:?}", run.enables);
        let driven = |state: &virtual_board::run::PlantState| state.currents != [0.0; 2];
        assert!(!run.plant_states.iter().any(driven), "{supply_v} V");
    }
    let again = FAULT_S + 0.1;
    let mut setup = Setup::playing(SceneKind::FreeAir, 0.8);
    setup.faults = vec![(FAULT_S, Fault::SupplyDrop)];
    setup.commands.push((again, Command::Arm));
    let run = run_image(IMAGE, &setup);
    assert_eq!(end(&run), (Mode::Safe, Stop::Supply));
    let (last_ns, enables) = run.enables.last().expect("enables");
    assert_eq!(*enables, [false; 2]);
    assert!((*last_ns as f64) < again * 1e9, "{last_ns} ns");
}

/// The table of faults has both faults in an image without the feature, which goes on.
#[test]
fn image_without_the_feature_reads_no_supply() {
    let setup = Setup {
        faults: vec![(FAULT_S, Fault::SupplyDrop)],
        ..Setup::playing(SceneKind::FreeAir, 0.7)
    };
    let run = run_image(WITHOUT, &setup);
    assert_eq!(end(&run), (Mode::Running, Stop::None));
    assert!(voltages(&run, 0.0).is_empty());
}
