//! Commands that name different packages compile the crates of host-sim once.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;
use std::process::Command;

/// Sets of features of each crate: one, or another one for build scripts and procedural macros.
type Features = BTreeMap<String, BTreeSet<String>>;

/// What cargo resolves for a command with these arguments.
fn features(arguments: &[&str]) -> Features {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let run = Command::new(env!("CARGO"))
        .current_dir(root)
        .args([
            "tree",
            "--offline",
            "--locked",
            "--prefix",
            "none",
            "--no-dedupe",
        ])
        .args(["--format", "{p} features: {f}"])
        .args(arguments)
        .output()
        .expect("cargo tree");
    assert!(
        run.status.success(),
        "{}",
        String::from_utf8_lossy(&run.stderr)
    );
    let mut features = Features::new();
    // An empty line stands between the trees of two packages.
    let trees = String::from_utf8_lossy(&run.stdout);
    for line in trees.lines().filter(|line| !line.is_empty()) {
        let (package, list) = line.split_once(" features: ").expect("package, features");
        features
            .entry(package.to_owned())
            .or_default()
            .insert(list.to_owned());
    }
    features
}

/// Crates of both commands with features that are not the same.
fn compiled_twice(one: &Features, other: &Features) -> Vec<String> {
    let differ = |(package, features): (&String, &BTreeSet<String>)| {
        let others = other.get(package)?;
        let same = features.is_subset(others) || others.is_subset(features);
        (!same).then(|| format!("{package}: {features:?}, {others:?}"))
    };
    one.iter().filter_map(differ).collect()
}

#[test]
fn commands_share_the_crates_of_host_sim() {
    let normal = ["--edges", "normal,build"];
    let sim = features(&[&normal[..], &["--package", "host-sim"]].concat());
    assert!(sim.len() > 60, "{} crates", sim.len());
    // The tests, the default members, and programs of crates that a build of the tests has downloaded.
    let of = |package: &'static str| [&normal[..], &["--package", package]].concat();
    let programs = ["scope", "virtual-board"].map(of);
    let commands = [vec![], normal.to_vec()];
    for command in commands.iter().chain(&programs) {
        let twice = compiled_twice(&sim, &features(command));
        assert!(
            twice.is_empty(),
            "{command:?}: add features to host-sim/shared-features: {twice:#?}"
        );
    }
}

#[test]
fn other_features_are_found() {
    let set = |features: &[&str]| features.iter().map(|&list| list.to_owned()).collect();
    let of = |features: &[&str]| Features::from([("a v1.0.0".to_owned(), set(features))]);
    let one = of(&["std"]);
    assert_eq!(compiled_twice(&one, &of(&["std"])), [""; 0]);
    assert_eq!(compiled_twice(&one, &of(&["std", ""])), [""; 0]);
    assert_eq!(compiled_twice(&one, &Features::new()), [""; 0]);
    assert_eq!(compiled_twice(&one, &of(&["alloc,std"])).len(), 1);
}
