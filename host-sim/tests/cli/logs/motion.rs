//! Logs that read to the motion that they were written from.

use super::{LOGS, ROWS, counts, replay, split, steps};
use crate::{Folder, HOST_SIM};

/// Logs that read to the motion, and the options that they need.
pub(super) const READ: &[(&str, &str)] = &[
    ("own.csv", ""),
    ("crlf-bom.csv", ""),
    ("carriage-return.csv", ""),
    ("utf-16.csv", ""),
    ("semicolons-decimal-commas.csv", ""),
    (
        "tabs.tsv",
        "--column|t=time [us]|--column|counts_large=position [rad]|--column|current=iq [mA]",
    ),
    ("spaces.txt", ""),
    ("comments.csv", ""),
    ("text-before-header.csv", ""),
    ("header-in-comment.txt", ""),
    ("no-header.csv", "--column t=1:ms,counts_large=2:rev"),
    ("notes-in-header.csv", "--column t=1:ms,counts_large=2:rev"),
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
    ("times-of-day.csv", "--column t=clock,counts_large=encoder"),
    ("dates.csv", "--column t=time,counts_large=encoder"),
    (
        "dates-of-a-column.csv",
        "--column t=when,counts_large=encoder:counts",
    ),
    ("minutes.csv", ""),
    (
        "french.csv",
        "--column|t=temps (ms),counts_large=position (tr):rev",
    ),
    (
        "german.csv",
        "--column|t=Zeit in ms,counts_large=Winkel in Grad:deg",
    ),
    ("two-axes.csv", "--column t=time:s,counts_large=x_counts"),
    ("one-name-twice.csv", "--column counts_large=2"),
    (
        "list-of-axes.jsonl",
        "--column t=time_ms,counts_large=axes.0.pos_deg",
    ),
    (
        "wraps-at-32-bits.csv",
        "--column t=micros,counts_large=encoder,edge_tick=capture_us,edge_bound=capture_bound",
    ),
    ("wraps-at-16-bits.csv", ""),
    ("micros-in-ms.csv", ""),
    ("dates.jsonl", ""),
    ("nanoseconds-since-1970.csv", ""),
    ("moteus-tview.csv", ""),
    ("moteus-tview.jsonl", ""),
    ("array.json", ""),
    ("lists.json", ""),
    ("moteus-python.csv", ""),
    ("odrive.csv", ""),
    ("vesc-tool.csv", ""),
    ("simplefoc-monitor.txt", "--row-rate 1000"),
    ("simplefoc-monitor-all.txt", "--row-rate 1000"),
    ("serial-monitor-times.txt", "--row-rate 1000"),
    ("serial-plotter.txt", ""),
    ("python-logging.log", ""),
    ("labelled-with-messages.txt", ""),
    (
        "rows-end-in-semicolon.csv",
        "--column t=time,counts_large=position",
    ),
    (
        "matrix.txt",
        "--column|t=Time:s,counts_large=Encoder 1 Pos:counts",
    ),
    ("terminal-with-nul.log", ""),
    ("rows-of-nothing.csv", ""),
    (
        "prose-in-comment.txt",
        "--column t=1:s,counts_large=2:counts",
    ),
    (
        "messages-of-other-topics.csv",
        "--column t=/joint_states/header/stamp:s,counts_large=/joint_states/handle/position:rad",
    ),
    ("plotjuggler.csv", ""),
    ("labview.lvm", ""),
    (
        "twincat-scope.csv",
        "--column t=Time,counts_large=ActPos:counts",
    ),
    (
        "twincat-filetime.csv",
        "--column t=Time,counts_large=ActPos:counts",
    ),
    (
        "twincat-sample-times.csv",
        "--column t=Time,counts_large=ActPos:counts",
    ),
    (
        "ros2-echo.csv",
        "--column t=1:s+2:ns,counts_large=5:rad,current=7:A",
    ),
    (
        "several-axes.csv",
        "--column|t=time:s,counts_large=axis 0 position:rev",
    ),
];

#[test]
fn logs_read_to_the_motion_that_they_were_written_from() {
    let folder = Folder::new(HOST_SIM);
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
fn uneven_rows_become_even() {
    let folder = Folder::new(HOST_SIM);
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
    assert!(
        notes.contains("the estimators use the true steps"),
        "{notes}"
    );
}

#[test]
fn stale_readings_are_named_and_left_out() {
    let folder = Folder::new(HOST_SIM);
    let off = |rows: &[[f64; 2]]| {
        let moved = |k: usize| counts(rows[k + 1][0]) - counts(rows[k][0]);
        let periods = |k: usize| (rows[k + 1][0] - rows[k][0]) * 1e3;
        let off = steps(rows).into_iter().enumerate();
        let off = off.map(|(k, step)| (step * periods(k) - moved(k)).abs());
        off.fold(0.0, f64::max)
    };
    let (rows, notes) = replay(&folder, "stale-readings.csv", "");
    let notes = notes.split_whitespace().collect::<Vec<_>>().join(" ");
    let said = "counts_large stays in 5 rows of a fast motion and makes up for it in the next row, the first in line 23: \
                the readings are stale, as where a bus lost a message, and the estimators take them for a stop and a jump; \
                add --drop-stale to leave these rows out";
    assert!(notes.contains(said), "{notes}");
    assert_eq!(rows.len(), ROWS);
    assert!(off(&rows) > 10.0);
    let (rows, notes) = replay(&folder, "stale-readings.csv", "--drop-stale");
    let said =
        "5 rows are left out where counts_large stays in a fast motion, the first in line 23";
    assert!(notes.contains(said), "{notes}");
    assert!(!notes.contains("--drop-stale"), "{notes}");
    assert_eq!(rows.len(), ROWS - 5);
    assert!(off(&rows) < 1e-3, "{}", off(&rows));
}

#[test]
fn torque_is_divided_by_the_torque_constant() {
    // The files have 0.05 times the current as torque; a device with 0.05 N.m/A has the current again.
    let folder = Folder::new(HOST_SIM);
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
