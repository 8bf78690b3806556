//! Faults in every scene and on both stages, while the hand presses with up to 10 N.

use haptic_control::{Mode, SceneKind, Stop};
use measured::tables::{SCENE_FAULT_FORCE, SCENE_FAULT_TIME};
use rayon::prelude::*;
use simulation::device::Device;
use virtual_board::fault::Fault;
use virtual_board::run::{Outcome, Setup};
use virtual_board::scene::press;

use crate::image::{of_scene, run};

/// The hand is in the middle of its press, which takes 0.8 s, s.
const FAULT_S: f64 = 0.5;

/// Faults that hardware or the next control ticks find, with the longest time until the amplifiers are off,
/// ms: a step of the lockstep, a tick and a step, and 16 periods of the enables' timer.
const ELECTRICAL: [(Fault, Stop, f64); 3] = [
    (Fault::EmergencyStop, Stop::Interlock, 0.05),
    (Fault::AmplifierFault, Stop::AmplifierFault, 0.15),
    (Fault::HungControl, Stop::Watchdog, 1.65),
];
/// The watchdog has reset the chip, and the boot line is logged, s.
const ELECTRICAL_S: f64 = 0.1;

/// Faults of the large motor and its encoder.
const LARGE: [Fault; 3] = [Fault::StuckBoth, Fault::Swapped, Fault::OpenLead];
/// Faults of the small motor and its encoder.
const SMALL: [Fault; 4] = [
    Fault::SmallStuck,
    Fault::SmallSwapped,
    Fault::SmallReversed,
    Fault::SmallOpenLead,
];
/// Time for a fault of a motor or encoder, s.
const MECHANICAL_S: f64 = 0.3;
/// Longest time until a fault of the large motor stops a scene that drives it, ms: until the current is one
/// that should move it, and then 50 ms.
const LARGE_MS: f64 = 250.0;

/// Scenes in which the hand moves the handle and the large motor turns, so that a handle's encoder that counts
/// backwards is found.
const SWAPPED_FOUND: [SceneKind; 4] = [
    SceneKind::FreeAir,
    SceneKind::Wall,
    SceneKind::SpringDamper,
    SceneKind::Hold,
];

/// What a fault does in a scene.
struct Found {
    off_ms: Option<f64>,
    force_mn: f64,
    last: Option<(Mode, Stop)>,
}

fn pressed(scene: SceneKind, fault: Option<Fault>, watched_s: f64) -> Outcome {
    run(&Setup {
        faults: fault.map(|fault| (FAULT_S, fault)).into_iter().collect(),
        ..of_scene(scene, press(scene, &Device::default()), FAULT_S + watched_s)
    })
}

fn found(scene: SceneKind, fault: Fault, watched_s: f64, healthy: &Outcome) -> Found {
    let run = pressed(scene, Some(fault), watched_s);
    let off_s = run.off_after(FAULT_S);
    let until = FAULT_S + off_s.unwrap_or(watched_s);
    let diameter = Device::default().handle.diameter_m;
    let last = run.telemetry.frames.last();
    Found {
        off_ms: off_s.map(|s| 1e3 * s),
        force_mn: run.spurious_mn(healthy, FAULT_S, until, diameter),
        last: last.map(|frame| (frame.state, frame.cause)),
    }
}

/// All faults, in the order of the columns, with the time that they are watched.
fn faults() -> impl Iterator<Item = (Fault, f64)> {
    let electrical = ELECTRICAL.iter().map(|(fault, ..)| (*fault, ELECTRICAL_S));
    let mechanical = LARGE.iter().chain(&SMALL);
    electrical.chain(mechanical.map(|fault| (*fault, MECHANICAL_S)))
}

fn bounds_hold(scene: SceneKind, row: &[Found]) {
    for ((fault, cause, most_ms), found) in ELECTRICAL.iter().zip(row) {
        let name = format!("{scene}, {}", fault.as_str());
        assert_eq!(found.last, Some((Mode::Safe, *cause)), "{name}");
        assert!(found.off_ms.is_some_and(|ms| ms <= *most_ms), "{name}");
    }
    for (fault, found) in LARGE.iter().zip(&row[ELECTRICAL.len()..]) {
        let name = format!("{scene}, {}", fault.as_str());
        if scene.facts().needs.continuous {
            let found_it = [Stop::Stall, Stop::RunawayDirection, Stop::TorqueBalance]
                .map(|cause| Some((Mode::Safe, cause)))
                .contains(&found.last);
            assert!(found_it, "{name}: {:?}", found.last);
            assert!(found.off_ms.is_some_and(|ms| ms <= LARGE_MS), "{name}");
        } else {
            // The large motor has no current, and the hand does not feel it.
            assert_eq!((found.off_ms, found.force_mn), (None, 0.0), "{name}");
        }
    }
    for (fault, found) in SMALL.iter().zip(&row[ELECTRICAL.len() + LARGE.len()..]) {
        let name = format!("{scene}, {}", fault.as_str());
        let balance = Some((Mode::Safe, Stop::TorqueBalance));
        if *fault == Fault::SmallSwapped && SWAPPED_FOUND.contains(&scene) {
            assert_eq!(found.last, balance, "{name}");
        } else {
            // It depends on the speeds.
            let found_or_not = [balance, Some((Mode::Running, Stop::None))];
            assert!(
                found_or_not.contains(&found.last),
                "{name}: {:?}",
                found.last
            );
        }
    }
}

#[test]
fn faults_have_their_documented_effect_in_every_scene() {
    let scenes: Vec<_> = SceneKind::environments()
        .filter(|scene| *scene != SceneKind::Off)
        .collect();
    let row = |scene: &SceneKind| {
        let healthy = pressed(*scene, None, MECHANICAL_S);
        faults()
            .map(|(fault, watched_s)| found(*scene, fault, watched_s, &healthy))
            .collect()
    };
    let rows: Vec<Vec<Found>> = scenes.par_iter().map(row).collect();
    for (scene, row) in scenes.iter().zip(&rows) {
        bounds_hold(*scene, row);
    }
    let names = SCENE_FAULT_TIME.columns.iter().skip(1);
    assert!(
        names
            .map(|(name, _)| *name)
            .eq(faults().map(|(fault, _)| fault.as_str()))
    );
    let cells = |cell: fn(&Found) -> String| -> Vec<Vec<String>> {
        let rows = scenes.iter().zip(&rows);
        rows.map(|(scene, row)| {
            std::iter::once(scene.to_string())
                .chain(row.iter().map(cell))
                .collect()
        })
        .collect()
    };
    let off = cells(|found| {
        found
            .off_ms
            .map_or("on".to_owned(), |ms| format!("{ms:.2}"))
    });
    let force = cells(|found| format!("{:.1}", found.force_mn));
    // A tick, and a twentieth of what a fingertip notices.
    for (table, cells, slack) in [
        (SCENE_FAULT_TIME, off, 0.1_f64),
        (SCENE_FAULT_FORCE, force, 0.5),
    ] {
        let same = |_: &str, then: f64, now: f64| (then - now).abs() <= slack.max(0.1 * then);
        let checked = table.check(&[], &cells, same);
        checked.unwrap_or_else(|error| panic!("{error}"));
    }
}
