//! `host-sim replay`: recordings good and bad.

use std::fs;
use std::io::Write as _;
use std::process::Stdio;

use crate::{DATA, Folder, HOST_SIM, json};

#[test]
fn recording_of_a_real_motor_is_replayed() {
    let folder = Folder::new(HOST_SIM);
    let recording = format!("{DATA}/back-and-forth.csv");
    let device = format!("{DATA}/hall-90.toml");
    let arguments = [
        "replay",
        &recording,
        "--device",
        &device,
        "--out",
        "v.csv",
        "--json",
        "v.json",
        // 90 counts per revolution need a longer window than the presets' 4096.
        "--set",
        "foaw-best-fit.n=64",
    ];
    let output = folder.run(&arguments);
    assert_eq!(output.status.code(), Some(0));
    let notes = String::from_utf8(output.stderr).unwrap();
    assert!(
        notes.contains("no column current; estimators left out: kalman-motor,"),
        "{notes}"
    );

    let mut reader = csv::Reader::from_path(folder.path().join("v.csv")).unwrap();
    let header = reader.headers().unwrap().clone();
    assert_eq!(&header[0], "t");
    let foaw = header
        .iter()
        .position(|name| name == "foaw-best-fit")
        .unwrap();
    let rows: Vec<_> = reader.records().map(Result::unwrap).collect();
    assert_eq!(rows.len(), 1501);
    // Once a window is full, the estimate is near the recording's own reference.
    let mut recorded = csv::Reader::from_path(folder.path().join(&recording)).unwrap();
    let recorded: Vec<_> = recorded.records().map(Result::unwrap).collect();
    for k in [100, 700, 1500] {
        let estimate: f64 = rows[k][foaw].parse().unwrap();
        let reference: f64 = recorded[k][4].parse().unwrap();
        assert!(
            (estimate - reference).abs() < 3.0,
            "row {k}: {estimate}, {reference}"
        );
    }

    let scores = json(&folder.text("v.json"));
    let rms = |name: &str| {
        let row = scores.iter().find(|row| row["estimator"] == name).unwrap();
        assert_eq!(row["scenario"], "back-and-forth.csv");
        row["rms_rad_s"].as_f64().unwrap()
    };
    // One count a tick is 69.8 rad/s here; at about a quarter of a count a tick, quantisation
    // alone costs finite difference sqrt(f (1 - f)) of it.
    assert!((15.0..35.0).contains(&rms("finite-difference")));
    assert!(rms("foaw-best-fit") < 0.1 * rms("finite-difference"));
}

#[test]
fn invalid_recordings_are_refused_by_file_line_and_column() {
    let folder = Folder::new(HOST_SIM);
    for (name, text, said) in [
        ("empty.csv", &b""[..], "empty.csv: line 1: no column t"),
        (
            "missing.csv",
            b"t,count\n0,0\n",
            "missing.csv: line 1: no column counts_large",
        ),
        (
            "text.csv",
            b"t,counts_large\n0,0\n1e-3,x\n",
            "text.csv: line 3: column counts_large",
        ),
        (
            "nan.csv",
            b"t,counts_large\n0,0\nnan,1\n",
            "nan.csv: line 3: column t",
        ),
        (
            "back.csv",
            b"t,counts_large\n0,0\n2,1\n1,2\n",
            "back.csv: line 4: column t",
        ),
        (
            "binary.csv",
            b"\x7fELF\x00\xff\xfe\n\x00\x01\x02",
            "binary.csv: line 1: the file is not text; write it as CSV",
        ),
        (
            "bits.csv",
            b"t,counts_large\n\xff\xfe,0\n",
            "bits.csv: line 2: column t: not text",
        ),
        (
            "one.csv",
            b"t,counts_large\n0,0\n",
            "one.csv: fewer than two rows",
        ),
    ] {
        folder.write(name, text);
        let line = folder.refused(&["replay", name, "--out", "o.csv", "--json", "o.json"]);
        assert!(line.contains(said), "{line}");
    }
    let line = folder.refused(&["replay", "none.csv", "--out", "o.csv"]);
    assert!(line.contains("none.csv: cannot read"), "{line}");
    folder.write("plain.csv", "t,counts_large\n0,0\n1e-3,1\n2e-3,1\n");
    let line = folder.refused(&["replay", "plain.csv", "--json", "o.json"]);
    let said = "plain.csv: 3 rows; a reference without true_omega needs at least 100";
    assert!(line.contains(said), "{line}");
    let off = ["--reference", "off"];
    let line = folder.refused(&["replay", "plain.csv", "--json", "o.json", off[0], off[1]]);
    assert!(line.contains("no column true_omega"), "{line}");
    let line = folder.refused(&[
        "replay",
        "plain.csv",
        "--estimator",
        "kalman-motor",
        "--out",
        "o.csv",
    ]);
    let said = "plain.csv: line 1: no column current, which kalman-motor needs";
    assert!(line.contains(said), "{line}");
}

