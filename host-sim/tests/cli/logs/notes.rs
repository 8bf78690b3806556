//! What is reported about a log that is read.

use super::{LOGS, replay};
use crate::{Folder, HOST_SIM};

#[test]
fn columns_and_units_that_were_converted_are_reported() {
    let folder = Folder::new(HOST_SIM);
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
            "times-of-day.csv",
            "--column t=clock,counts_large=encoder",
            "midnight passes in line 102, and t goes on",
        ),
        (
            "dates.csv",
            "--column t=time,counts_large=encoder",
            "t is a date and a time: s from the midnight before the first row on",
        ),
        (
            "minutes.csv",
            "--column t=time,counts_large=counts",
            "an hour is full in line 102, and t goes on",
        ),
        (
            "serial-monitor-times.txt",
            "--row-rate 1000",
            "the times of a serial monitor before the lines are not read: they are those of arrival",
        ),
        (
            "wraps-at-32-bits.csv",
            "--column t=micros,counts_large=encoder,edge_tick=capture_us,edge_bound=capture_bound",
            "t wraps at 2^32 us and is unwrapped, the first time in line 103: a counter of 32 bits \
             LOGS/wraps-at-32-bits.csv: edge_tick wraps at 2^32 and is unwrapped, the first time in line 103",
        ),
        (
            "plotjuggler.csv",
            "",
            "current from '/joint_states/handle/effort' (N.m with 0.",
        ),
        (
            "plotjuggler.csv",
            "",
            "10 rows without a position are left out, the first in line 6",
        ),
        (
            "several-axes.csv",
            "--column|t=time:s,counts_large=axis 0 position:rev",
            "80 rows without a position are left out, the first in line 2",
        ),
        (
            "missing-rows.csv",
            "",
            "3 rows are missing in 2 gaps of at most 2, the first before line 102 at 0.102 s",
        ),
    ] {
        let (_, notes) = replay(&folder, log, options);
        let notes = notes.split_whitespace().collect::<Vec<_>>().join(" ");
        assert!(
            notes.contains(&said.replace("LOGS", LOGS)),
            "{log}: {notes}"
        );
    }
    // Nothing is said about a log that needs no conversion.
    let (_, notes) = replay(&folder, "own.csv", "");
    assert!(!notes.contains("from '"), "{notes}");
}

#[test]
fn positions_off_whole_counts_are_reported() {
    let folder = Folder::new(HOST_SIM);
    folder.write("coarse.toml", "large.counts_per_rev = 1000\n");
    let device = "--column counts_large=angle:deg --device coarse.toml";
    let (_, notes) = replay(&folder, "absolute-deg.csv", device);
    let notes = notes.split_whitespace().collect::<Vec<_>>().join(" ");
    let said = "counts from whole counts with 1000 counts/rev and are rounded to the nearest; they are multiples of \
                1/4096 revolution: if these are the encoder's counts, give 4096 counts/rev with --counts-per-rev, or as \
                large.counts_per_rev in the file of --device";
    assert!(notes.contains(said), "{notes}");
}

/// 5 s at 1 kHz of a shaft that swings, with its current as `ampere` writes 0.9 A.
fn with_current(column: &str, ampere: &str) -> String {
    let mut text = format!("t,counts_large,{column}\n");
    for k in 0..5000 {
        let t = f64::from(k) * 1e-3;
        let count = (3000.0 * (4.0 * t).sin()).floor();
        let sign = if (4.0 * t).sin() > 0.0 { "-" } else { "" };
        text += &format!("{t},{count},{sign}{ampere}\n");
    }
    text
}

