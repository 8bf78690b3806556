//! Writes host-sim/presets.toml, as far as it is for the plant with friction, as a Rust table.

use std::path::PathBuf;
use std::{env, fs};

use toml::{Table, Value};

const FILE: &str = "../host-sim/presets.toml";

fn main() {
    println!("cargo:rerun-if-changed={FILE}");
    println!("cargo:rerun-if-changed=build.rs");
    let text = fs::read_to_string(FILE).unwrap_or_else(|error| panic!("{FILE}: {error}"));
    let rows = rows(&text).unwrap_or_else(|error| panic!("{FILE}: {error}"));
    let out = PathBuf::from(env::var_os("OUT_DIR").expect("cargo sets OUT_DIR"));
    fs::write(out.join("table.rs"), format!("&[\n{rows}]\n")).expect("OUT_DIR is writable");
}

/// A row of the table for each parameter.
fn rows(text: &str) -> Result<String, String> {
    let file: Table = text.parse().map_err(|error| format!("{error}"))?;
    let presets = file.get("preset").and_then(Value::as_array);
    let mut rows = String::new();
    for preset in presets.ok_or("no [[preset]]")? {
        let rate = preset.get("rate_hz").and_then(Value::as_float);
        let rate = rate.ok_or("a preset without rate_hz")?;
        if preset.get("plant").and_then(Value::as_str) != Some("friction") {
            continue;
        }
        let estimators = preset.get("estimators").and_then(Value::as_table);
        for (estimator, parameters) in estimators.ok_or("a preset without estimators")? {
            let parameters = parameters.as_table().ok_or("an estimator is no table")?;
            for (name, value) in parameters {
                let value = value.as_float().filter(|value| value.is_finite());
                let value = value.ok_or(format!("{estimator}.{name} is no number"))?;
                // Debug of a float has all the digits that distinguish it.
                rows += &format!("    ({rate:?}, {estimator:?}, {name:?}, {value:?}),\n");
            }
        }
    }
    Ok(rows)
}
