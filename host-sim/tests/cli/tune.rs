//! `host-sim tune`.

use std::fs;

use crate::{Folder, SHORT, json};

#[test]
fn tuned_parameters_are_written_and_taken() {
    let folder = Folder::new("tune");
    let tune = [
        "tune",
        "--estimator",
        "pll",
        "--estimator",
        "foaw-end-fit",
        "--rate",
        "1000",
        "--seconds",
        "1",
        "--seeds",
        "1",
        "--scenario",
        "step",
        "--out",
        "tuned.toml",
    ];
    folder.good(&tune);
    let text = fs::read_to_string(folder.0.join("tuned.toml")).unwrap();
    assert!(text.contains("[preset.estimators.pll]"), "{text}");
    let rms = |more: &[&str]| {
        let mut arguments = SHORT.to_vec();
        arguments.extend(["--estimator", "pll"]);
        arguments.extend(more);
        json(&folder.good(&arguments))[0]["distance_rad_s"]
            .as_f64()
            .unwrap()
    };
    // Tuned on another seed, still much better than any bandwidth far off.
    let tuned = rms(&["--presets", "tuned.toml"]);
    assert!(tuned < 0.7 * rms(&["--set", "pll.bandwidth_hz=10"]));
    assert_ne!(tuned, rms(&["--set", "pll.bandwidth_hz=100"]));
}
