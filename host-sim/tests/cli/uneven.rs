//! Recordings whose rows come at uneven times.

use std::f64::consts::{PI, TAU};

use crate::{DATA, Folder, HOST_SIM, json};

/// The logs of that folder which are read here.
pub(crate) const LOGS: [&str; 3] = ["uneven.csv", "jittered.csv", "milliseconds-at-300-hz.csv"];

const COUNTS_PER_REV: f64 = 4096.0;

/// Estimators that take a varying period: the first four read counts alone.
const VARYING: [&str; 7] = [
    "finite-difference",
    "low-pass",
    "imm",
    "imm-pair",
    "m-over-t",
    "m-over-t-learned",
    "imm-edge",
];

fn log(name: &str) -> String {
    format!("{DATA}/logs/{name}")
}

/// The motion of the logs: counts at `t` seconds, as README.md there states.
fn counts(t: f64) -> f64 {
    let revolutions = 0.8 + 0.6 * t + 0.4 * (2.0 * PI * 1.5 * t).sin();
    (COUNTS_PER_REV * revolutions).floor()
}

/// Its velocity, rad/s.
fn omega(t: f64) -> f64 {
    TAU * (0.6 + 0.4 * 2.0 * PI * 1.5 * (2.0 * PI * 1.5 * t).cos())
}

/// Header and rows of a CSV of numbers.
fn table(text: &str) -> (Vec<String>, Vec<Vec<f64>>) {
    let mut lines = text.lines();
    let names = lines.next().unwrap().split(',').map(str::to_owned);
    let row = |line: &str| {
        line.split(',')
            .map(|field| field.parse().unwrap())
            .collect()
    };
    (names.collect(), lines.map(row).collect())
}

/// Velocities of one estimator, each after its time.
fn velocities(folder: &Folder, arguments: &[&str]) -> Vec<[f64; 2]> {
    let (_, rows) = table(&folder.good(arguments));
    rows.iter().map(|row| [row[0], row[1]]).collect()
}

#[test]
fn finite_difference_is_the_displacement_over_the_true_step() {
    let folder = Folder::new(HOST_SIM);
    for name in ["uneven.csv", "jittered.csv"] {
        let rows = velocities(
            &folder,
            &["replay", &log(name), "--estimator", "finite-difference"],
        );
        assert_eq!(rows.len(), 240);
        for pair in rows.windows(2) {
            let [[before, _], [now, velocity]] = [pair[0], pair[1]];
            let moved = (counts(now) - counts(before)) * TAU / COUNTS_PER_REV;
            // Six digits of t are 0.1 % of a step; the velocity is exact to those of f32.
            let expected = moved / (now - before);
            assert!(
                (velocity - expected).abs() < 1e-5 * expected.abs().max(1.0),
                "{name} at {now}: {velocity} {expected}"
            );
        }
    }
}

#[test]
fn true_steps_have_a_smaller_error_than_a_constant_period() {
    let folder = Folder::new(HOST_SIM);
    let text = folder.text(&log("jittered.csv"));
    let times: Vec<f64> = text
        .lines()
        .skip(1)
        .map(|line| line.split(',').next().unwrap().parse().unwrap())
        .collect();
    for estimator in VARYING {
        let rms = |options: &[&str]| {
            let path = log("jittered.csv");
            let base = ["replay", &path, "--estimator", estimator];
            let rows = velocities(&folder, &[&base[..], options].concat());
            let errors = rows.iter().zip(&times).skip(30);
            let squares = errors.map(|([_, velocity], t)| (velocity - omega(*t)).powi(2));
            (squares.sum::<f64>() / 210.0).sqrt()
        };
        // The same rows as if they were 1 ms apart.
        let [varying, constant] = [rms(&[]), rms(&["--row-rate", "1000"])];
        assert!(
            varying < 0.5 * constant,
            "{estimator}: {varying} {constant}"
        );
    }
}

/// 1 % of the readings of a swing of up to 12 rad/s are stale; 16384 counts per revolution.
#[test]
fn stale_readings_cost_a_bank_most_of_its_accuracy() {
    let folder = Folder::new(HOST_SIM);
    let mut text = "t,counts_large\n".to_owned();
    let mut last = 0.0;
    for k in 0..5000 {
        let t = 1e-3 * f64::from(k);
        if k % 101 != 50 {
            last = (4.0 * COUNTS_PER_REV / TAU * 3.0 * (4.0 * t).sin()).floor();
        }
        text += &format!("{t:.3},{last}\n");
    }
    folder.write("bus.csv", text);
    let rms = |options: &[&str]| {
        let base = "replay bus.csv --estimator imm --counts-per-rev 16384";
        let base: Vec<_> = base.split(' ').collect();
        let rows = velocities(&folder, &[&base[..], options].concat());
        let squares = rows[500..].iter();
        let squares = squares.map(|[t, velocity]| (velocity - 12.0 * (4.0 * t).cos()).powi(2));
        (squares.sum::<f64>() / (rows.len() - 500) as f64).sqrt()
    };
    let [with, without] = [rms(&[]), rms(&["--drop-stale"])];
    println!("RMS of imm {with:.3} rad/s with stale readings, {without:.3} without");
    assert!(10.0 * without < with, "{with} {without}");
}

