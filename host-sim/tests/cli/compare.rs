//! `host-sim compare`: scores and their contract.

use std::fs;

use scoring::score::Score;

use crate::{Folder, HOST_SIM, SHORT, json};

/// Scores that need more than the velocity: a standard deviation, or a damping that is learned.
const REPORTED: [&str; 3] = [
    "within_2_sigma",
    "learned_damping_nms_per_rad",
    "learned_damping_pct",
];

#[test]
fn json_on_standard_output_has_the_contracts_fields() {
    let folder = Folder::new(HOST_SIM);
    let rows = json(&folder.good(&SHORT));
    let names: Vec<_> = rows
        .iter()
        .map(|row| row["estimator"].as_str().unwrap())
        .collect();
    for name in [
        "finite-difference",
        "low-pass",
        "foaw-end-fit",
        "foaw-best-fit",
        "kalman-triple",
        "kalman-motor",
        "pll",
    ] {
        assert!(names.contains(&name), "{name} in {names:?}");
    }
    for row in &rows {
        assert_eq!(row["scenario"], "step");
        assert_eq!(row["rate_hz"], 1000.0);
        assert_eq!(row["plant"], "friction");
        assert_eq!(row["seed"], 1);
        for field in Score::FIELDS {
            if REPORTED.contains(&field.name) {
                continue;
            }
            let value = row[field.name].as_f64();
            assert!(
                value.is_some_and(f64::is_finite),
                "{} of {}",
                field.name,
                row["estimator"]
            );
        }
    }
    let difference = &rows[0];
    assert_eq!(difference["estimator"], "finite-difference");
    assert_eq!(difference["rms_pct"], 100.0);
    assert!(
        folder.names().is_empty(),
        "no report unless it is asked for"
    );
}

#[test]
fn output_is_reproducible_and_depends_on_the_seed() {
    let folder = Folder::new(HOST_SIM);
    let report = |out| {
        let mut arguments = SHORT[..7].to_vec();
        arguments.extend(["--out", out]);
        folder.good(&arguments);
        let read = |name| fs::read(folder.path().join(out).join(name)).unwrap();
        // The page shows its own command, which names the folder.
        let page = String::from_utf8(read("index.html"))
            .unwrap()
            .replace(out, "");
        (page, read("scores.csv"), read("scores.json"))
    };
    assert!(report("folder-one") == report("folder-two"));
    let one = folder.good(&SHORT);
    assert_eq!(one, folder.good(&SHORT));
    let mut other = SHORT.to_vec();
    other.extend(["--seed", "2"]);
    assert_ne!(one, folder.good(&other));
}

#[test]
fn frictionless_plant_gives_other_scores() {
    let folder = Folder::new(HOST_SIM);
    let mut arguments = SHORT.to_vec();
    arguments.push("--frictionless");
    let rows = json(&folder.good(&arguments));
    assert!(rows.iter().all(|row| row["plant"] == "frictionless"));
    assert_ne!(
        rows[0]["rms_rad_s"],
        json(&folder.good(&SHORT))[0]["rms_rad_s"]
    );
}

#[test]
fn scores_that_are_not_requested_are_null() {
    let folder = Folder::new(HOST_SIM);
    let mut arguments = SHORT.to_vec();
    arguments.extend(["--estimator", "pll", "--score", "rms_rad_s"]);
    let rows = json(&folder.good(&arguments));
    assert_eq!(rows.len(), 1);
    assert!(rows[0]["rms_pct"].is_f64() && rows[0]["delay_ms"].is_null());
}

#[test]
fn set_parameter_changes_the_scores() {
    let folder = Folder::new(HOST_SIM);
    let rms = |set| {
        let mut arguments = SHORT.to_vec();
        arguments.extend(["--estimator", "foaw-end-fit", "--set", set]);
        json(&folder.good(&arguments))[0]["rms_pct"]
            .as_f64()
            .unwrap()
    };
    // One interval is the finite difference.
    assert_eq!(rms("foaw-end-fit.n=1"), 100.0);
    assert_ne!(rms("foaw-end-fit.n=15"), 100.0);
}

/// Without the lines the table has columns less, and says no more.
#[test]
fn motor_at_rest_and_values_at_the_end_of_their_range_are_told() {
    let folder = Folder::new(HOST_SIM);
    let notes = |text: &str, rate: &str| {
        folder.write("mine.toml", text);
        let arguments = "compare --device mine.toml --scenario step --estimator foaw-best-fit --seconds 1 --no-report";
        folder.ends(0, &format!("{arguments} --rate {rate}")).1
    };
    assert_eq!(notes("", "1000"), "");
    let said = notes("large.coulomb_nm = 5", "1000");
    let rest = "note: step at 1000 Hz: the motor does not move by a count, so that there is no delay and no score in % \
                of finite difference; large.coulomb_nm is too large for";
    assert!(said.starts_with(rest), "{said}");
    let said = notes("large.counts_per_rev = 16", "10000");
    let ends = "note: presets that are scaled to large.counts_per_rev = 16 at 10000 Hz leave their range, and have its \
                end, which is not tuned: foaw-best-fit.n; tune them with";
    assert!(said.starts_with(ends), "{said}");
}
