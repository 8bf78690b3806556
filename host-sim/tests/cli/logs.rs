//! Logs as users have them: every file of tests/data/logs reads to the motion that it was written from,
//! or is refused with one line.

use std::collections::BTreeSet;
use std::f64::consts::{PI, TAU};
use std::fs;

use crate::Folder;

const LOGS: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../tests/data/logs");

/// Number of rows of the motion, 1 ms apart.
const ROWS: usize = 240;

const COUNTS_PER_REV: f64 = 4096.0;

/// The motion of all logs: counts at `t` seconds after the first row, as README.md there states.
fn counts(t: f64) -> f64 {
    let revolutions = 0.8 + 0.6 * t + 0.4 * (2.0 * PI * 1.5 * t).sin();
    (COUNTS_PER_REV * revolutions).floor()
}

/// Logs that read to the motion, and the options that they need.
const READ: &[(&str, &str)] = &[
    ("own.csv", ""),
    ("crlf-bom.csv", ""),
    ("carriage-return.csv", ""),
    (
        "semicolons-decimal-commas.csv",
        "--column t=time_ms,counts_large=angle_deg",
    ),
    (
        "tabs.tsv",
        "--column|t=time [us]|--column|counts_large=position [rad]|--column|current=iq [mA]",
    ),
    ("spaces.txt", ""),
    ("comments.csv", ""),
    ("text-before-header.csv", ""),
    ("header-in-comment.txt", ""),
    ("no-header.csv", "--column t=1:ms,counts_large=2:rev"),
    (
        "no-time.csv",
        "--column counts_large=encoder --row-rate 1000",
    ),
    (
        "quoted-names.csv",
        "--column|t=time, ns:ns,counts_large=shaft angle (rev),current=torque (Nm)",
    ),
    ("absolute-4096.csv", ""),
    ("absolute-3600.csv", "--modulus 3600"),
    ("absolute-deg.csv", "--column counts_large=angle:deg"),
    ("moteus-tview.csv", ""),
    ("moteus-tview.jsonl", ""),
    ("moteus-python.csv", ""),
    ("odrive.csv", ""),
    ("vesc-tool.csv", ""),
    ("simplefoc-monitor.txt", "--row-rate 1000"),
    ("simplefoc-monitor-all.txt", "--row-rate 1000"),
    ("plotjuggler.csv", ""),
];

/// Logs that are refused, the options, and parts of the line.
const REFUSED: &[(&str, &str, &[&str])] = &[
    (
        "semicolons-decimal-commas.csv",
        "",
        &[
            "line 1: no column t; found: time_ms; angle_deg, separated by ';'",
            "--column 't=time_ms,counts_large=angle_deg'",
            "moteus, ODrive, VESC Tool, PlotJuggler, SimpleFOC",
        ],
    ),
    (
        "unknown-names.csv",
        "",
        &["found: stamp; shaft; speed", "--column 't=stamp:s,"],
    ),
    (
        "no-header.csv",
        "",
        &[
            "2 columns of numbers",
            "--column t=1:s,counts_large=2:counts",
        ],
    ),
    ("simplefoc-monitor.txt", "", &["SimpleFOC", "--row-rate HZ"]),
    ("utf-16.csv", "", &["line 1", "UTF-16; save it in UTF-8"]),
    (
        "not-a-number.csv",
        "",
        &["line 7: column counts_large: 'n/a' is not a number"],
    ),
    (
        "cut.csv",
        "",
        &["line 52: 1 fields where the first line has 2; remove the line"],
    ),
    (
        "thousands.csv",
        "",
        &[
            "line 2: column counts_large: '1.234,0'",
            "without separators of thousands",
        ],
    ),
    (
        "decimal-commas-and-commas.csv",
        "",
        &["line 2: 3 fields", "need another separator than a comma"],
    ),
    (
        "time-goes-back.csv",
        "",
        &["line 4: column t: 0.0005 s is before the 0.001 s"],
    ),
    (
        "seconds-in-ms.csv",
        "",
        &["column t: rows 1 s apart", "--column t=NAME:ms"],
    ),
    (
        "two-joints.csv",
        "",
        &["found: __time; /a/position; /b/position", "--column"],
    ),
    (
        "two-controllers.jsonl",
        "",
        &["line 31: field controller: 2 after 1; keep the lines of one"],
    ),
    (
        "broken.jsonl",
        "",
        &["line 2: no JSON object; remove the line"],
    ),
    (
        "absolute-4096.csv",
        "--modulus 3600",
        &["line 21: column counts_large: 3615 with --modulus 3600: raw must be below modulus"],
    ),
    (
        "uneven.csv",
        "",
        &[
            "column t: ",
            "% of the steps",
            "constant period: add --resample",
        ],
    ),
    (
        "milliseconds-at-700-hz.csv",
        "--column t=t_ms",
        &["column t: ", "% of the steps", "add --resample"],
    ),
    (
        "own.csv",
        "--column t=time",
        &["no column 'time', which --column names for t; found: t; counts_large"],
    ),
    (
        "own.csv",
        "--resample 1",
        &["--resample 1: ", "at 10 Hz or more"],
    ),
];