#[test]
fn estimators_that_assume_a_constant_period_are_left_out_with_one_note() {
    let folder = Folder::new(HOST_SIM);
    let path = log("jittered.csv");
    let output = folder.run(&["replay", &path]);
    assert_eq!(output.status.code(), Some(0));
    let (names, _) = table(&String::from_utf8(output.stdout).unwrap());
    let mut found: Vec<_> = names[1..].iter().map(String::as_str).collect();
    found.sort_unstable();
    let mut expected = VARYING;
    expected.sort_unstable();
    assert_eq!(found, expected);
    let notes = String::from_utf8(output.stderr).unwrap();
    let notes = notes.split_whitespace().collect::<Vec<_>>().join(" ");
    let said = "the estimators use the true steps; estimators that assume a constant period left out: \
                foaw-end-fit, foaw-best-fit, ";
    assert!(notes.contains(said), "{notes}");
    assert_eq!(notes.matches("constant period").count(), 1, "{notes}");
    assert!(notes.contains("kalman-triple-steady, pll"), "{notes}");
    assert!(notes.contains("--resample 1"), "{notes}");
    let rows = json(&folder.good(&["replay", &path, "--json", "-"]));
    assert!(rows.iter().all(|row| row["period"] == "varying"));
    // An even recording runs all estimators that its columns allow.
    let rows = json(&folder.good(&["replay", &log("own.csv"), "--json", "-"]));
    assert!(rows.iter().all(|row| row["period"] == "constant"));
    assert!(rows.iter().any(|row| row["estimator"] == "pll"));
    let even = ["replay", &path, "--resample", "1000", "--json", "-"];
    let rows = json(&folder.good(&even));
    assert!(rows.iter().any(|row| row["estimator"] == "pll"));
    assert!(rows.iter().all(|row| row["period"] == "constant"));
}

#[test]
fn list_of_estimators_says_which_take_uneven_times() {
    let text = Folder::new(HOST_SIM).good(&["estimators"]);
    let mut name = "";
    let mut found = Vec::new();
    for line in text.lines() {
        if !line.starts_with(' ') {
            name = line.split(' ').next().unwrap();
        } else if line == "  takes rows at uneven times" {
            found.push(name);
        }
    }
    found.sort_unstable();
    let mut expected = VARYING;
    expected.sort_unstable();
    assert_eq!(found, expected);
}

#[test]
fn named_estimator_that_assumes_a_constant_period_is_refused() {
    let folder = Folder::new(HOST_SIM);
    let path = log("jittered.csv");
    for command in ["replay", "plot", "tune"] {
        let named = [
            command,
            &path,
            "--estimator",
            "foaw-best-fit",
            "--estimator",
            "low-pass",
            "--out",
            "out",
        ];
        let error = folder.refused(&named);
        for said in [
            "jittered.csv: t is uneven in ",
            "; foaw-best-fit needs a constant period: add --resample 1",
            "or name one of finite-difference, low-pass, ",
        ] {
            assert!(error.contains(said), "{command}: {error}");
        }
    }
    let named = ["replay", &path, "--estimator", "foaw-best-fit"];
    folder.good(&[&named[..], &["--resample", "1000"]].concat());
}

#[test]
fn recommend_and_plot_say_what_they_leave_out() {
    let folder = Folder::new(HOST_SIM);
    let path = log("jittered.csv");
    let arguments = ["recommend", &path, "--report", "page", "--json", "-"];
    let ranked = json(&folder.good(&arguments));
    assert_eq!(ranked.len(), VARYING.len());
    for row in &ranked {
        assert!(
            VARYING.iter().any(|name| row["estimator"] == *name),
            "{row}"
        );
        assert_eq!(row["logs"][0]["period"], "varying");
    }
    let page = folder.text("page/index.html");
    assert!(page.contains("estimators that assume a constant period left out: foaw-end-fit"));
    let output = folder.run(&["plot", &path, "--out", "p.svg"]);
    let notes = String::from_utf8(output.stderr).unwrap();
    let notes = notes.split_whitespace().collect::<Vec<_>>().join(" ");
    let said = "estimators that assume a constant period left out: kalman-triple-steady;";
    assert!(notes.contains(said), "{notes}");
    let svg = folder.text("p.svg");
    assert!(svg.contains("finite-difference") && !svg.contains("kalman-triple-steady"));
}

