//! `real` and `coarsen`: recordings of a fine encoder as estimators of a coarse one see them.

use std::collections::BTreeMap;
use std::fs;
use std::path::PathBuf;

use crate::{Folder, HOST_SIM, json};

/// The shipped recordings.
const DATA: &str = "../data/real";

/// A list with one fine recording `f.csv` of 100 000 counts per revolution.
const LIST: &str =
    "[[recording]]\nfile = 'f.csv'\nwhat = 'x'\nkind = 'fine'\ncounts_per_rev = 100000\n";

/// A list with one coarse recording `c.csv` of 90 counts per revolution.
const LIST_COARSE: &str =
    "[[recording]]\nfile = 'c.csv'\nwhat = 'x'\nkind = 'coarse'\ncounts_per_rev = 90\n";

/// 1 s at 2 kHz: rest for 0.5 s, then 5 rad/s. A revolution has 100 000 counts.
fn fine() -> String {
    let mut text = String::from("time_s,fine_count,true_omega_rad_s\n");
    for k in 0..=2000 {
        let (moving, omega) = if k > 1000 { (k - 1000, 5.0) } else { (0, 0.0) };
        let angle = 5.0 * f64::from(moving) * 0.5e-3;
        let count = (angle / std::f64::consts::TAU * 1e5).floor();
        text += &format!("{},{count},{omega}\n", f64::from(k) * 0.5e-3);
    }
    text
}

#[test]
fn coarse_recording_has_the_scores_of_real_in_replay() {
    let folder = Folder::new(HOST_SIM);
    let source = format!("{DATA}/tue-q1c-free-motion.csv.gz");
    let coarsen = "--counts-per-rev 1024 --rate 2000 --phase 0.25 --seconds 2 --out c.csv";
    let coarsen: Vec<_> = coarsen.split(' ').collect();
    folder.good(&[&["coarsen", &source], &coarsen[..]].concat());
    folder.write("d.toml", "[large]\ncounts_per_rev = 1024\n");
    let replay = "replay c.csv --device d.toml --json -";
    let replay = json(&folder.good(replay));
    let real = "--counts-per-rev 1024 --rate 2000 --phase 0.25 --seconds 2 --json -";
    let real: Vec<_> = real.split(' ').collect();
    let real = json(&folder.good(&[&["real", "--data", DATA], &real[..]].concat()));
    let of = |row: &&serde_json::Value| row["recording"] == "tue-q1c-free-motion";
    let real: Vec<_> = real.iter().filter(of).collect();
    assert!(real.len() > 10 && real.len() == replay.len());
    for (real, replay) in real.iter().zip(&replay) {
        assert_eq!(real["estimator"], replay["estimator"]);
        for score in ["rms_rad_s", "rms_pct", "p99_rad_s"] {
            let [a, b] = [real, replay].map(|row| row[score].as_f64().unwrap());
            // The file has edges on an 84 MHz clock, 12 ns apart.
            assert!((a - b).abs() < 1e-3 * b.abs(), "{score}: {real} {replay}");
        }
    }
}

#[test]
fn errors_at_constant_speed_and_rest_are_those_of_the_definition() {
    let folder = Folder::new(HOST_SIM);
    folder.write("f.csv", fine());
    folder.write("recordings.toml", LIST);
    let arguments = "real --data . --counts-per-rev 1000 --phase 0.5 --json -";
    let rows = json(&folder.good(arguments));
    let row = rows
        .iter()
        .find(|row| row["estimator"] == "finite-difference")
        .unwrap();
    // At 5 rad/s a tick has p = 0.796 counts of 6.28 rad/s: the velocity is one count or none. From
    // 0.1 s on, 500 of 901 samples move.
    let p = 5.0 / std::f64::consts::TAU;
    let count = std::f64::consts::TAU;
    let variance = p * (count - 5.0).powi(2) + (1.0 - p) * 25.0;
    let rms = (variance * 500.0 / 901.0).sqrt();
    let found = row["rms_rad_s"].as_f64().unwrap();
    // The fraction of samples with a count is known to one of 500.
    assert!((found / rms - 1.0).abs() < 5e-3, "{found} {rms}");
    assert_eq!(row["p99_rad_s"], 5.0);
    assert_eq!(row["rms_pct"], 100.0);
    assert_eq!(row["moving_at_rest"], 0.0);
    assert_eq!(row["role"], "judges");
    // The recording has neither current nor handle.
    assert!(rows.iter().all(|row| row["estimator"] != "kalman-motor"));
}

