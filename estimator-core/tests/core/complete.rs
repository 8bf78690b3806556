//! The lists of estimators that the tests iterate over, compared with the source of the core.

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};

use crate::every::at;
use crate::observer;

/// Every source file of the core.
fn sources(folder: &Path) -> Vec<PathBuf> {
    let entries = fs::read_dir(folder).expect("readable");
    let paths = entries.map(|entry| entry.expect("readable").path());
    paths
        .flat_map(|path| {
            if path.is_dir() {
                sources(&path)
            } else {
                vec![path]
            }
        })
        .collect()
}

/// A type without the modules it is in, and without the length of its tables.
fn bare(name: &str) -> String {
    let words = name.split_inclusive(['<', '>', ',', ' ']);
    let last = words.map(|word| word.rsplit("::").next().unwrap_or(word));
    last.collect::<String>().replace("512", "N")
}

/// A type that implements `VelocityEstimator`, and an alias of one, is in one of the two lists.
#[test]
fn every_estimator_of_the_core_is_tried() {
    let tried: BTreeSet<String> = at(1000.0)
        .iter()
        .map(|case| case.kind)
        .chain(observer::kinds())
        .map(bare)
        .collect();
    let mut missing = Vec::new();
    let mut found = 0;
    for path in sources(&Path::new(env!("CARGO_MANIFEST_DIR")).join("src")) {
        // An alias may go over two lines.
        let text = fs::read_to_string(&path).expect("readable");
        let text = text.replace(" =\n    ", " = ");
        for line in text.lines() {
            let implementor = line
                .strip_prefix("impl")
                .and_then(|line| line.split_once("VelocityEstimator for "))
                .map(|(_, name)| name.trim_end_matches(" {"));
            if let Some(name) = implementor {
                found += 1;
                let base = name.split('<').next().unwrap_or(name);
                let tries = |kind: &String| kind.split('<').next() == Some(base);
                // It estimates nothing; `invariants` tests it.
                if base != "Skip" && !tried.iter().any(tries) {
                    missing.push(name.to_owned());
                }
            }
            let alias = line
                .strip_prefix("pub type ")
                .and_then(|line| line.split_once(" = "))
                .map(|(_, of)| of.trim_end_matches(';'));
            if let Some(of) = alias {
                found += 1;
                if !tried.contains(of) {
                    missing.push(of.to_owned());
                }
            }
        }
    }
    assert!(found >= 20, "{found} implementations and names");
    assert!(missing.is_empty(), "{missing:?} of {tried:#?}");
}