/// Options as arguments: separated by spaces, or by bars where they contain spaces.
fn split(options: &str) -> Vec<&str> {
    match options.contains('|') {
        true => options.split('|').collect(),
        false => options.split_whitespace().collect(),
    }
}

/// Time and finite difference (rad/s) of a log, and what was said about it.
fn replay(folder: &Folder, log: &str, options: &str) -> (Vec<[f64; 2]>, String) {
    let path = format!("{LOGS}/{log}");
    let mut arguments = vec!["replay", &path, "--estimator", "finite-difference"];
    arguments.extend(split(options));
    let output = folder.run(&arguments);
    let said = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(0), "{log}: {said}");
    let text = String::from_utf8(output.stdout).unwrap();
    let row = |line: &str| {
        let mut fields = line.split(',').map(|field| field.parse().unwrap());
        [fields.next().unwrap(), fields.next().unwrap()]
    };
    (text.lines().skip(1).map(row).collect(), said)
}

/// Counts per row of a finite difference at 1 kHz.
fn steps(rows: &[[f64; 2]]) -> Vec<f64> {
    let count = TAU / COUNTS_PER_REV * 1000.0;
    rows[1..]
        .iter()
        .map(|[_, velocity]| velocity / count)
        .collect()
}

#[test]
fn logs_read_to_the_motion_that_they_were_written_from() {
    let folder = Folder::new("logs");
    for (log, options) in READ {
        let (rows, _) = replay(&folder, log, options);
        assert_eq!(rows.len(), ROWS, "{log}");
        for (k, step) in steps(&rows).into_iter().enumerate() {
            let [before, now] = [k, k + 1].map(|row| row as f64 * 1e-3);
            let t = rows[k + 1][0] - rows[0][0];
            // Seconds since 1970 are a float with a resolution of 0.24 us.
            assert!((t - now).abs() < 1e-6, "{log}: {t} s in row {k}");
            // The velocity is an f32.
            let moved = counts(now) - counts(before);
            assert!(
                (step - moved).abs() < 1e-4,
                "{log}: {step} counts for {moved} in row {k}"
            );
        }
    }
}

#[test]
fn unreadable_logs_are_refused_with_one_line() {
    let folder = Folder::new("refused-logs");
    for (log, options, said) in REFUSED {
        let path = format!("{LOGS}/{log}");
        for command in ["replay", "plot"] {
            let mut arguments = vec![command, &path, "--out", "out"];
            arguments.extend(split(options));
            let line = folder.refused(&arguments);
            assert!(line.contains(log), "{log}: {line}");
            for part in *said {
                assert!(line.contains(part), "{log}: {line}");
            }
        }
    }
}

#[test]
fn every_log_is_read_or_refused_by_a_test() {
    let files = fs::read_dir(LOGS)
        .unwrap()
        .map(|file| file.unwrap().file_name());
    let files: BTreeSet<_> = files.map(|name| name.into_string().unwrap()).collect();
    let named = READ.iter().map(|(log, _)| *log);
    let named = named.chain(REFUSED.iter().map(|(log, ..)| *log));
    let named = named.chain(["README.md", "missing-rows.csv"]);
    let named: BTreeSet<_> = named.map(str::to_owned).collect();
    assert_eq!(files, named);
}

#[test]
fn columns_and_units_that_were_converted_are_reported() {
    let folder = Folder::new("sources");
    for (log, options, said) in [
        (
            "moteus-tview.csv",
            "",
            "read as a log of moteus: t from 'timestamp' (s), counts_large from 'position' (rev with 4096 \
             counts/rev), current from 'q_A' (A)",
        ),
        (
            "vesc-tool.csv",
            "",
            "read as a log of VESC Tool: t from 'ms_today' (ms)",
        ),
        (
            "vesc-tool.csv",
            "",
            "counts_large wraps at 4096 and is unwrapped",
        ),
        (
            "absolute-4096.csv",
            "",
            "counts_large wraps at 4096 and is unwrapped",
        ),
        (
            "plotjuggler.csv",
            "",
            "current from '/joint_states/handle/effort' (N.m with 0.",
        ),
        (
            "plotjuggler.csv",
            "",
            "10 rows without a position are left out",
        ),
        (
            "missing-rows.csv",
            "",
            "3 rows are missing in 2 gaps of at most 2, the first before line 102 at 0.102 s",
        ),
    ] {
        let (_, notes) = replay(&folder, log, options);
        let notes = notes.split_whitespace().collect::<Vec<_>>().join(" ");
        assert!(notes.contains(said), "{log}: {notes}");
    }
    // Nothing is said about a log that needs no conversion.
    let (_, notes) = replay(&folder, "own.csv", "");
    assert!(!notes.contains("from '"), "{notes}");
}

