//! A capture of an encoder's lines becomes a recording that the other commands read.

use std::f64::consts::TAU;

use crate::{Folder, HOST_SIM, json};

/// 0.5 s of an encoder of 4096 counts, at 10 MHz, as Logic 2 of Saleae writes it.
const CAPTURE: &str = "../data/encoder-lines.csv";

/// The velocity of the motion in the capture, rad/s.
fn velocity(t: f64) -> f64 {
    let part = |revolutions: f64, hz: f64| revolutions * TAU * hz * (TAU * hz * t).cos();
    TAU * (part(0.15, 2.0) + part(0.02, 13.0))
}

#[test]
fn capture_has_the_velocity_of_the_motion() {
    let folder = Folder::new(HOST_SIM);
    let output = folder.run(&[
        "decode",
        CAPTURE,
        "--counts-per-rev",
        "4096",
        "--out",
        "motor.csv",
    ]);
    assert_eq!(output.status.code(), Some(0));
    let notes = String::from_utf8(output.stderr).unwrap();
    let said = "encoder-lines.csv: t from 'Time [s]' (s), line A from column 'Channel 0', line B from column \
                'Channel 1'";
    assert!(notes.contains(said), "{notes}");
    assert!(
        folder
            .text("motor.csv")
            .starts_with("# counts_per_rev = 4096\nt,counts_large,edge_tick,edge_bound\n0,0,,\n")
    );
    let recording = folder.text("motor.csv");
    let rows: Vec<Vec<f64>> = recording
        .lines()
        .skip(3)
        .map(|line| {
            line.split(',')
                .map(|field| field.parse().unwrap())
                .collect()
        })
        .collect();
    let mut worst: f64 = 0.0;
    for pair in rows.windows(2) {
        let counts = pair[1][3] - pair[0][3];
        let [from, to] = [0, 1].map(|k| pair[k][2] / 84e6);
        if counts.abs() < 4.0 {
            continue;
        }
        let found = counts * TAU / 4096.0 / (to - from);
        worst = worst.max((found - velocity(0.5 * (from + to))).abs());
    }
    // A stamp is the sample after the edge, each 0.1 us; a row is 1 ms.
    assert!(rows.len() == 500 && worst < 0.01, "{worst} rad/s");
    let ranked = json(&folder.good(&["recommend", "motor.csv", "--json", "-"]));
    assert!(
        ranked.iter().any(|row| row["estimator"] == "imm-edge"),
        "{ranked:?}"
    );
}

#[test]
fn lines_in_the_other_order_have_the_other_sign() {
    let folder = Folder::new(HOST_SIM);
    let counts = |lines: &[&str]| -> Vec<i64> {
        let recording =
            folder.good(&[&["decode", CAPTURE, "--rate", "500", "--out", "-"], lines].concat());
        let count = |line: &str| line.split(',').nth(1).unwrap().parse().unwrap();
        recording.lines().skip(1).map(count).collect()
    };
    let one = counts(&["--lines", "Channel 0", "Channel 1"]);
    let other: Vec<_> = counts(&["--lines", "3", "2"])
        .iter()
        .map(|count| -count)
        .collect();
    assert_eq!(one.len(), 251);
    assert!(one.iter().any(|count| *count > 500));
    assert_eq!(one, other);
}

/// Hall lines have names before or after the file, and exclude two lines.
#[test]
fn hall_lines_are_named() {
    let folder = Folder::new(HOST_SIM);
    let levels = ["1,0,0", "1,1,0", "0,1,0", "0,1,1", "0,0,1", "1,0,1"];
    let row = |k: usize| format!("{}e-3,{}\n", k, levels[k % 6]);
    let rows: String = (0..9).map(row).collect();
    folder.write("hall.csv", format!("t,H1,H2,H3\n{rows}"));
    let hall = ["--hall", "H1", "H2", "H3"];
    let recording = folder.good(&[&["decode"], &hall[..], &["hall.csv", "--out", "-"]].concat());
    let counts = recording
        .lines()
        .skip(1)
        .map(|line| line.split(',').nth(1).unwrap());
    let counts: Vec<_> = counts.collect();
    assert_eq!(counts, ["0", "1", "2", "3", "4", "5", "6", "7", "8"]);
    let both = [
        &["decode", "hall.csv", "--lines", "H1", "H2"],
        &hall[..],
        &["--out", "-"],
    ];
    let error = folder.refused(&both.concat());
    assert!(
        error.contains("--lines") && error.contains("--hall"),
        "{error}"
    );
}

#[test]
fn capture_that_is_read_as_a_recording_is_refused_with_the_command() {
    let folder = Folder::new(HOST_SIM);
    let error = folder.refused(&["replay", CAPTURE]);
    let said = "encoder-lines.csv: line 1: the columns look like lines of a logic analyser; make a recording of an \
                encoder's lines with host-sim decode";
    assert!(error.contains(said), "{error}");
    for rate in ["4.9", "100001", "nan"] {
        let error = folder.refused(&["decode", CAPTURE, "--rate", rate, "--out", "-"]);
        assert!(error.contains("--rate"), "{error}");
    }
    let error = folder.refused(&["decode", CAPTURE, "--row-rate", "-1", "--out", "-"]);
    assert!(
        error.contains("--row-rate -1: the rate of the rows must be positive"),
        "{error}"
    );
    let error = folder.refused(&["decode", CAPTURE, "--lines", "1", "--out", "-"]);
    assert!(error.contains("--lines"), "{error}");
    folder.write("c.csv", "t,a,b\n0,0,0\n");
    let error = folder.refused(&["decode", "c.csv", "--out", "c.csv"]);
    assert!(error.contains("c.csv"), "{error}");
    assert_eq!(folder.text("c.csv"), "t,a,b\n0,0,0\n");
}