#[test]
fn current_that_no_amplifier_delivers_is_reported_once_a_file() {
    let folder = Folder::new(HOST_SIM);
    folder.write("ma.csv", with_current("iq", "900"));
    folder.write("own.csv", with_current("current", "900"));
    folder.write("a.csv", with_current("current", "0.9"));
    folder.write("d.toml", "large.current_limit_a = 50\n");
    let said = |name: &str, theirs: &str| {
        format!(
            "{name}.csv: column current reaches 900 A, where large.current_limit_a is 6; if it is in mA, \
             give --column 'current={theirs}:mA'"
        )
    };
    let notes = |command: &str| {
        let output = folder.run(command);
        let notes = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(0), "{command}: {notes}");
        notes.split_whitespace().collect::<Vec<_>>().join(" ")
    };
    for command in [
        "replay LOG --estimator pll --out v.csv",
        "replay LOG --estimator pll --resample 500 --out v.csv",
        "recommend LOG",
        "tune LOG --estimator low-pass --out p.toml",
        "plot LOG --out p.svg",
    ] {
        let of = |log: &str| notes(&command.replace("LOG", log));
        for (log, name, theirs) in [
            ("own.csv", "own", "current"),
            ("ma.csv --column current=iq", "ma", "iq"),
        ] {
            let notes = of(log);
            let said = said(name, theirs);
            assert_eq!(notes.matches(&said).count(), 1, "{command}: {notes}");
        }
        for log in [
            "a.csv",
            "ma.csv",
            "ma.csv --column current=iq:mA",
            "own.csv --device d.toml",
        ] {
            let notes = of(log);
            assert!(!notes.contains("in mA"), "{command}, {log}: {notes}");
        }
    }
    folder.write("other.csv", with_current("current", "901"));
    let both = notes("recommend own.csv other.csv");
    assert_eq!(both.matches("if it is in mA").count(), 2, "{both}");
    let line = folder.refused("identify own.csv --clamped");
    assert!(
        line.contains(&said("own", "current")["own.csv: ".len()..]),
        "{line}"
    );
}

#[test]
fn counts_that_a_logger_clips_are_reported() {
    let folder = Folder::new(HOST_SIM);
    let count = |k: i32| 40_000.0 * (f64::from(k) * 0.004).sin();
    let row = |k: i32| {
        format!(
            "{},{:.0}\n",
            f64::from(k) * 1e-3,
            count(k).clamp(-32_768.0, 32_767.0)
        )
    };
    let text: String = (0..1500).map(row).collect();
    folder.write("clipped.csv", format!("t,counts\n{text}"));
    let output = folder.run(&[
        "replay",
        "clipped.csv",
        "--estimator",
        "pll",
        "--out",
        "v.csv",
    ]);
    assert_eq!(output.status.code(), Some(0));
    let notes = String::from_utf8(output.stderr).unwrap();
    let said = "clipped.csv: counts_large comes to 32767 and stays there, in ";
    assert!(notes.contains(said), "{notes}");
}

#[test]
fn errors_and_notes_name_the_path_as_it_is_given() {
    let folder = Folder::new(HOST_SIM);
    std::fs::create_dir(folder.path().join("logs")).unwrap();
    let rows = |n: usize| {
        with_current("current", "0.9")
            .lines()
            .take(n)
            .collect::<Vec<_>>()
            .join("\n")
    };
    folder.write("logs/short.csv", rows(11) + "\n");
    folder.write("logs/long.csv", rows(5001) + "\n");
    for command in ["recommend logs/short.csv", "identify logs/short.csv"] {
        let line = folder.refused(command);
        assert!(
            line.starts_with("error: logs/short.csv: "),
            "{command}: {line}"
        );
    }
    for command in [
        "replay logs/long.csv --estimator pll --out v.csv",
        "recommend logs/long.csv",
    ] {
        let output = folder.run(command);
        let notes = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(0), "{command}: {notes}");
        let named: Vec<_> = notes
            .lines()
            .filter(|line| line.contains(".csv: "))
            .collect();
        assert!(!named.is_empty(), "{command}: {notes}");
        let is_path = |line: &&str| line.starts_with("logs/long.csv: ");
        assert!(named.iter().all(is_path), "{command}: {notes}");
    }
}