#[test]
fn positions_off_whole_counts_are_reported() {
    let folder = Folder::new("fine");
    folder.write("coarse.toml", "large.counts_per_rev = 1000\n");
    let device = "--column counts_large=angle:deg --device coarse.toml";
    let (_, notes) = replay(&folder, "absolute-deg.csv", device);
    let notes = notes.split_whitespace().collect::<Vec<_>>().join(" ");
    let said = "counts from a whole count with 1000 counts/rev and are rounded to the nearest";
    assert!(notes.contains(said), "{notes}");
}

#[test]
fn torque_is_divided_by_the_torque_constant() {
    // The files have 0.05 times the current as torque; a device with 0.05 N.m/A has the current again.
    let folder = Folder::new("torque");
    folder.write("mine.toml", "large.torque_constant_nm_per_a = 0.05\n");
    let torque = "--column|t=time, ns:ns,counts_large=shaft angle (rev),current=torque (Nm)";
    let milliamps =
        "--column|t=time [us]|--column|counts_large=position [rad]|--column|current=iq [mA]";
    let run = |log: &str, options: &str| {
        let path = format!("{LOGS}/{log}");
        let mut arguments = vec!["replay", &path, "--estimator", "kalman-motor"];
        arguments.extend(["--device", "mine.toml"]);
        arguments.extend(split(options));
        let text = folder.good(&arguments);
        let velocity = |line: &str| line.split_once(',').unwrap().1.parse::<f64>().unwrap();
        text.lines().skip(1).map(velocity).collect::<Vec<_>>()
    };
    let (one, other) = (run("quoted-names.csv", torque), run("tabs.tsv", milliamps));
    let without = run(
        "quoted-names.csv",
        &torque.replace("torque (Nm)", "torque (Nm):A"),
    );
    let far = |a: &[f64], b: &[f64]| {
        let pairs = a.iter().zip(b).map(|(a, b)| (a - b).abs());
        pairs.fold(0.0, f64::max)
    };
    // The logs round the current to 0.1 mA and the torque to 1e-6 N.m.
    assert!(far(&one, &other) < 0.05, "{}", far(&one, &other));
    assert!(far(&one, &without) > 1.0, "{}", far(&one, &without));
}

#[test]
fn every_command_on_recordings_takes_the_columns() {
    let folder = Folder::new("commands");
    let log = format!("{LOGS}/semicolons-decimal-commas.csv");
    let columns = ["--column", "t=time_ms,counts_large=angle_deg"];
    let plot = [&["plot", &log, "--out", "p.svg"][..], &columns].concat();
    folder.good(&plot);
    assert!(folder.files().contains("p.svg"));
    // Read, and refused because this log has no other encoder.
    let line = folder.refused(&[&["identify", &log][..], &columns].concat());
    assert!(line.contains("no column counts_small"), "{line}");
    let line = folder.refused(&["identify", &log]);
    assert!(line.contains("no column t; found: time_ms"), "{line}");
    // A pipe can be read once.
    let script = format!(
        "cat '{LOGS}/own.csv' | '{}' replay /dev/stdin --estimator pll --out v.csv",
        env!("CARGO_BIN_EXE_host-sim")
    );
    let shell = std::process::Command::new("sh")
        .args(["-c", &script])
        .current_dir(&folder.0)
        .status();
    assert!(shell.unwrap().success());
    folder.good(&[
        "replay",
        &format!("{LOGS}/own.csv"),
        "--estimator",
        "pll",
        "--out",
        "w.csv",
    ]);
    let [from_pipe, from_file] =
        ["v.csv", "w.csv"].map(|file| fs::read(folder.0.join(file)).unwrap());
    assert_eq!(from_pipe, from_file);
}

#[test]
fn uneven_rows_become_even() {
    let folder = Folder::new("uneven");
    for (log, options) in [
        ("uneven.csv", "--resample 1000"),
        ("missing-rows.csv", "--resample 1000"),
    ] {
        let (rows, notes) = replay(&folder, log, options);
        assert!(notes.contains("t is uneven in "), "{log}: {notes}");
        let mut position = 0.0;
        for (k, step) in steps(&rows).into_iter().enumerate() {
            let t = (k + 1) as f64 * 1e-3;
            assert!((rows[k + 1][0] - rows[0][0] - t).abs() < 1e-9, "{log}");
            position += step;
            // A row has the count below the position; a line between two rows is at most a count off,
            // and rounding half a count.
            let off = position - (counts(t) - counts(0.0));
            assert!(off.abs() < 2.0, "{log}: {off} counts in row {k}");
        }
    }
    // A few missing rows alone are reported and read.
    let (rows, notes) = replay(&folder, "missing-rows.csv", "");
    assert_eq!(rows.len(), ROWS - 3);
    assert!(notes.contains("--resample 1000"), "{notes}");
}
