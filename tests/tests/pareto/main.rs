//! The table of run time against error in docs/benchmarks.md, measured again.
//!
//! `UPDATE_GOLDEN=1 cargo pareto` writes it anew.

mod bound;

use std::path::Path;

use pareto::{measure, table};

fn docs() -> String {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs/benchmarks.md");
    std::fs::read_to_string(path).expect("docs/benchmarks.md")
}

#[test]
fn run_time_and_error_are_what_the_table_says() {
    // Also fails where the board and the host differ in a bit of any velocity.
    let rows = measure::measure().unwrap();
    let moved = table::moved(&docs(), &rows).unwrap();
    assert!(
        moved.is_empty(),
        "{}\nif that is meant, UPDATE_GOLDEN=1 cargo pareto writes the table anew",
        moved.join("\n")
    );

    // What is claimed of ours, beyond the figures: peers on the same model cost twice as much and
    // err the same.
    let row = |name: &str| rows.iter().find(|row| row.name == name).expect("a row");
    let ours = row("kalman-triple");
    for peer in rows.iter().filter(|row| row.peer) {
        assert!(peer.cost[0].mean > 1.5 * ours.cost[0].mean, "{}", peer.name);
        for (theirs, ours) in peer.rms_rad_s.iter().zip(ours.rms_rad_s) {
            assert!((theirs - ours).abs() < 1e-3 * ours, "{}", peer.name);
        }
    }
    for row in rows.iter().filter(|row| row.name.starts_with("foaw")) {
        assert!(row.cost[0].at_rest <= 30.0, "{}: at rest", row.name);
    }

    // The comparison sees a figure that moves, either way.
    for factor in [0.8, 1.25] {
        let mut broken = rows.clone();
        broken[2].cost[0].mean *= factor;
        assert_eq!(table::moved(&docs(), &broken).unwrap().len(), 1);
    }
}