/// Standard output and every file of a run with so many threads.
fn files_of(threads: &str, kind: &str) -> (Vec<u8>, BTreeMap<PathBuf, Vec<u8>>) {
    let folder = Folder::new(HOST_SIM);
    let output = folder
        .command(&["real", "--data", DATA, kind, "-"])
        .args("--seconds 1 --counts-per-rev 256,4096 --rate 500,1000 --out page".split(' '))
        .env("RAYON_NUM_THREADS", threads)
        .output()
        .unwrap();
    assert!(output.status.success(), "{output:?}");
    let mut files = BTreeMap::new();
    for part in ["page", "page/figures"] {
        for entry in fs::read_dir(folder.path().join(part)).unwrap() {
            let path = entry.unwrap().path();
            if path.is_file() {
                let name = path.strip_prefix(folder.path()).unwrap().to_owned();
                files.insert(name, fs::read(&path).unwrap());
            }
        }
    }
    (output.stdout, files)
}

#[test]
fn output_does_not_depend_on_the_number_of_threads() {
    for kind in ["--json", "--csv"] {
        let (printed, files) = files_of("1", kind);
        // A page, its list, both tables, ranking, resolution, rate, a figure for each recording.
        assert_eq!(files.len(), 4 + 3 + 11, "{:?}", files.keys());
        let (printed_by_many, files_of_many) = files_of("7", kind);
        assert!(printed == printed_by_many, "{kind}");
        for (name, bytes) in &files {
            assert!(files_of_many[name] == *bytes, "{}", name.display());
        }
    }
}

#[test]
fn estimators_without_their_signals_are_shown_as_dashes() {
    let folder = Folder::new(HOST_SIM);
    folder.write("f.csv", fine());
    folder.write("recordings.toml", LIST);
    let table = folder.good(&["real", "--data", ".", "--details"]);
    let line = table
        .lines()
        .find(|line| line.contains("kalman-motor "))
        .unwrap();
    let cells: Vec<_> = line.split_whitespace().skip(1).collect();
    assert_eq!(cells, ["-", "-", "-", "-", "-", "-", "0"]);
    assert!(
        table.lines().all(|line| line.chars().count() <= 80),
        "{table}"
    );
}

#[test]
fn invalid_input_of_real_and_coarsen_is_one_line() {
    let folder = Folder::new(HOST_SIM);
    folder.write("f.csv", fine());
    folder.write("broken.csv", "time_s,fine_count\n0,1\nx,2\n");
    let fine = ["--fine-counts-per-rev", "100000", "--out", "c.csv"];
    for (arguments, said) in [
        (
            "coarsen f.csv --counts-per-rev 64 --out c.csv",
            "f.csv: its counts per revolution are not known; give --fine",
        ),
        (
            "coarsen none.csv --counts-per-rev 64 --out c.csv",
            "none.csv: cannot read: No such file",
        ),
        (
            "coarsen f.csv --counts-per-rev 60000",
            "do not resolve 60000 counts/rev; ask for at most 50000",
        ),
        (
            "coarsen f.csv --counts-per-rev 64 --rate 4000",
            "which is less than the 4000 Hz of --rate; ask for at most --rate 2000",
        ),
        (
            "coarsen f.csv --counts-per-rev 64 --rate 0",
            "--rate 0: must be from 5 to 100000 Hz",
        ),
        (
            "coarsen f.csv --counts-per-rev 64 --phase NaN",
            "--phase NaN: must be from",
        ),
        (
            "coarsen f.csv --counts-per-rev 64 --seconds 0",
            "--seconds 0: must be from 0.2",
        ),
        (
            "coarsen broken.csv --counts-per-rev 64",
            "broken.csv: line 3: column t: 'x' ",
        ),
        (
            "coarsen none.csv --counts-per-rev 64",
            "none.csv: cannot read",
        ),
        ("real --data .", "recordings.toml: cannot read"),
        (
            "real f.csv",
            "of yours are ranked by: host-sim recommend f.csv",
        ),
        (
            "real --data . --csv - --json -",
            "only one of them can go to standard output",
        ),
    ] {
        let mut arguments: Vec<_> = arguments.split(' ').collect();
        if arguments[0] == "coarsen" && !arguments.contains(&"--out") {
            arguments.extend(fine);
        }
        let error = folder.refused(&arguments);
        assert!(error.contains(said), "{error}");
    }
    folder.write("recordings.toml", LIST);
    let error = folder.refused(&["real", "--data", ".", "--rate", "3000"]);
    assert!(
        error.contains("ask for a lower --rate or --counts-per-rev"),
        "{error}"
    );
    let outputs = ["--json", "r.json", "--csv", "r.csv", "--out", "page"];
    let observer = ["real", "--data", ".", "--estimator", "observer"];
    let error = folder.refused(&[&observer[..], &outputs].concat());
    let said = ".: no recording has the columns that observer reads; see host-sim estimators";
    assert!(error.contains(said), "{error}");
}

