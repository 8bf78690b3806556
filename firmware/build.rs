//! Hands the linker the memory map of the board, which is the repository's `memory.x`, and the image
//! its commit and its features as text.

use std::path::{Path, PathBuf};
use std::process::Command;
use std::{env, fs};

/// What the image is built from, besides files that the environment names.
const SOURCES: &[&str] = &[
    "../.cargo",
    "../Cargo.lock",
    "../Cargo.toml",
    "../drivers",
    "../estimator-catalogue",
    "../estimator-core",
    "../firmware",
    "../haptic-control",
    "../host-sim/device-files",
    "../host-sim/presets.toml",
    "../host-sim/spelling",
    "../memory.x",
    "../rust-toolchain.toml",
    "../tuned",
];

/// Prefix of the variables in which cargo names the features.
const FEATURE: &str = "CARGO_FEATURE_";

/// Features that are in every image of the board, as variables name them.
const IN_EVERY_IMAGE: [&str; 2] = ["DEFAULT", "NUCLEO_F429ZI"];

fn main() {
    let out = PathBuf::from(env::var_os("OUT_DIR").expect("cargo sets OUT_DIR"));
    fs::copy("../memory.x", out.join("memory.x")).expect("memory.x at the repository's root");
    println!("cargo:rerun-if-changed=build.rs");
    println!("cargo:rustc-link-search={}", out.display());
    for argument in ["--nmagic", "-Tlink.x", "-Tdefmt.x"] {
        println!("cargo:rustc-link-arg-bins={argument}");
    }
    println!("cargo:rustc-env=COMMIT={}", commit());
    println!("cargo:rustc-env=FEATURES={}", features());
}

/// The abbreviated hash of the commit, with `-dirty` if [`SOURCES`] differ from it; `unknown` outside
/// a repository.
fn commit() -> String {
    for source in SOURCES {
        println!("cargo:rerun-if-changed={source}");
    }
    // Each commit and each checkout adds a line to the log of HEAD. A repository without the log
    // writes its index then, which it also does at other times.
    let log = git_path("logs/HEAD").or_else(|| git_path("index"));
    for path in log.iter().chain(&git_path("HEAD")) {
        println!("cargo:rerun-if-changed={path}");
    }
    let Some(commit) = git(&["rev-parse", "--short", "HEAD"]).filter(|hash| !hash.is_empty())
    else {
        return "unknown".to_owned();
    };
    // Without the lock, a look does not write the index.
    let status = ["--no-optional-locks", "status", "--porcelain", "--"];
    let status = git(&[&status[..], SOURCES].concat());
    if status.is_some_and(|changes| changes.is_empty()) {
        commit
    } else {
        commit + "-dirty"
    }
}

/// A file of the repository's data, if it exists: cargo would build again each time for another.
fn git_path(file: &str) -> Option<String> {
    git(&["rev-parse", "--git-path", file]).filter(|path| Path::new(path).exists())
}

/// What git prints, without the line's end; `None` if there is no git, or no repository.
fn git(arguments: &[&str]) -> Option<String> {
    let output = Command::new("git").args(arguments).output().ok()?;
    let text = String::from_utf8(output.stdout).ok()?;
    output.status.success().then(|| text.trim_end().to_owned())
}

/// The features that images differ in, separated by commas; `none` without any.
fn features() -> String {
    let variables = env::vars_os().filter_map(|(name, _)| name.into_string().ok());
    let names = variables.filter_map(|name| name.strip_prefix(FEATURE).map(str::to_owned));
    let names = names.filter(|name| !IN_EVERY_IMAGE.contains(&name.as_str()));
    let mut names: Vec<_> = names
        .map(|name| name.to_lowercase().replace('_', "-"))
        .collect();
    names.sort();
    if names.is_empty() {
        return "none".to_owned();
    }
    names.join(",")
}
