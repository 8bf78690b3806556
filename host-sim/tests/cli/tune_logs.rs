//! `host-sim tune` on recordings.

use std::f64::consts::TAU;

use crate::{Folder, HOST_SIM};

const NAMES: [&str; 4] = ["pll", "low-pass", "foaw-best-fit", "observer-held"];

/// Eight seconds at 1 kHz and 4096 counts/rev: the angle, rad, and its derivative at `t`.
fn log(motion: impl Fn(f64) -> (f64, f64)) -> String {
    let row = |k: u32| {
        let t = f64::from(k) * 1e-3;
        let (angle, omega) = motion(t);
        format!("{t},{},{omega}\n", (angle * 4096.0 / TAU).floor())
    };
    let rows: String = (0..8000).map(row).collect();
    format!("t,counts_large,true_omega\n{rows}")
}

/// Slow, and in every other second with a vibration of 12 Hz.
fn now_slow_now_fast(t: f64) -> (f64, f64) {
    let slow = (0.3 * t, 0.3);
    match t as u32 % 2 {
        0 => slow,
        _ => {
            let phase = 12.0 * TAU * t;
            let fast = (2.0 * (1.0 - phase.cos()) / (12.0 * TAU), 2.0 * phase.sin());
            (slow.0 + fast.0, slow.1 + fast.1)
        }
    }
}

/// RMS errors of `replay` in the second, the fourth and so on of the seconds, without the first tenth
/// of each.
fn held_out(folder: &Folder, names: &[&str], more: &[&str]) -> Vec<f64> {
    let mut arguments = vec!["replay", "log.csv", "--out", "v.csv"];
    arguments.extend(names.iter().flat_map(|name| ["--estimator", name]));
    arguments.extend(more);
    folder.good(&arguments);
    let column = |file: &str, name: &str| -> Vec<f64> {
        let mut reader = csv::Reader::from_path(folder.path().join(file)).unwrap();
        let place = reader.headers().unwrap().iter().position(|n| n == name);
        let place = place.unwrap();
        let rows = reader.records().map(Result::unwrap);
        rows.map(|row| row[place].parse().unwrap()).collect()
    };
    let truth = column("log.csv", "true_omega");
    let rms = |name: &&str| {
        let errors = column("v.csv", name).into_iter().zip(&truth).enumerate();
        let unseen = errors.filter(|(k, _)| (k / 1000) % 2 == 1 && k % 1000 >= 100);
        let squares: Vec<_> = unseen.map(|(_, (v, truth))| (v - truth).powi(2)).collect();
        (squares.iter().sum::<f64>() / squares.len() as f64).sqrt()
    };
    names.iter().map(rms).collect()
}

/// Tunes `estimator` on log.csv into tuned.toml, and returns what is reported on standard error.
fn notes_of_tuning(folder: &Folder, estimator: &str) -> String {
    let tune = ["tune", "log.csv", "--out", "tuned.toml", "--estimator"];
    let output = folder.run(&[&tune[..], &[estimator]].concat());
    let errors = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(0), "{errors}");
    errors
}

#[test]
fn found_parameters_are_better_in_the_held_out_seconds() {
    let folder = Folder::new(HOST_SIM);
    let simulate = "simulate --scenario track --rate 1000 --seconds 6 --out log.csv";
    folder.good(simulate);
    let mut tune = vec!["tune", "log.csv", "--out", "tuned.toml"];
    tune.extend(NAMES.iter().flat_map(|name| ["--estimator", name]));
    let table = folder.good(&tune);
    let before = held_out(&folder, &NAMES, &[]);
    let after = held_out(&folder, &NAMES, &["--presets", "tuned.toml"]);
    for (name, (before, after)) in NAMES.iter().zip(before.iter().zip(&after)) {
        let line = table.lines().find(|line| line.starts_with(name)).unwrap();
        let fields: Vec<_> = line.split_whitespace().collect();
        let [shown_before, shown_after] = [3, 4].map(|k| fields[k].parse::<f64>().unwrap());
        assert!((shown_before - before).abs() < 1e-4, "{line}: {before}");
        match fields.get(5) {
            None => {
                assert!(after < before, "{line}");
                assert!((shown_after - after).abs() < 1e-4, "{line}: {after}");
            }
            Some(_) => assert_eq!(after, before, "{line}"),
        }
    }
    // The shipped ones are tuned for wrong constants too.
    assert!(after[3] < 0.9 * before[3], "{before:?} became {after:?}");

    // Without the truth the log's own reference takes its place, and that is said.
    let text = folder.text("log.csv");
    let rows = text
        .lines()
        .map(|line| line.rsplit_once(',').unwrap().0.to_owned() + "\n");
    folder.write("log.csv", rows.collect::<String>());
    let errors = notes_of_tuning(&folder, "pll");
    assert!(
        errors.contains("log.csv: no column true_omega; errors are those against"),
        "{errors}"
    );
}

