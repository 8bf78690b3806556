//! Writes host-sim/presets.toml, as far as it is for the plant with friction, as a Rust table.
//!
//! The file is what `host-sim tune` writes: a line a table header or a key. Numbers are copied as
//! they stand. host-sim reads the same file with a TOML library, and a test compares the two.

use std::path::PathBuf;
use std::{env, fs};

const FILE: &str = "../host-sim/presets.toml";

fn main() {
    println!("cargo:rerun-if-changed={FILE}");
    println!("cargo:rerun-if-changed=build.rs");
    let text = fs::read_to_string(FILE).unwrap_or_else(|error| panic!("{FILE}: {error}"));
    let (mut rate, mut plant, mut estimator) = ("", "", "");
    let mut rows = String::new();
    for (number, line) in (1..).zip(text.lines()) {
        let line = line.split('#').next().unwrap_or_default().trim();
        if line == "[[preset]]" {
            (rate, plant, estimator) = ("", "", "");
        } else if let Some(header) = line.strip_prefix("[preset.estimators.") {
            estimator = header.trim_end_matches(']');
        } else if let Some((key, value)) = line.split_once(" = ") {
            match (key, estimator) {
                ("rate_hz", "") => rate = value,
                ("plant", "") => plant = value,
                (_, "") => panic!("{FILE}:{number}: key {key} outside an estimator"),
                _ if plant == "\"friction\"" => {
                    let number = value.parse::<f64>().is_ok_and(f64::is_finite);
                    assert!(number, "{FILE}: {estimator}.{key} = {value} is no number");
                    rows += &format!("    ({rate}, \"{estimator}\", \"{key}\", {value}),\n");
                }
                _ => {}
            }
        } else {
            assert!(line.is_empty(), "{FILE}:{number}: cannot read '{line}'");
        }
    }
    let out = PathBuf::from(env::var_os("OUT_DIR").expect("cargo sets OUT_DIR"));
    fs::write(out.join("table.rs"), format!("&[\n{rows}]\n")).expect("OUT_DIR is writable");
}
