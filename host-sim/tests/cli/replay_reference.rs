//! `host-sim replay` of recordings without a true velocity.

use crate::{Folder, HOST_SIM, json};

/// Counts of an encoder with 4096 counts/rev at 1 kHz on a shaft whose velocity is
/// `20 sin(10 t)` rad/s, with the column `true_omega` if asked.
fn sine(truth: bool) -> String {
    let mut text = String::from(if truth {
        "t,counts_large,true_omega\n"
    } else {
        "t,counts_large\n"
    });
    for k in 0..3000 {
        let t = f64::from(k) * 1e-3;
        let angle = 2.0 * (1.0 - (10.0 * t).cos());
        let count = (angle * 4096.0 / std::f64::consts::TAU).floor();
        text += &format!("{t:.3},{count}");
        if truth {
            text += &format!(",{}", 20.0 * (10.0 * t).sin());
        }
        text.push('\n');
    }
    text
}

/// The text without its line ends.
fn words(text: &str) -> String {
    text.split_whitespace().collect::<Vec<_>>().join(" ")
}

#[test]
fn recording_without_a_truth_is_scored_against_a_reference() {
    let folder = Folder::new(HOST_SIM);
    folder.write("truth.csv", sine(true));
    folder.write("plain.csv", sine(false));
    let estimators = ["--estimator", "finite-difference", "--estimator", "imm"];
    let scores = |name: &str| {
        let rows =
            json(&folder.good(&[&["replay", name, "--json", "-"][..], &estimators].concat()));
        assert_eq!(rows.len(), 2);
        rows
    };
    let (truth, reference) = (scores("truth.csv"), scores("plain.csv"));
    for (a, b) in truth.iter().zip(&reference) {
        assert_eq!(
            (&a["against"], &b["against"]),
            (&"truth".into(), &"reference".into())
        );
        assert!(a["reference_sd_rad_s"].is_null());
        let sd = b["reference_sd_rad_s"].as_f64().unwrap();
        let [a, b] = [a, b].map(|row| row["rms_rad_s"].as_f64().unwrap());
        // The error of the reference adds to that of the estimator.
        assert!(sd > 0.0 && sd < 0.1, "{sd}");
        assert!((a - b).abs() < 2.0 * sd, "{a} {b}");
    }

    let columns = [
        &[
            "replay",
            "plain.csv",
            "--out",
            "v.csv",
            "--reference",
            "columns",
        ][..],
        &estimators,
    ];
    let output = folder.run(&columns.concat());
    assert_eq!(output.status.code(), Some(0));
    let table = words(&String::from_utf8(output.stdout).unwrap());
    assert!(
        table.contains("against a reference computed from the"),
        "{table}"
    );
    let notes = words(&String::from_utf8(output.stderr).unwrap());
    assert!(
        notes.contains("no column true_omega; scores are against a reference"),
        "{notes}"
    );
    let mut reader = csv::Reader::from_path(folder.path().join("v.csv")).unwrap();
    let header: Vec<_> = reader
        .headers()
        .unwrap()
        .iter()
        .map(str::to_owned)
        .collect();
    let expected = [
        "t",
        "finite-difference",
        "imm",
        "reference_rad_s",
        "reference_sd_rad_s",
    ];
    assert_eq!(header, expected);
    for (k, row) in reader.records().map(Result::unwrap).enumerate() {
        let value = |i: usize| row[i].parse::<f64>().unwrap();
        let truth = 20.0 * (10.0 * value(0)).sin();
        assert!(
            (value(3) - truth).abs() < 6.0 * value(4),
            "row {k}: {} {truth}",
            value(3)
        );
    }

    let off = folder.good(
        &[
            &[
                "replay",
                "plain.csv",
                "--out",
                "v.csv",
                "--reference",
                "off",
            ][..],
            &estimators,
        ]
        .concat(),
    );
    assert!(!off.contains("rms") && !off.contains("reference"), "{off}");
}

#[test]
fn gap_and_bad_count_leave_the_scores_of_other_rows() {
    let folder = Folder::new(HOST_SIM);
    let text = sine(false);
    let lines: Vec<_> = text.lines().collect();
    let gap = [&lines[..1000], &lines[2000..]].concat().join("\n");
    let mut bad = lines.clone();
    bad[1500] = "1.499,16777216";
    let (late, bad) = (format!("{gap}\n"), bad.join("\n"));
    for (name, text) in [("even.csv", &text), ("gap.csv", &late), ("bad.csv", &bad)] {
        folder.write(name, text);
        let arguments = ["replay", name, "--estimator", "low-pass", "--json", "-"];
        let row = &json(&folder.good(&arguments))[0];
        assert_eq!(row["against"], "reference", "{name}");
        // One row beside the fault has a standard deviation of its own.
        let sd = row["reference_sd_rad_s"].as_f64().unwrap();
        assert!(sd > 0.0 && sd < 0.05, "{name}: {sd}");
    }
}

/// The velocities of a log that is too short for scores.
const SHORT: [&str; 6] = [
    "replay",
    "short.csv",
    "--estimator",
    "pll",
    "--out",
    "v.csv",
];

#[test]
fn log_without_a_reference_has_velocities_and_a_note() {
    let folder = Folder::new(HOST_SIM);
    folder.write("short.csv", "t,counts_large\n0,0\n1e-3,1\n2e-3,1\n");
    for more in [&[][..], &["--reference", "scores"]] {
        let output = folder.run(&[&SHORT[..], more].concat());
        assert_eq!(output.status.code(), Some(0), "{more:?}");
        let notes = words(&String::from_utf8(output.stderr).unwrap());
        let said = "short.csv: no scores: 3 rows; a reference without true_omega needs at least 100; \
                    --reference off computes none";
        assert!(notes.contains(said), "{notes}");
        let written = folder.text("v.csv");
        assert_eq!(written.lines().count(), 4);
    }
}

#[test]
fn log_that_ends_before_the_scores_begin_has_velocities_and_a_note() {
    let folder = Folder::new(HOST_SIM);
    let count = |k: i32| (40.0 * (f64::from(k) * 0.01).sin()).floor();
    let rows = |rows: i32| (0..rows).map(|k| format!("{},{}\n", f64::from(k) * 2e-5, count(k)));
    for (length, truth, is_scored) in [
        (5000, "", false),
        (5200, "", true),
        (5000, ",1.5", false),
        (5200, ",1.5", true),
    ] {
        let text: String = rows(length)
            .map(|row| row.replace('\n', &format!("{truth}\n")))
            .collect();
        let header = if truth.is_empty() { "" } else { ",true_omega" };
        folder.write("short.csv", format!("t,counts_large{header}\n{text}"));
        let output = folder.run(&SHORT);
        assert_eq!(output.status.code(), Some(0));
        let notes = words(&String::from_utf8(output.stderr).unwrap());
        let said = format!("no scores: {length} rows at 50000 Hz; scores begin after 0.1 s");
        assert_eq!(notes.contains(&said), !is_scored, "{notes}");
        let table = words(&String::from_utf8(output.stdout).unwrap());
        assert_eq!(table.contains("pll"), is_scored, "{table}");
        assert_eq!(folder.text("v.csv").lines().count() as i32, length + 1);
    }
}
