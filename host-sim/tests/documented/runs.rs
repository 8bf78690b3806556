//! Runs of the program that several tables are made from.

use std::process::Command;
use std::sync::LazyLock;

use serde_json::Value;

/// Control rates of the documented tables, Hz.
pub(crate) const RATES_HZ: [&str; 2] = ["1000", "11600"];

/// What a command of the program prints as JSON.
pub(crate) fn json(arguments: &[&str]) -> Vec<Value> {
    let output = Command::new(env!("CARGO_BIN_EXE_host-sim"))
        .args(arguments)
        .args(["--json", "-"])
        .output()
        .expect("host-sim runs");
    assert!(output.status.success(), "{arguments:?}");
    serde_json::from_slice(&output.stdout).expect("standard output is JSON")
}

/// The rows of `compare` with these arguments.
pub(crate) fn compare(arguments: &[&str]) -> Vec<Value> {
    json(&[&["compare", "--no-report"], arguments].concat())
}

/// The text in a field.
pub(crate) fn text<'a>(row: &'a Value, field: &str) -> &'a str {
    row[field].as_str().expect(field)
}

/// The number in a field.
pub(crate) fn number(row: &Value, field: &str) -> f64 {
    row[field].as_f64().expect(field)
}

/// Texts of a field in the order in which they come first.
pub(crate) fn values<'a>(rows: &'a [Value], field: &str) -> Vec<&'a str> {
    let mut seen = Vec::new();
    for row in rows {
        let text = text(row, field);
        if !seen.contains(&text) {
            seen.push(text);
        }
    }
    seen
}

/// Scores of all estimators over all scenarios, by [`RATES_HZ`].
pub(crate) static SCORED: LazyLock<[Vec<Value>; 2]> =
    LazyLock::new(|| RATES_HZ.map(|rate| compare(&["--rate", rate])));

/// The same at 1 kHz on a plant without friction.
pub(crate) static FRICTIONLESS: LazyLock<Vec<Value>> =
    LazyLock::new(|| compare(&["--rate", "1000", "--frictionless"]));

/// A moving hand in free air with every estimator in the closed loop, by [`RATES_HZ`].
pub(crate) static FREE_AIR: LazyLock<[Vec<Value>; 2]> = LazyLock::new(|| {
    RATES_HZ.map(|rate| compare(&["--closed-loop", "--scene", "free-air", "--rate", rate]))
});
