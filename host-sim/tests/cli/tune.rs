//! `host-sim tune`.

use crate::{Folder, HOST_SIM, SHORT, json};

/// Tunes one estimator quickly and writes `tuned.toml`.
const QUICK: [&str; 13] = [
    "tune",
    "--estimator",
    "pll",
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

#[test]
fn tuned_parameters_are_written_and_used() {
    let folder = Folder::new(HOST_SIM);
    folder.good(&[&QUICK[..], &["--estimator", "foaw-end-fit"]].concat());
    let text = folder.text("tuned.toml");
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

#[test]
fn default_output_without_a_place_is_refused_before_the_search() {
    let folder = Folder::new(HOST_SIM);
    folder.write("target", "");
    folder.write("log.csv", "t,counts_large\n");
    for recording in ["", "log.csv"] {
        let error = folder.refused(&format!("tune {recording} --estimator observer"));
        assert!(
            error.contains("target/presets.toml: target is no folder"),
            "{error}"
        );
    }
}

#[test]
fn named_estimator_without_parameters_has_a_note() {
    let folder = Folder::new(HOST_SIM);
    let run = "tune --rate 1000 --seconds 1 --seeds 1 --scenario step --shard 1/9 --estimator pll";
    let (_, errors) = folder.ends(0, &format!("{run} --estimator imm"));
    assert!(
        errors.contains("left out, without parameters to tune: imm"),
        "{errors}"
    );
    assert_eq!(folder.ends(0, run).1, "");
}

#[test]
fn section_image_of_an_existing_file_stays_with_its_comments() {
    let folder = Folder::new(HOST_SIM);
    let shipped = include_str!("../../presets.toml");
    let image = &shipped[shipped.find("# Values of the flash image").unwrap()..];
    // The section stands last in the shipped file, and first in this one.
    let (tuned, image_first) = (&shipped[..shipped.len() - image.len()], image.len());
    for file in [shipped.to_owned(), format!("{image}\n{tuned}")] {
        folder.write("tuned.toml", file);
        folder.good(&QUICK);
        let text = folder.text("tuned.toml");
        assert!(text.trim_end().ends_with(image.trim_end()), "{text}");
        // The tuned presets are those of this run alone.
        let before = &text[..text.len() - image_first];
        assert_eq!(before.matches("[[preset]]").count(), 2, "{text}");
        assert!(!before.contains("kalman-triple"), "{text}");
        folder.good(&[&crate::SHORT[..], &["--presets", "tuned.toml"]].concat());
    }
}

#[test]
fn file_that_is_no_presets_file_is_not_overwritten() {
    let folder = Folder::new(HOST_SIM);
    for (text, expected) in [
        ("[image.large\n", "tuned.toml: line 1, [image.large: "),
        (
            "[device]\nname = 1\n",
            "tuned.toml: line 1, [device]: unknown field `device`",
        ),
    ] {
        folder.write("tuned.toml", text);
        let error = folder.refused(&QUICK);
        assert!(error.contains(expected), "{error}");
        assert!(error.contains("correct or remove the file"), "{error}");
        let after = folder.text("tuned.toml");
        assert_eq!(after, text);
    }
}

/// The search ends at half the rate, where a low-pass filter loses least on fast vibration.
#[test]
fn end_of_a_range_is_reported() {
    let folder = Folder::new(HOST_SIM);
    let output = folder.run(&[
        "tune",
        "--estimator",
        "low-pass",
        "--rate",
        "1000",
        "--seconds",
        "1",
        "--seeds",
        "1",
        "--scenario",
        "texture",
        "--out",
        "tuned.toml",
    ]);
    assert_eq!(output.status.code(), Some(0));
    let errors = String::from_utf8(output.stderr).unwrap();
    let note = "low-pass.cutoff_hz = 500 Hz is the upper limit of the searched range";
    assert!(errors.contains(note), "{errors}");
    let text = folder.text("tuned.toml");
    assert!(text.contains(note), "{text}");
}

/// On the seed after the tuning seeds, which decides, no estimator is worse than it was before.
#[test]
fn tuned_parameters_are_no_worse_than_the_shipped_ones() {
    let folder = Folder::new(HOST_SIM);
    let names = [
        "foaw-end-fit",
        "kalman-motor-steady",
        "pll",
        "observer-held",
    ];
    let estimators: Vec<_> = names
        .iter()
        .flat_map(|name| ["--estimator", name])
        .collect();
    let common = ["--scenario", "step", "--rate", "1000", "--seconds", "1"];
    let tune = ["tune", "--seeds", "1", "--out", "tuned.toml"];
    folder.good(&[&tune[..], &common, &estimators].concat());
    let costs = |more: &[&str]| -> Vec<f64> {
        let compare = [
            "compare",
            "--no-report",
            "--json",
            "-",
            "--seed",
            "4294967297",
        ];
        let rows = json(&folder.good(&[&compare[..], &common, &estimators, more].concat()));
        let figure = |row: &serde_json::Value, name: &str| row[name].as_f64().unwrap();
        let cost = |row| figure(row, "distance_rad_s") + 0.01 * figure(row, "rms_rad_s");
        rows.iter().map(cost).collect()
    };
    let (before, after) = (costs(&[]), costs(&["--presets", "tuned.toml"]));
    for (name, (before, after)) in names.iter().zip(before.iter().zip(&after)) {
        assert!(after <= before, "{name}: {before} became {after}");
    }
    assert_ne!(before, after, "tuning found nothing");
}
