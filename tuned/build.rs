//! Writes the device file and the presets files as Rust constants.
//!
//! The environment variables DEVICE and PRESETS name the files. Without DEVICE the device is
//! `DualStage::DEFAULT`. The presets file lies over the shipped one, as in host-sim.

use std::path::{Path, PathBuf};
use std::{env, fs};

use device_files::constants::{constants, named_file};

fn main() {
    println!("cargo::rerun-if-changed=build.rs");
    if let Err(error) = write() {
        println!("cargo::error={error}");
    }
}

fn write() -> Result<(), String> {
    let (device, presets) = (named("DEVICE")?, named("PRESETS")?);
    let constants = constants(device.as_deref(), presets.as_deref())?;
    if let Some(warning) = constants.warning {
        println!("cargo::warning={warning}");
    }
    let out = PathBuf::from(env::var_os("OUT_DIR").expect("cargo sets OUT_DIR"));
    fs::write(out.join("constants.rs"), constants.text).expect("OUT_DIR is writable");
    Ok(())
}

/// The file that an environment variable names.
fn named(variable: &str) -> Result<Option<PathBuf>, String> {
    println!("cargo::rerun-if-env-changed={variable}");
    let Some(value) = env::var_os(variable) else {
        return Ok(None);
    };
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).parent();
    let path = named_file(variable, &value, root.expect("a parent"))?;
    println!("cargo::rerun-if-changed={}", path.display());
    Ok(Some(path))
}
