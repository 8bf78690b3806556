//! Faults, and runs on other devices.

use measured::Row;
use measured::tables::{ROBUSTNESS, SCENE_FAULT_FORCE, SCENE_FAULT_TIME};

use crate::{between, number, of, rows, says, span, whole};

/// Faults of the large motor and its encoder.
const OF_LARGE: [&str; 3] = ["stuck-both", "swapped", "open-lead"];

fn scene(row: &Row) -> &str {
    row.text("scene").expect("a scene")
}

/// Scenes without the large motor.
fn has_no_large(row: &Row) -> bool {
    ["detents", "texture"].contains(&scene(row))
}

#[test]
fn faults_in_scenes_end_as_the_statements_say() {
    let [times, forces] = [SCENE_FAULT_TIME, SCENE_FAULT_FORCE].map(|table| rows(&table));
    for (time, force) in times.iter().zip(&forces) {
        let scene = scene(time);
        for fault in ["emergency-stop", "amplifier-fault", "hung-control"] {
            assert!(number(time, fault) < Some(2.0), "{scene}: {fault}");
        }
        for fault in OF_LARGE {
            // It ends the scene, or nobody feels it.
            assert_eq!(
                number(time, fault).is_some(),
                !has_no_large(time),
                "{scene}: {fault}"
            );
            assert_eq!(
                number(force, fault) > Some(0.0),
                !has_no_large(time),
                "{scene}: {fault}"
            );
        }
        let backwards = number(time, "small-swapped").is_some();
        let turns = !["viscous", "friction", "detents", "texture"].contains(&scene);
        assert_eq!(backwards, turns, "{scene}");
        let still = number(time, "small-stuck").is_some();
        assert_eq!(
            still,
            ["wall", "spring-damper", "hold"].contains(&scene),
            "{scene}"
        );
        for fault in ["small-reversed", "small-open-lead"] {
            assert_eq!(time.text(fault), Ok("on"), "{scene}: {fault}");
        }
    }
    let until = forces
        .iter()
        .flat_map(|row| OF_LARGE.map(|fault| row.number(fault).unwrap()));
    let [_, most] = span(until);
    says(
        "docs/faults.md",
        &[format!(
            "a press of 10 N differs by up to {:.1} N",
            1e-3 * most
        )],
    );
}

/// These faults end a push into the wall by the balance of the torques.
#[test]
fn balance_of_the_torques_takes_the_time_of_the_statement() {
    let rows = rows(&SCENE_FAULT_TIME);
    let faults = ["stuck-both", "open-lead", "small-stuck", "small-swapped"];
    let times = span(faults.map(|fault| of(&rows, "wall", fault)));
    let said = format!("| {} ms of motion |", between(whole(times)));
    says("docs/board.md", &[said]);
}

#[test]
fn stopped_runs_are_those_of_a_fast_handle() {
    for row in rows(&ROBUSTNESS) {
        let figure = |column: &str| row.number(column).unwrap();
        assert!(figure("violated") == 0.0, "{}", scene(&row));
        let is_fast = figure("handle_most") > 30.0;
        assert_eq!(figure("stopped") > 0.0, is_fast, "{}", scene(&row));
    }
}
