//! The tables of run time against error and of the control task, measured again.
//!
//! `UPDATE_GOLDEN=1 cargo pareto` writes them anew.

mod bound;

use std::sync::OnceLock;

use bench_image::SUBJECTS;
use estimator_catalogue::ROWS;
use measured::control_rate::{IMAGES, NONE, STEADY};
use measured::tables::{CONTROL, EVIDENCE_COST, PARETO};
use pareto::control::{self, Task};
use pareto::measure::{self, Row};
use pareto::table;

/// The rows of all subjects, measured once for the tests of this binary. Also fails where the board and
/// the host differ in a bit of any velocity, at either level.
fn rows() -> Vec<Row> {
    static ROWS: OnceLock<Vec<Row>> = OnceLock::new();
    ROWS.get_or_init(|| measure::measure().unwrap()).clone()
}

#[test]
fn run_time_error_and_control_rate_agree_with_the_tables() {
    let (mut rows, comparators) = measure::split(rows());
    let tasks = control::measure().unwrap();
    control::rate(&mut rows, &tasks);
    let estimators = (PARETO, table::cells(&rows));
    let control = (CONTROL, control::table::cells(&tasks));
    let comparators = (EVIDENCE_COST, table::cost_cells(&comparators));
    for (table, cells) in [&estimators, &control, &comparators] {
        table
            .check(&[], cells, table::same)
            .unwrap_or_else(|error| panic!("{error}"));
    }
    claims_of_estimators(&rows);
    claims_of_tasks(&tasks, &rows);

    // The comparison sees a figure that moves, either way.
    for factor in [0.8, 1.25] {
        let mut broken = rows.clone();
        broken[2].cost[0].mean *= factor;
        let moved = PARETO.moved(&[], &table::cells(&broken), table::same);
        assert_eq!(moved.unwrap().len(), 1);
        let mut broken = tasks.clone();
        broken[2].cycles.0 *= factor;
        let moved = CONTROL.moved(&[], &control::table::cells(&broken), table::same);
        assert_eq!(moved.unwrap().len(), 1);
    }
}

fn claims_of_estimators(rows: &[Row]) {
    // What is claimed of ours, beyond the figures: peers on the same model cost twice as much and
    // err the same; those with parameters of their own cost more, and err less by nothing that one
    // would notice.
    let row = |name: &str| rows.iter().find(|row| row.name == name).expect("a row");
    let mut peers = 0;
    for peer in rows.iter().filter(|row| row.peer) {
        let (ours, times, least, most) = match &*peer.name {
            "idsp: pll" => (row("pll"), 1.5, 0.95, f64::INFINITY),
            "idsp: low-pass" => (row("low-pass"), 1.1, 0.95, f64::INFINITY),
            _ => (row("kalman-triple"), 1.5, 0.999, 1.001),
        };
        assert!(
            peer.cost[0].mean > times * ours.cost[0].mean,
            "{}",
            peer.name
        );
        for (theirs, ours) in peer.rms_rad_s.iter().zip(ours.rms_rad_s) {
            let ratio = theirs / ours;
            assert!((least..most).contains(&ratio), "{}: {ratio}", peer.name);
        }
        peers += 1;
    }
    assert_eq!(peers, 6);
    for row in rows.iter().filter(|row| row.name.starts_with("foaw")) {
        assert!(row.cost[0].at_rest <= 30.0, "{}: at rest", row.name);
    }
    // Goals of run time that are reached, from the rows of the catalogue.
    let mut goals = 0;
    for subject in SUBJECTS.iter().filter(|subject| !subject.is_peer()) {
        let of_catalogue = ROWS
            .iter()
            .find(|row| row.name == subject.name)
            .expect("a row");
        for goal in of_catalogue.goals {
            if ![0, subject.window].contains(&goal.capacity) {
                continue;
            }
            let cost = row(&subject.to_string()).cost[0];
            assert!(cost.mean <= goal.mean, "{subject}: {cost:?}, {goal:?}");
            assert!(
                f64::from(cost.most) <= goal.longest,
                "{subject}: {cost:?}, {goal:?}"
            );
            goals += 1;
        }
    }
    assert!(goals > 10, "{goals} goals");
    // The loops over the members of a bank and over a window are unrolled at opt-level 3 alone.
    let unrolled = |row: &Row| row.name.starts_with("imm") || row.name.starts_with("algebraic");
    let straight = |row: &&Row| !row.peer && !unrolled(row);
    for row in rows.iter().filter(straight) {
        let [fast, small] = [0, 1].map(|level| row.cost[level].mean);
        assert!(small <= 1.1 * fast, "{}: {small} at s, {fast}", row.name);
    }
}

fn claims_of_tasks(tasks: &[Task], rows: &[Row]) {
    // The rate of the firmware as it is leaves half of the core, in every scene with everybody.
    for task in tasks {
        let [.., most] = task.highest_rates_hz();
        assert!(most > 10e3, "{} with {}", task.scene, task.estimator);
        // As firmware/src/tasks.rs has it: an eighth of the period.
        assert!(task.instructions.1 <= 16_800 / 8, "{}", task.scene);
    }
    let mean = |name: &str, scene: &str| {
        let is_it = |task: &&Task| task.estimator == name && task.scene == scene;
        tasks.iter().find(is_it).expect("a task").instructions.0
    };
    // What a scene does not need it does not pay for. Detents and texture pay for a table or a phase and no
    // estimator; free air for two estimators, the velocity loop and both friction corrections.
    let off = mean(NONE, "off");
    for small in ["detents", "texture"] {
        let more = mean(NONE, small) - off;
        assert!(
            (10.0..200.0).contains(&more),
            "{small}: {more} more than off"
        );
    }
    let air = mean(STEADY, "free-air");
    assert!(air - off > 200.0, "off {off}, free air {air}");
    // A wall or a spring is little of the loop. The filter always costs the same, a window more than it.
    for large in tasks.iter().filter(|task| task.estimator == STEADY) {
        let ratio = large.instructions.0 / air;
        assert!(
            (0.9..1.1).contains(&ratio),
            "{}: {ratio} of free air",
            large.scene
        );
        let window = mean(IMAGES[0].0, &large.scene);
        assert!(large.instructions.0 < window, "{}: {window}", large.scene);
    }
    // The rate by exchange of an update is near that of the image, where there is one.
    for name in ["adaptive", "adaptive-edge"] {
        let row = rows.iter().find(|row| row.name == name).expect("a row");
        let own = tasks.iter().filter(|task| task.estimator == name);
        let lowest = own.map(|task| task.highest_rates_hz()[3]);
        let ratio = row.highest_rate_hz / lowest.fold(f64::INFINITY, f64::min);
        assert!((0.9..1.1).contains(&ratio), "{name}: {ratio}");
    }
}