#[test]
fn error_at_the_end_of_a_hundred_megabytes_is_reported_with_its_line() {
    let folder = Folder::new(HOST_SIM);
    let mut text = b"t,counts_large\n".to_vec();
    let mut row = 0_u32;
    while text.len() < 100_000_000 {
        writeln!(text, "{}.{:03},{row:012}", row / 1000, row % 1000).unwrap();
        row += 1;
    }
    text.extend_from_slice(b"1e9,end\n");
    folder.write("large.csv", &text);
    let line = folder.refused(&["replay", "large.csv", "--out", "o.csv"]);
    assert!(
        line.contains(&format!(
            "large.csv: line {}: column counts_large: 'end'",
            row + 2
        )),
        "{line}"
    );
    // And as one line without an end.
    folder.write("large.csv", vec![b'7'; 100_000_000]);
    let line = folder.refused(&["replay", "large.csv", "--out", "o.csv"]);
    assert!(
        line.contains("large.csv: line 1: no end of the line"),
        "{line}"
    );
    assert!(line.len() < 300, "{} bytes", line.len());
}

#[test]
fn closed_standard_error_does_not_end_the_command() {
    let folder = Folder::new(HOST_SIM);
    folder.write("r.csv", "t,counts_large\n0,1\n0.001,2\n");
    let mut replay = folder.command("replay r.csv --out v.csv");
    let (reader, writer) = std::io::pipe().unwrap();
    drop(reader);
    let status = replay.stdout(Stdio::null()).stderr(writer).status();
    assert_eq!(status.unwrap().code(), Some(0));
    assert!(folder.names().contains("v.csv"));
}

/// Rows of a shaft that turns back and forth, at 1 kHz, with its true velocity.
#[cfg(target_os = "linux")]
fn long_recording(rows: u32) -> Vec<u8> {
    let mut text = b"t,counts_large,true_omega\n".to_vec();
    for k in 0..rows {
        let angle = f64::from(k) * 2e-3;
        let (count, omega) = (2000.0 * angle.sin(), 6.0 * angle.cos());
        writeln!(text, "{}.{:03},{count:.0},{omega:.3}", k / 1000, k % 1000).unwrap();
    }
    text
}

/// A section has 125 000 rows in both recordings.
#[cfg(target_os = "linux")]
#[test]
fn memory_does_not_grow_with_the_rows() {
    let folder = Folder::new(HOST_SIM);
    let peak_kb = |rows: u32| {
        folder.write("long.csv", long_recording(rows));
        let mut replay = folder
            .command("replay long.csv --out v.csv --json v.json")
            .args(["--estimator", "finite-difference", "--estimator", "pll"])
            .stdout(Stdio::null())
            .spawn()
            .unwrap();
        let status = format!("/proc/{}/status", replay.id());
        let mut peak = 0_u32;
        while replay.try_wait().unwrap().is_none() {
            let text = fs::read_to_string(&status).unwrap_or_default();
            let line = text.lines().find_map(|line| line.strip_prefix("VmHWM:"));
            let kb = line.and_then(|line| line.split_whitespace().next());
            peak = kb.map_or(peak, |kb| kb.parse().unwrap());
            std::thread::sleep(std::time::Duration::from_millis(1));
        }
        assert!(replay.wait().unwrap().success());
        let written = folder.text("v.csv");
        assert_eq!(written.lines().count(), 1 + rows as usize);
        f64::from(peak)
    };
    // From half a million rows on the blocks that are on their way are all in use.
    let [short, long] = [750_000, 1_500_000].map(peak_kb);
    println!("{short} and {long} kB");
    assert!(
        short > 1000.0 && long < 1.25 * short,
        "{short} and {long} kB"
    );
}

