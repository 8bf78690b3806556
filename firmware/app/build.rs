//! Passes the environment on: `SCENE`, the name of the one scene of the image, without which it has all,
//! and `RATE`, the control rate in Hz. Refuses a rate at which the longest control task that was counted
//! takes more than half of the period.

use std::env::{self, VarError};

use measured::control_rate::{self, COUNTED_HZ, COUNTED_WINDOW};

/// Prefix of the variables in which cargo names the features.
const FEATURE: &str = "CARGO_FEATURE_";

fn main() {
    println!("cargo::rerun-if-changed=build.rs");
    println!("cargo::rustc-check-cfg=cfg(one_scene)");
    println!("cargo::rustc-check-cfg=cfg(scene, values(any()))");
    if let Err(error) = pass_on() {
        println!("cargo::error={error}");
    }
}

fn pass_on() -> Result<(), String> {
    let scene = variable("SCENE")?;
    if let Some(scene) = &scene {
        println!("cargo::rustc-cfg=one_scene");
        println!("cargo::rustc-cfg=scene={scene:?}");
    }
    let rate = match variable("RATE")? {
        None => COUNTED_HZ,
        Some(text) => text.parse().map_err(|_| {
            format!("RATE={text}: not a whole number of Hz, for example RATE=20000")
        })?,
    };
    println!("cargo::rustc-env=RATE_HZ={rate}");
    println!("cargo::rustc-check-cfg=cfg(rate_is_checked)");
    if rate <= COUNTED_HZ {
        return Ok(());
    }
    println!("cargo::rustc-cfg=rate_is_checked");
    println!("cargo::rustc-env=COUNTED_WINDOW={COUNTED_WINDOW}");
    println!("cargo::rerun-if-changed=../../measured/control.csv");
    let names = env::vars().filter_map(|(name, _)| {
        let name = name.strip_prefix(FEATURE)?;
        Some(name.to_lowercase().replace('_', "-"))
    });
    let names: Vec<_> = names.collect();
    control_rate::check(rate, names.iter().map(String::as_str), scene.as_deref())
}

/// A variable of the environment; an empty one is none.
fn variable(name: &str) -> Result<Option<String>, String> {
    println!("cargo::rerun-if-env-changed={name}");
    match env::var(name) {
        Ok(text) => Ok(Some(text).filter(|text| !text.is_empty())),
        Err(VarError::NotPresent) => Ok(None),
        Err(VarError::NotUnicode(_)) => Err(format!("{name} is not Unicode")),
    }
}