#[test]
fn tune_searches_the_estimators_that_use_true_steps() {
    let folder = Folder::new(HOST_SIM);
    let (mut text, mut t) = (String::from("t,counts_large,true_omega\n"), 0.0);
    for k in 0..5000_u32 {
        text += &format!("{t:.6},{},{}\n", counts(t), omega(t));
        // Steps of 0.6 to 1.4 ms.
        t += 1e-3 * (0.6 + 0.8 * f64::from(k * 7919 % 1000) / 1000.0);
    }
    folder.write("log.csv", text);
    let output = folder.run(&["tune", "log.csv", "--out", "-"]);
    let notes = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(0), "{notes}");
    assert!(
        notes.contains("the estimators use the true steps"),
        "{notes}"
    );
    let presets = String::from_utf8(output.stdout).unwrap();
    assert!(presets.contains("low-pass"), "{presets}");
    assert!(
        !presets.contains("pll]") && !presets.contains("pll ="),
        "{presets}"
    );
}

#[test]
fn steps_that_the_digits_of_t_explain_are_a_constant_period() {
    // 3.33 ms are 3 or 4 whole milliseconds.
    let folder = Folder::new(HOST_SIM);
    let path = log("milliseconds-at-300-hz.csv");
    let base = ["replay", &path, "--column", "t=t_ms"];
    let output = folder.run(&[&base[..], &["--json", "-"]].concat());
    let notes = String::from_utf8(output.stderr).unwrap();
    let notes = notes.split_whitespace().collect::<Vec<_>>().join(" ");
    assert!(
        notes.contains("the few digits of t explain them"),
        "{notes}"
    );
    let rows = json(&String::from_utf8(output.stdout).unwrap());
    assert!(rows.iter().any(|row| row["estimator"] == "pll"));
    let rows = velocities(
        &folder,
        &[&base[..], &["--estimator", "finite-difference"]].concat(),
    );
    for (k, [_, velocity]) in rows.iter().enumerate().skip(1) {
        let [before, now] = [k - 1, k].map(|k| counts(k as f64 / 300.0));
        let expected = (now - before) * TAU / COUNTS_PER_REV * 300.0;
        // The rate is known to 0.2 % from 240 rows in whole milliseconds.
        assert!(
            (velocity - expected).abs() < 5e-3 * expected.abs().max(1.0),
            "{k}"
        );
    }
}

#[test]
fn rows_in_bursts_and_counts_of_no_encoder_are_refused() {
    let folder = Folder::new(HOST_SIM);
    // 1 kHz, 16 rows at a time, 40 us apart.
    let mut text = String::from("t,counts_large,true_omega\n");
    for k in 0..4000 {
        let t = f64::from(k / 16 * 16) * 1e-3 + f64::from(k % 16) * 4e-5;
        text += &format!("{t},{},1\n", 16 * k);
    }
    folder.write("f.csv", text);
    let said = "f.csv: column t: the rows come in bursts, about 16 rows each 16 ms";
    let coarsen =
        "coarsen f.csv --counts-per-rev 1000 --rate 500 --out c.csv --fine-counts-per-rev";
    let line = folder.refused(&format!("{coarsen} 100000"));
    assert!(line.contains(said), "{line}");
    // Their times are not those of the measurement.
    folder.good(&format!("{coarsen} 100000 --row-rate 1000"));
    for kind in ["fine", "coarse"] {
        let list = format!(
            "[[recording]]\nfile = 'f.csv'\nwhat = 'x'\nkind = '{kind}'\ncounts_per_rev = 100000\n"
        );
        folder.write("recordings.toml", list);
        let line = folder.refused("real --data . --rate 500 --counts-per-rev 1000");
        assert!(line.contains(said), "{kind}: {line}");
    }
    for command in ["recommend f.csv", "tune f.csv --estimator pll --out p.toml"] {
        let line = folder.refused(command);
        assert!(line.contains(said), "{command}: {line}");
    }
    let line = folder.refused(&format!("{coarsen} 4000000000"));
    let said = "from 16 to 4000000 counts per revolution; of a finer encoder, divide the counts";
    assert!(
        line.contains("--fine-counts-per-rev") && line.contains(said),
        "{line}"
    );
}