/// A log of 2^20 counts/rev at 100 Hz, and a device with such an encoder.
fn fine_and_slow() -> Folder {
    let folder = Folder::new(HOST_SIM);
    let row = |k: u32| {
        let t = f64::from(k) / 100.0;
        format!("{t},{}\n", (2e6 * (2.0 * t).sin()).floor())
    };
    let rows: String = (0..400).map(row).collect();
    folder.write("log.csv", "t,counts_large\n".to_owned() + &rows);
    folder.write("fine.toml", "large.counts_per_rev = 1048576\n");
    folder
}

#[test]
fn estimators_without_a_design_for_the_encoder_are_left_out() {
    let folder = fine_and_slow();
    let said = "estimators left out: kalman-triple, kalman-motor: with 1048576 counts/rev at 100 Hz: \
                process_noise must be at most 2^18 on the diagonal";
    let [log, compared] = [
        "replay log.csv --out v.csv",
        "compare --no-report --scenario free-air --seconds 1 --rate 100",
    ]
    .map(|command| {
        let device = ["--device", "fine.toml"];
        let arguments: Vec<_> = command.split(' ').chain(device).collect();
        let output = folder.run(&arguments);
        let notes = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(0), "{command}: {notes}");
        notes.split_whitespace().collect::<Vec<_>>().join(" ")
    });
    for notes in [log, compared] {
        assert!(notes.contains(said), "{notes}");
    }
    let header = folder.text("v.csv");
    let header = header.lines().next().unwrap();
    assert!(header.contains(",kalman-triple-steady") && !header.contains(",kalman-triple,"));
    let ranked = json(&folder.good(&[
        "recommend",
        "log.csv",
        "--device",
        "fine.toml",
        "--json",
        "-",
    ]));
    assert!(ranked.iter().any(|row| row["estimator"] == "imm"));
    assert!(ranked.iter().all(|row| row["estimator"] != "kalman-triple"));
    // An estimator or a parameter that the user named is an error.
    for named in [
        ["--estimator", "kalman-triple"],
        ["--set", "kalman-triple.jerk=1e9"],
    ] {
        let arguments = [
            "replay",
            "log.csv",
            "--device",
            "fine.toml",
            "--out",
            "w.csv",
        ];
        let line = folder.refused(&[&arguments[..], &named].concat());
        assert!(
            line.contains("kalman-triple at 100 Hz: process_noise"),
            "{line}"
        );
    }
}

#[test]
fn estimator_without_a_design_for_the_encoder_runs_on_the_log_that_its_error_proposes() {
    let folder = fine_and_slow();
    let replay = "--estimator kalman-triple --out v.csv";
    let line = folder.refused(&format!("replay log.csv --counts-per-rev 1048576 {replay}"));
    let (_, command) = line.split_once("for a log by host-sim coarsen ").unwrap();
    let (options, _) = command
        .split_once(", or take another estimator, as imm")
        .unwrap();
    folder.good(&format!("coarsen log.csv {options} --out coarse.csv"));
    folder.good(&format!("replay coarse.csv {replay}"));
}

/// Rows at `rate_hz` of a shaft that swings, for 10 000 rows at most and 12 s.
fn at_rate(rate_hz: f64) -> String {
    let rows = (12.0 * rate_hz).min(10_000.0) as u32;
    let row = |k: u32| {
        let t = f64::from(k) / rate_hz;
        format!("{t},{}\n", (3000.0 * (1.0 - (2.0 * t).cos())).floor())
    };
    "t,counts_large\n".to_owned() + &(0..rows).map(row).collect::<String>()
}

