//! Names the source that is built: the commit, its date, and whether files differ from it.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

/// Folders whose files decide whether the source differs from the commit.
const SOURCES: [&str; 3] = ["..", "../../estimator-core", "../../haptic-control"];

/// Output of git, or `None` without git or outside of a repository.
fn git(arguments: &[&str]) -> Option<String> {
    let output = Command::new("git").args(arguments).output().ok()?;
    let text = String::from_utf8(output.stdout).ok()?;
    output.status.success().then(|| text.trim().to_owned())
}

fn source() -> Option<String> {
    // A copy of the files inside of another repository is not that repository's commit.
    git(&["ls-files", "--error-unmatch", "build.rs"])?;
    let commit = git(&[
        "log",
        "-1",
        "--format=commit %h, source of %cs",
        "--abbrev=12",
    ])?;
    let status = [&["status", "--porcelain", "--"], &SOURCES[..]].concat();
    let modified = match git(&status)?.is_empty() {
        true => "",
        false => ", modified",
    };
    Some(commit + modified)
}

fn crates_of_host_sim() -> impl Iterator<Item = PathBuf> {
    let entries = fs::read_dir("..").into_iter().flatten();
    entries.filter_map(Result::ok).map(|entry| entry.path())
}

fn main() {
    // Each commit adds a line to the log of HEAD.
    let log = git(&["rev-parse", "--git-path", "logs/HEAD"]);
    for path in log.iter().filter(|path| Path::new(path).exists()) {
        println!("cargo::rerun-if-changed={path}");
    }
    println!("cargo::rerun-if-changed=build.rs");
    println!("cargo::rerun-if-changed=Cargo.toml");
    let crates = SOURCES
        .map(PathBuf::from)
        .into_iter()
        .chain(crates_of_host_sim());
    for sources in crates
        .map(|folder| folder.join("src"))
        .filter(|path| path.exists())
    {
        println!("cargo::rerun-if-changed={}", sources.display());
    }
    let source = source().unwrap_or_else(|| "commit unknown".to_owned());
    println!("cargo::rustc-env=LIMPID_SOURCE={source}");
}
