//! Writes estimator-core's source once more with f64 for every f32.
//!
//! The twin is generated and not kept, so it cannot drift from what it is the twin of.

use std::path::{Path, PathBuf};
use std::{env, fs, io};

fn main() -> io::Result<()> {
    let core = Path::new(&env::var("CARGO_MANIFEST_DIR").expect("set by cargo"))
        .join("../../estimator-core/src");
    let out = PathBuf::from(env::var("OUT_DIR").expect("set by cargo"));
    println!("cargo:rerun-if-changed={}", core.display());
    generate(&core, &out)
}

fn generate(from: &Path, to: &Path) -> io::Result<()> {
    fs::create_dir_all(to)?;
    for entry in fs::read_dir(from)? {
        let entry = entry?;
        let target = to.join(entry.file_name());
        if entry.file_type()?.is_dir() {
            generate(&entry.path(), &target)?;
        } else {
            fs::write(target, in_f64(&fs::read_to_string(entry.path())?))?;
        }
    }
    Ok(())
}

/// The text of one file with its precision doubled.
fn in_f64(text: &str) -> String {
    let mut twin = String::with_capacity(text.len());
    for line in text.lines() {
        // What belongs to a crate's root cannot come through `include!`; nor are docs wanted.
        let inner = line.trim_start();
        if inner.starts_with("//") || is_crate_attribute(line) {
            continue;
        }
        twin.push_str(&widened(line));
        twin.push('\n');
    }
    without_crate_attributes(&twin)
}

/// Whether a line is an attribute of the whole crate, and no more.
fn is_crate_attribute(line: &str) -> bool {
    line.starts_with("#![") && line.trim_end().ends_with(']')
}

/// Cuts out `#![..]` that go over several lines.
fn without_crate_attributes(text: &str) -> String {
    let mut rest = text;
    let mut kept = String::with_capacity(text.len());
    while let Some(start) = rest.find("#![") {
        let end = rest[start..]
            .find(")]")
            .map_or(rest.len(), |end| start + end + 2);
        kept.push_str(&rest[..start]);
        rest = &rest[end..];
    }
    kept + rest
}

/// A line with `f32`, the type and the suffix of a number, as `f64`; names that contain it stay.
fn widened(line: &str) -> String {
    let mut parts = line.split("f32");
    let mut twin = parts.next().unwrap_or_default().to_owned();
    for part in parts {
        let before = twin.chars().next_back();
        let number = twin
            .trim_end_matches('_')
            .chars()
            .next_back()
            .is_some_and(|c| c.is_ascii_digit() || c == '.');
        let after = part.chars().next();
        let word = |c: Option<char>| c.is_some_and(|c| c.is_alphanumeric() || c == '_');
        let is_type = !word(before) && !word(after);
        twin.push_str(if is_type || (number && !word(after)) {
            "f64"
        } else {
            "f32"
        });
        twin.push_str(part);
    }
    twin
}