/// A telescope: 7.9e-5 rad/s at 100 Hz.
#[test]
fn errors_of_a_slow_device_have_four_digits() {
    let folder = Folder::new(HOST_SIM);
    let row = |k: u32| format!("{},{}\n", f64::from(k) / 100.0, k / 2);
    let rows: String = (0..1200).map(row).collect();
    folder.write("log.csv", format!("t,counts_large\n{rows}"));
    let table =
        folder.good("tune log.csv --counts-per-rev 4000000 --estimator low-pass --out tuned.toml");
    let line = table.lines().find(|line| line.starts_with("low-pass"));
    let shown: Vec<_> = line.unwrap().split_whitespace().skip(1).take(4).collect();
    for error in shown {
        // A count in a row is 1.6e-4 rad/s.
        let value: f64 = error.parse().unwrap();
        assert!(value > 0.0 && value < 1.6e-4, "{table}");
        assert!(!error.starts_with("0.000"), "{table}");
    }
}

#[test]
fn assumed_encoder_and_constants_are_said() {
    let folder = Folder::new(HOST_SIM);
    let log = log(now_slow_now_fast).replace('\n', ",0\n");
    folder.write("log.csv", log.replacen(",0\n", ",current\n", 1));
    folder.write("mine.toml", "");
    let notes = |more: &str| {
        let command = format!("tune log.csv --shard 1/1 --out parts {more}");
        folder.good(&command);
        folder.text("parts/shard-1-of-1.jsonl")
    };
    let counts = "4096 counts/rev assumed: give --counts-per-rev or --device";
    let pll = notes("--estimator pll");
    assert!(pll.contains(counts), "{pll}");
    let pll = notes("--estimator pll --counts-per-rev 4096");
    assert!(!pll.contains("assumed"), "{pll}");
    let pll = notes("--estimator pll --device mine.toml");
    assert!(!pll.contains("assumed"), "{pll}");
    let both = "4096 counts/rev and constants of the default device assumed: give --device";
    let observer = notes("--estimator observer-held");
    assert!(observer.contains(both), "{observer}");
}

#[test]
fn errors_are_those_of_all_recordings_together() {
    let [folder, other] = [HOST_SIM; 2].map(Folder::new);
    folder.write("log.csv", log(now_slow_now_fast));
    // The low-pass lags behind this motion.
    let fast = |t: f64| (10.0 * (1.0 - (9.0 * t).cos()), 90.0 * (9.0 * t).sin());
    other.write("log.csv", log(fast));
    let second = other.path().join("log.csv");
    let tune = [
        "tune",
        "log.csv",
        "--estimator",
        "low-pass",
        "--out",
        "tuned.toml",
    ];
    let table = folder.good(&[&tune[..], &[second.to_str().unwrap()]].concat());
    let line = table
        .lines()
        .find(|line| line.starts_with("low-pass"))
        .unwrap();
    let shown: f64 = line.split_whitespace().nth(3).unwrap().parse().unwrap();
    let [a, b] = [&folder, &other].map(|folder| held_out(folder, &["low-pass"], &[])[0]);
    let both = ((a * a + b * b) / 2.0).sqrt();
    assert!((shown - both).abs() < 1e-4, "{line}: {a} and {b}");
    assert!((a - b).abs() > 0.1 * both, "{a} and {b}");
}

