//! Errors on recordings of real devices.

use std::sync::LazyLock;

use catalogue::estimators::Kind;
use measured::tables::{REAL_MOTION, REAL_RESOLUTION};
use serde_json::Value;

use crate::runs::{json, number, text, values};
use crate::{cell, check};

/// The shipped recordings.
const DATA: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../tests/data/real");

/// Scores of all estimators on all recordings at the default resolution and rate.
static RUNS: LazyLock<Vec<Value>> = LazyLock::new(|| json(&["real", "--data", DATA]));

/// RMS error on a recording, % of finite difference: the mean over its phases; `None` if it lacks a
/// signal.
fn on(estimator: &str, recording: &str) -> Option<f64> {
    let is =
        |row: &&Value| text(row, "estimator") == estimator && text(row, "recording") == recording;
    mean(RUNS.iter().filter(is).map(|row| number(row, "rms_pct")))
}

fn mean(figures: impl Iterator<Item = f64>) -> Option<f64> {
    let figures: Vec<f64> = figures.collect();
    (!figures.is_empty()).then(|| figures.iter().sum::<f64>() / figures.len() as f64)
}

/// The recordings of a role, or all of them.
fn recordings(role: Option<&str>) -> Vec<&'static str> {
    let has_role = |name: &&str| {
        let row = RUNS
            .iter()
            .find(|row| text(row, "recording") == *name)
            .unwrap();
        role.is_none_or(|role| text(row, "role") == role)
    };
    values(&RUNS, "recording")
        .into_iter()
        .filter(has_role)
        .collect()
}

/// Means over all recordings and over those with which no constant was chosen, as cells.
pub(crate) fn pooled(estimator: &str) -> [String; 2] {
    [None, Some("judges")].map(|role| {
        let figures = recordings(role)
            .into_iter()
            .filter_map(|name| on(estimator, name));
        shown(mean(figures))
    })
}

fn shown(figure: Option<f64>) -> String {
    figure.map_or_else(|| "-".to_owned(), cell)
}

#[test]
fn table_of_real_motion_has_every_estimator_and_recording() {
    let names = recordings(None);
    assert_eq!((names.len(), recordings(Some("judges")).len()), (11, 6));
    let row = |kind: &Kind| {
        let each = names.iter().map(|name| shown(on(kind.name, name)));
        let figures = pooled(kind.name).into_iter().chain(each);
        [kind.name.to_owned()].into_iter().chain(figures).collect()
    };
    let rows: Vec<_> = Kind::all().iter().map(row).collect();
    check(&REAL_MOTION, &names, &rows);
}

/// A bank beside the other estimators, from what it reads: its mean error over the recordings of fine
/// encoders, and where the ratio to the smallest error of the others is largest.
fn beside_others(runs: &[Value], counts_per_rev: u32, bank: &str) -> [String; 3] {
    let reads_edges = |name: &str| Kind::all().iter().any(|k| k.name == name && k.needs.edge);
    let may_be_compared =
        |name: &str| !name.starts_with("imm") && (reads_edges(bank) || !reads_edges(name));
    let at = |recording: &str, estimator: &str| {
        let rows = runs.iter().filter(|row| {
            row["counts_per_rev"] == counts_per_rev
                && text(row, "recording") == recording
                && text(row, "estimator") == estimator
        });
        mean(rows.map(|row| number(row, "rms_pct")))
    };
    let mut errors = Vec::new();
    let mut worst = (0.0, String::new());
    for recording in values(runs, "recording") {
        let Some(error) = at(recording, bank) else {
            continue;
        };
        errors.push(error);
        for kind in Kind::all().iter().filter(|kind| may_be_compared(kind.name)) {
            let Some(other) = at(recording, kind.name) else {
                continue;
            };
            // The largest ratio of a recording is that to the best estimator.
            if error / other > worst.0 {
                worst = (error / other, format!("{recording}, {}", kind.name));
            }
        }
    }
    [shown(mean(errors.into_iter())), cell(worst.0), worst.1]
}

#[test]
fn table_of_resolutions_has_the_worst_recording_of_a_bank() {
    let resolutions = [64, 256, 1024, 4096, 16384];
    let all = resolutions.map(|counts| counts.to_string()).join(",");
    let runs = json(&["real", "--data", DATA, "--counts-per-rev", &all]);
    let rows = resolutions.map(|counts| {
        let banks = ["imm", "imm-edge"].map(|bank| beside_others(&runs, counts, bank));
        let cells = banks.into_iter().flatten();
        [counts.to_string()].into_iter().chain(cells).collect()
    });
    check(&REAL_RESOLUTION, &[], &rows);
}

/// The table of the program pools as the documented one does.
#[test]
fn printed_pools_are_means_over_phases_and_then_over_recordings() {
    let table = std::process::Command::new(env!("CARGO_BIN_EXE_host-sim"))
        .args([
            "real",
            "--data",
            DATA,
            "--estimator",
            "pll",
            "--estimator",
            "kalman-motor",
        ])
        .output()
        .expect("host-sim runs");
    let table = String::from_utf8(table.stdout).expect("text");
    for estimator in ["pll", "kalman-motor"] {
        let line = table
            .lines()
            .find(|line| line.trim_start().starts_with(estimator));
        let cells: Vec<_> = line.expect(estimator).split_whitespace().collect();
        let printed = [cells[1], cells[3]].map(|cell| cell.parse::<f64>().unwrap());
        for (printed, documented) in printed.iter().zip(pooled(estimator)) {
            let documented: f64 = documented.parse().unwrap();
            // Four digits are printed.
            assert!(
                (printed / documented - 1.0).abs() < 6e-4,
                "{printed} {documented}"
            );
        }
    }
}