#[test]
fn absolute_encoder_of_real_is_unwrapped_with_a_note() {
    let folder = Folder::new(HOST_SIM);
    folder.write("recordings.toml", LIST);
    let shifted = |wrap: bool| {
        let lines = fine();
        let mut text = String::new();
        for line in lines.lines() {
            let fields: Vec<_> = line.split(',').collect();
            text += &match fields[1].parse::<i64>() {
                Err(_) => format!("{line}\n"),
                Ok(count) => {
                    let count = count + 90_000;
                    let count = if wrap { count % 100_000 } else { count };
                    format!("{},{count},{}\n", fields[0], fields[2])
                }
            };
        }
        text
    };
    let run = |wrap: bool| {
        folder.write("f.csv", shifted(wrap));
        let output = folder.run("real --data . --counts-per-rev 1000 --json -");
        assert_eq!(output.status.code(), Some(0));
        (output.stdout, String::from_utf8(output.stderr).unwrap())
    };
    let (straight, said) = run(false);
    assert_eq!(said, "");
    let (unwrapped, said) = run(true);
    assert!(unwrapped == straight);
    let note = "f.csv: counts_large wraps at 100000 and is unwrapped: a revolution of an absolute encoder\n";
    assert_eq!(said, note);
}

#[test]
fn what_several_recordings_have_in_common_is_said_once() {
    let folder = Folder::new(HOST_SIM);
    let other = |name: &str| LIST.replace("f.csv", name);
    let list = format!("{LIST}{}{}", other("g.csv"), other("h.csv"));
    folder.write("recordings.toml", list);
    let text = fine();
    // Row 3 occurs twice.
    let row = text.lines().nth(4).unwrap();
    let twice = text.replace(row, &format!("{row}\n{row}"));
    for (name, text) in [("f.csv", &twice), ("g.csv", &twice), ("h.csv", &text)] {
        folder.write(name, text);
    }
    let output = folder.run("real --data . --counts-per-rev 1000 --estimator pll");
    assert_eq!(output.status.code(), Some(0));
    let said = String::from_utf8(output.stderr).unwrap();
    let notes: Vec<_> = said.lines().filter(|line| line.contains("csv")).collect();
    let begin = "f.csv and 1 more: 1 row is left out that has the time of the row before, the first in line 6";
    assert!(notes.len() == 1 && notes[0].starts_with(begin), "{said}");
}

#[test]
fn coarse_recording_that_wraps_has_the_scores_of_the_one_that_does_not() {
    let folder = Folder::new(HOST_SIM);
    let recording = folder.text("../data/back-and-forth.csv");
    folder.write("recordings.toml", LIST_COARSE);
    let run = |text: &str| {
        folder.write("c.csv", text);
        let output = folder.run("real --data . --estimator pll --estimator low-pass --json -");
        assert_eq!(output.status.code(), Some(0));
        (output.stdout, String::from_utf8(output.stderr).unwrap())
    };
    let (straight, said) = run(&recording);
    assert!(!said.contains("wraps"), "{said}");
    let mut wrapped = String::new();
    for line in recording.lines() {
        let mut fields: Vec<_> = line.split(',').map(str::to_owned).collect();
        for k in [1, 3] {
            if let Ok(count) = fields[k].parse::<i64>() {
                fields[k] = count.rem_euclid(90).to_string();
            }
        }
        wrapped += &(fields.join(",") + "\n");
    }
    let (unwrapped, said) = run(&wrapped);
    let note =
        "c.csv: counts_large wraps at 90 and is unwrapped: a revolution of an absolute encoder";
    assert!(said.contains(note), "{said}");
    assert!(unwrapped == straight);
}

#[test]
fn values_that_are_given_twice_run_once() {
    let folder = Folder::new(HOST_SIM);
    folder.write("f.csv", fine());
    folder.write("recordings.toml", LIST);
    let run =
        |values: &str| folder.good(&format!("real --data . --estimator pll --json - {values}"));
    assert_eq!(
        run("--counts-per-rev 1000,500,1000 --phase 0.5,0.25,0.5"),
        run("--counts-per-rev 1000,500 --phase 0.5,0.25")
    );
}