#[test]
fn estimators_that_are_not_made_for_the_rate_are_left_out() {
    let folder = Folder::new(HOST_SIM);
    folder.write("slow.csv", at_rate(50.0));
    folder.write("fast.csv", at_rate(2e6));
    for (name, rate, nearest) in [("slow.csv", "50", "100"), ("fast.csv", "2000000", "100000")] {
        let output = folder.run(&["replay", name, "--out", "v.csv"]);
        assert_eq!(output.status.code(), Some(0), "{name}");
        let notes = String::from_utf8(output.stderr).unwrap();
        let notes = notes.split_whitespace().collect::<Vec<_>>().join(" ");
        let said = format!("{name}: {rate} rows/s; estimators that need 100 to 100000 left out:");
        assert!(notes.contains(&said), "{notes}");
        let header = folder.text("v.csv");
        let header = header.lines().next().unwrap();
        assert!(
            header.contains(",pll,") && !header.contains(",imm,"),
            "{header}"
        );
        let line = folder.refused(&["replay", name, "--estimator", "imm", "--out", "w.csv"]);
        let said =
            format!("{name}: {rate} rows/s; imm needs 100 to 100000: add --resample {nearest}");
        assert!(line.contains(&said), "{line}");
    }
    let ranked = json(&folder.good(&["recommend", "slow.csv", "--json", "-"]));
    assert!(ranked.iter().all(|row| row["estimator"] != "imm"));
    let resampled = ["--estimator", "imm", "--resample", "100", "--out", "w.csv"];
    folder.good(&[&["replay", "slow.csv"][..], &resampled].concat());
    // A wrong value of the user is an error at any rate.
    for name in ["slow.csv", "fast.csv"] {
        let line = folder.refused(&["replay", name, "--set", "imm.no=1", "--out", "w.csv"]);
        assert!(line.contains("imm"), "{line}");
    }
}

#[test]
fn named_estimator_without_its_column_is_refused() {
    let folder = Folder::new(HOST_SIM);
    let recording = format!("{DATA}/back-and-forth.csv");
    let named = ["--estimator", "pll", "--estimator", "kalman-motor"];
    for (command, out) in [("replay", "v.csv"), ("plot", "v.svg")] {
        let line = folder.refused(&[&[command, &recording, "--out", out], &named[..]].concat());
        let said = "line 1: no column current, which kalman-motor needs; see host-sim estimators";
        assert!(line.contains(said), "{command}: {line}");
        assert!(!folder.path().join(out).exists());
    }
}

#[test]
fn standard_deviations_are_columns_beside_the_velocities() {
    let folder = Folder::new(HOST_SIM);
    let log = format!("{DATA}/back-and-forth.csv");
    let replay = format!("replay {log} --counts-per-rev 90 --estimator pll --estimator imm");
    let csv = folder.good(&format!("{replay} --deviations"));
    let without = folder.good(&replay);
    assert_eq!(csv.lines().next(), Some("t,pll,imm,imm_sd"));
    assert_eq!(csv.lines().count(), without.lines().count());
    let mut shares = [0, 0];
    let truth = folder.text(&log);
    for ((line, plain), truth) in csv
        .lines()
        .zip(without.lines())
        .zip(truth.lines())
        .skip(200)
    {
        let (rest, sd) = line.rsplit_once(',').unwrap();
        assert_eq!(rest, plain);
        let velocity: f64 = rest.rsplit_once(',').unwrap().1.parse().unwrap();
        let truth: f64 = truth.split(',').nth(4).unwrap().parse().unwrap();
        let sd: f64 = sd.parse().unwrap();
        assert!(sd > 0.0, "{line}");
        shares[usize::from((velocity - truth).abs() < 2.0 * sd)] += 1;
    }
    assert!(shares[1] > 4 * shares[0], "{shares:?}");
    let none = format!("replay {log} --estimator pll --deviations");
    let (_, notes) = folder.ends(0, &none);
    let said = "--deviations: none of these estimators reports a standard deviation";
    assert!(notes.contains(said), "{notes}");
    let line = folder.refused(&format!("{none} --json -"));
    assert!(
        line.contains("--json - writes no velocities; give --out FILE.csv"),
        "{line}"
    );
}