#[test]
fn parameters_that_fail_in_the_held_out_seconds_are_not_written() {
    let folder = Folder::new(HOST_SIM);
    let names = ["low-pass"];
    folder.write("log.csv", log(now_slow_now_fast));
    let errors = notes_of_tuning(&folder, "low-pass");
    let said =
        "low-pass: the parameters are kept; the ones found are not better in the held-out half";
    assert!(errors.contains(said), "{errors}");
    let (before, after) = (
        held_out(&folder, &names, &[]),
        held_out(&folder, &names, &["--presets", "tuned.toml"]),
    );
    assert_eq!(before, after);
}

#[test]
fn end_of_the_range_is_reported_on_a_log() {
    let folder = Folder::new(HOST_SIM);
    folder.write("log.csv", log(|t| (0.3 * t, 0.3)));
    let errors = notes_of_tuning(&folder, "low-pass");
    assert!(
        errors.contains("Hz is the lower limit of the searched range"),
        "{errors}"
    );
}

#[test]
fn recordings_that_do_not_suffice_are_refused() {
    let folder = Folder::new(HOST_SIM);
    let text = log(now_slow_now_fast);
    let first = |rows: usize| -> String { text.split_inclusive('\n').take(rows).collect() };
    folder.write("log.csv", &text);
    folder.write("short.csv", first(3001));
    folder.write(
        "still.csv",
        log(|_| (0.0, 0.0)).replace("true_omega", "note"),
    );
    let slow: Vec<_> = text
        .lines()
        .enumerate()
        .filter(|(k, _)| *k == 0 || k % 2 == 1)
        .collect();
    folder.write(
        "slow.csv",
        slow.iter()
            .map(|(_, line)| format!("{line}\n"))
            .collect::<String>(),
    );
    for (arguments, said) in [
        (
            &["short.csv"][..],
            "short.csv: 3 s are too short; tuning needs 4 s",
        ),
        (
            &["log.csv", "slow.csv"],
            "slow.csv: its rate is 500 Hz and that of log.csv 1000",
        ),
        (
            &["still.csv"],
            "still.csv: no column true_omega, and no reference: ",
        ),
        (
            &["log.csv", "--seeds", "2"],
            "cannot be used with '--seeds <N>'",
        ),
        (
            &["log.csv", "--estimator", "kalman-motor"],
            "no estimator to tune has the columns",
        ),
        (&["none.csv"], "none.csv: cannot read"),
    ] {
        let line = folder.refused(&[&["tune", "--out", "new.toml"], arguments].concat());
        assert!(line.contains(said), "{line}");
    }
}

#[test]
fn options_that_read_a_recording_need_one() {
    let folder = Folder::new(HOST_SIM);
    for option in [
        "--resample 1000",
        "--row-rate 1000",
        "--counts-per-rev 4096",
        "--modulus 4096",
        "--column t=time",
    ] {
        let line = folder.refused(&format!("tune --estimator low-pass --out p.toml {option}"));
        let said = "--resample and --counts-per-rev read a recording: give RECORDING";
        assert!(line.contains(said), "{option}: {line}");
    }
}

#[test]
fn counts_that_a_recording_states_beside_the_options_are_said() {
    let folder = Folder::new(HOST_SIM);
    let log = log(now_slow_now_fast);
    folder.write("stated.csv", format!("# counts_per_rev = 16384\n{log}"));
    let output =
        folder.run("tune stated.csv --estimator low-pass --out p.toml --counts-per-rev 4096");
    let notes = String::from_utf8(output.stderr).unwrap();
    let said = "stated.csv: 4096 counts/rev of the options are used; the recording states 16384";
    assert!(notes.contains(said), "{notes}");
    // The values are scaled from these counts.
    let tuned = folder.text("p.toml");
    assert!(tuned.contains("\ncounts_per_rev = 4096\n"), "{tuned}");
}
