//! Names that are nearly right, and text that fits a terminal.

use crate::{Folder, HOST_SIM};

#[test]
fn misspelled_names_are_answered_with_a_suggestion() {
    let folder = Folder::new(HOST_SIM);
    for (arguments, said) in [
        (
            "compare --estimator kalman-tripel",
            "did you mean kalman-triple?",
        ),
        ("compare --scenario trak", "did you mean track?"),
        (
            "compare --closed-loop --scene free_air",
            "did you mean free-air?",
        ),
        ("simulate --scene exite --out x.csv", "did you mean excite?"),
        (
            "compare --set pll.bandwith_hz=3",
            "did you mean bandwidth_hz?",
        ),
        ("comapre", "'compare'"),
        ("help comapre", "'compare'"),
        ("replay r.csv --estimater pll", "'--estimator'"),
    ] {
        let error = folder.refused(arguments);
        assert!(error.contains(said), "{arguments}: {error}");
    }
    let error = folder.refused(&["simulate", "--scene", "stepp", "--out", "x.csv"]);
    assert!(error.contains("excite, off, free-air"), "{error}");
    let error = folder.refused(&["replay", "--bogus"]);
    assert!(error.ends_with("see host-sim replay --help\n"), "{error}");
    let error = folder.refused(&["bogus"]);
    assert!(error.ends_with("see host-sim --help\n"), "{error}");
}

#[test]
fn lists_fit_80_columns_and_name_tuned_values() {
    let folder = Folder::new(HOST_SIM);
    for list in ["estimators", "scenarios"] {
        let text = folder.good(&[list]);
        let long: Vec<_> = text
            .lines()
            .filter(|line| line.chars().count() > 80)
            .collect();
        assert!(long.is_empty(), "{long:#?}");
    }
    let presets = include_str!("../../presets.toml");
    let (_, steady) = presets
        .split_once("[preset.estimators.kalman-triple-steady]")
        .unwrap();
    let jerk = steady
        .split("jerk = ")
        .nth(1)
        .unwrap()
        .lines()
        .next()
        .unwrap();
    let jerk = jerk.trim_end_matches(".0");
    let text = folder.good(&["estimators"]);
    let (_, steady) = text.split_once("--set kalman-triple-steady.jerk=").unwrap();
    let value = steady.split("tuned to ").nth(1).unwrap();
    assert!(
        value.starts_with(&format!("{jerk} at 1000 Hz, ")),
        "{value}"
    );
}

#[test]
fn extreme_numbers_are_printed_with_few_digits() {
    let folder = Folder::new(HOST_SIM);
    folder.write("tiny.toml", "large.inertia_kg_m2 = 1e-300\n");
    folder.write("grams.toml", "large.inertia_kg_m2 = 115\n");
    for (arguments, said) in [
        ("compare --rate 1e-300", "rate 1e-300 Hz"),
        ("compare --seconds 1e300", "duration 1e300 s"),
        (
            "compare --set pll.bandwidth_hz=1e-300",
            "pll.bandwidth_hz = 1e-300: must be",
        ),
        (
            "device --device tiny.toml",
            "tiny.toml: line 1, large.inertia_kg_m2 = 1e-300:",
        ),
        (
            "replay r.csv --device grams.toml",
            "grams.toml: line 1, large.inertia_kg_m2 = 115: must be at most 0.1 kg.m2; did you mean 115e-7",
        ),
    ] {
        let error = folder.refused(arguments);
        assert!(
            error.contains(said) && error.len() < 250,
            "{arguments}: {error}"
        );
    }
}

#[test]
fn help_has_the_help_of_itself() {
    let folder = Folder::new(HOST_SIM);
    assert_eq!(folder.good("help --help"), folder.good("--help"));
    assert_eq!(folder.good("help plot --help"), folder.good("plot --help"));
}
