//! `host-sim recommend`: which estimator to use on a user's device.

use std::collections::BTreeMap;
use std::f64::consts::TAU;
use std::fmt::Write as _;

use serde_json::Value;

use crate::{DATA, Folder, HOST_SIM, json};

/// Counts of a shaft with 4096 counts/rev at 1 kHz that swings by two radians, for 3 s.
fn swing() -> String {
    swing_of(3000)
}

fn swing_of(rows: u16) -> String {
    let mut text = String::from("t,counts_large\n");
    for k in 0..rows {
        let t = f64::from(k) * 1e-3;
        let angle = 2.0 * (1.0 - (10.0 * t).cos());
        let count = (angle * 4096.0 / TAU).floor();
        let _ = writeln!(text, "{t:.3},{count}");
    }
    text
}

fn recommended<'a>(rows: &'a [Value], why: &str) -> &'a Value {
    let mut rows = rows.iter().filter(|row| row["recommended"] == why);
    let row = rows.next().unwrap();
    assert!(rows.next().is_none(), "two rows {why}");
    row
}

#[test]
fn real_motor_gets_estimators_ranked_against_its_truth() {
    let folder = Folder::new(HOST_SIM);
    let log = format!("{DATA}/back-and-forth.csv");
    let arguments = ["recommend", &log, "--counts-per-rev", "90"];
    let text = folder.good(&arguments);
    // A long path is a line of its own.
    let words: Vec<_> = text.split_whitespace().collect();
    let said = format!("{log}: 1501 rows at 1000 Hz, the shaft turns within ");
    assert!(words.join(" ").starts_with(&said), "{text}");
    for said in [
        "(best)",
        "(cheap)",
        "Most accurate",
        "Scale::new(90, RATE)",
        "pub fn update",
    ] {
        assert!(text.contains(said), "{said}: {text}");
    }
    let rows = json(&folder.good(&[&arguments[..], &["--json", "-"]].concat()));
    let errors: Vec<f64> = rows
        .iter()
        .map(|row| row["rms_pct"].as_f64().unwrap())
        .collect();
    assert!(errors.is_sorted(), "{errors:?}");
    // Scores are those of replay on the same recording.
    let device = format!("{DATA}/hall-90.toml");
    let replayed = json(&folder.good(&["replay", &log, "--device", &device, "--json", "-"]));
    for row in &rows {
        let same = replayed
            .iter()
            .find(|other| other["estimator"] == row["estimator"])
            .unwrap();
        assert_eq!(
            row["logs"][0]["rms_rad_s"], same["rms_rad_s"],
            "{}",
            row["estimator"]
        );
        assert_eq!(row["logs"][0]["against"], "truth");
    }
    let best = recommended(&rows, "best");
    assert!(best["rms_pct"].as_f64().unwrap() <= 1.01 * errors[0]);
    let cheap = recommended(&rows, "cheap");
    let most = |row: &Value| row["cost"]["instructions_most"].as_f64().unwrap();
    assert!(most(cheap) <= 100.0 && most(cheap) < most(best));
    // A smaller budget names another one, and a large one the best alone.
    let budget = |n: &str| {
        json(&folder.good(&[&arguments[..], &["--instructions", n, "--json", "-"]].concat()))
    };
    assert!(most(recommended(&budget("20"), "cheap")) <= 20.0);
    assert!(
        budget("1e6")
            .iter()
            .all(|row| row["recommended"] != "cheap")
    );
}

/// A velocity that is not that of the counts would rank the estimators by its own error.
#[test]
fn truth_that_does_not_fit_the_counts_is_named() {
    let folder = Folder::new(HOST_SIM);
    // The velocity in rpm where rad/s are read, and as the difference of the counts.
    let rpm = |before: i64, after: i64| 60e3 / 4096.0 * (after - before) as f64 / 40.0;
    let counts: Vec<i64> = (swing_of(9000).lines().skip(1))
        .map(|line| line.split_once(',').unwrap().1.parse().unwrap())
        .collect();
    let log = |omega: &dyn Fn(usize) -> f64| -> String {
        let row = |k: usize| format!("{},{},{}\n", k as f64 * 1e-3, counts[k], omega(k));
        let rows: String = (20..counts.len() - 20).map(row).collect();
        format!("t,counts_large,true_omega\n{rows}")
    };
    folder.write("rpm.csv", log(&|k| rpm(counts[k - 20], counts[k + 20])));
    let step = |k: usize| (counts[k] - counts[k - 1]) as f64;
    folder.write("step.csv", log(&|k| 1e3 * TAU / 4096.0 * step(k)));
    let tune = ["tune", "--estimator", "low-pass", "--out", "tuned.toml"];
    for command in [&["recommend"][..], &["replay", "--out", "v.csv"], &tune] {
        let notes = |arguments: &[&str]| {
            let output = folder.run(&[command, arguments].concat());
            assert_eq!(output.status.code(), Some(0), "{command:?}");
            let notes = String::from_utf8(output.stderr).unwrap();
            notes.split_whitespace().collect::<Vec<_>>().join(" ")
        };
        let said = notes(&["rpm.csv"]);
        assert!(said.contains("as in rpm: give the unit"), "{said}");
        let said = notes(&["rpm.csv", "--column", "true_omega=true_omega:rpm"]);
        assert!(!said.contains("times the velocity"), "{said}");
        let said = notes(&["step.csv"]);
        assert!(
            said.contains("is the finite difference of counts_large"),
            "{said}"
        );
    }
}

/// One bad count in the scores would decide which estimator is the best.
#[test]
fn bad_count_is_named_with_its_time_and_left_out_of_the_scores() {
    let folder = Folder::new(HOST_SIM);
    // Tuning needs some seconds.
    folder.write("swing.csv", swing_of(9000));
    let bad = |line: &str| match line.split_once(',') {
        Some(("1.234", count)) => format!("1.234,{}\n", count.parse::<i64>().unwrap() - 1500),
        _ => format!("{line}\n"),
    };
    folder.write(
        "bad.csv",
        swing_of(9000).lines().map(bad).collect::<String>(),
    );
    let said = "counts_large is bad at t = 1.234 s: delete these rows; scores leave out these rows and 0.1 s after each";
    let tune = ["tune", "--estimator", "low-pass", "--out", "tuned.toml"];
    for command in [&["recommend"][..], &["replay", "--out", "v.csv"], &tune] {
        for (log, names_it) in [("bad.csv", true), ("swing.csv", false)] {
            let output = folder.run(&[command, &[log]].concat());
            assert_eq!(output.status.code(), Some(0), "{command:?}");
            let notes = String::from_utf8(output.stderr).unwrap();
            let notes = notes.split_whitespace().collect::<Vec<_>>().join(" ");
            assert_eq!(notes.contains(said), names_it, "{command:?}: {notes}");
        }
    }
    let ranked = |log: &str| -> BTreeMap<String, f64> {
        let rows = json(&folder.good(&["recommend", log, "--json", "-"]));
        let name = |row: &Value| row["estimator"].as_str().unwrap().to_owned();
        rows.iter()
            .map(|row| (name(row), row["rms_rad_s"].as_f64().unwrap()))
            .collect()
    };
    let [good, bad] = ["swing.csv", "bad.csv"].map(ranked);
    for (name, good) in good {
        let ratio = bad[&name] / good;
        assert!((0.95..1.05).contains(&ratio), "{name}: {ratio}");
    }
    // A truth is known where the count is bad: nothing is left out.
    let bad = folder.text("bad.csv").replace('\n', ",0\n");
    folder.write("truth.csv", bad.replacen(",0\n", ",true_omega\n", 1));
    let output = folder.run("recommend truth.csv");
    let notes = String::from_utf8(output.stderr).unwrap();
    let notes = notes.split_whitespace().collect::<Vec<_>>().join(" ");
    let said = "1.234 s: delete these rows; all scores contain what is no motion of a shaft";
    assert!(notes.contains(said), "{notes}");
}

#[test]
fn log_without_a_truth_is_ranked_against_a_reference() {
    let folder = Folder::new(HOST_SIM);
    folder.write("swing.csv", swing());
    let output = folder.run(&["recommend", "swing.csv", "--json", "-"]);
    assert_eq!(output.status.code(), Some(0));
    let notes = String::from_utf8(output.stderr).unwrap();
    let notes = notes.split_whitespace().collect::<Vec<_>>().join(" ");
    for said in [
        "4096 counts/rev assumed: give --counts-per-rev or --device",
        "swing.csv: no column true_omega; scores are against a reference",
    ] {
        assert!(notes.contains(said), "{said}: {notes}");
    }
    // The error of finite difference is far above that of the reference.
    let alike = notes.split("not ranked among each other: ").nth(1);
    let alike = alike.map_or("", |alike| alike.split("instructions:").next().unwrap());
    assert!(!alike.contains("finite-difference"), "{alike}");
    let rows = json(&String::from_utf8(output.stdout).unwrap());
    let best = recommended(&rows, "best");
    for key in [
        "estimator",
        "rms_pct",
        "rms_rad_s",
        "p99_rad_s",
        "delay_ms",
        "sd_rad_s",
        "cost",
        "reads",
        "parameters",
        "rust",
        "logs",
    ] {
        assert!(best.get(key).is_some(), "{key}");
    }
    let log = &best["logs"][0];
    assert_eq!(
        (&log["log"], &log["against"]),
        (&"swing.csv".into(), &"reference".into())
    );
    assert!(log["reference_sd_rad_s"].as_f64().unwrap() > 0.0);
    assert_eq!(best["reads"], Value::Array(Vec::new()));
    assert!(
        rows.iter().all(|row| row["estimator"] != "m-over-t"),
        "no time stamps"
    );
}

#[test]
fn device_file_admits_estimators_with_its_constants() {
    let folder = Folder::new(HOST_SIM);
    let mut text = String::from("t,counts_large,current\n");
    for (k, line) in swing().lines().skip(1).enumerate() {
        let _ = writeln!(text, "{line},{}", (10.0 * k as f64 * 1e-3).cos());
    }
    folder.write("r.csv", text);
    folder.write("mine.toml", "large.inertia_kg_m2 = 2e-5\n");
    let names = |more: &[&str]| -> Vec<String> {
        let arguments = [&["recommend", "r.csv", "--json", "-"][..], more].concat();
        let rows = json(&folder.good(&arguments));
        rows.iter()
            .map(|row| row["estimator"].as_str().unwrap().to_owned())
            .collect()
    };
    let notes = String::from_utf8(folder.run(&["recommend", "r.csv"]).stderr).unwrap();
    let said = "estimators with constants of the device left out: kalman-motor,";
    assert!(notes.contains(said), "{notes}");
    let of_motor = |names: &[String]| names.iter().any(|name| name == "kalman-motor");
    assert!(!of_motor(&names(&["--counts-per-rev", "4096"])));
    assert!(of_motor(&names(&["--device", "mine.toml"])));
    let rows = json(&folder.good(&["recommend", "r.csv", "--device", "mine.toml", "--json", "-"]));
    let motor = rows
        .iter()
        .find(|row| row["estimator"] == "kalman-motor")
        .unwrap();
    assert!(
        motor["rust"].as_str().unwrap().contains("inertia: 2e-5"),
        "{motor}"
    );
}

#[test]
fn several_logs_are_ranked_by_the_geometric_mean() {
    let folder = Folder::new(HOST_SIM);
    folder.write("swing.csv", swing());
    let log = format!("{DATA}/logs/own.csv");
    let text = folder.good(&["recommend", "swing.csv", &log]);
    assert!(
        text.contains("own.csv") && text.contains("swing.csv"),
        "{text}"
    );
    for row in json(&folder.good(&["recommend", "swing.csv", &log, "--json", "-"])) {
        let of = |i: usize| row["logs"][i]["rms_pct"].as_f64().unwrap();
        let mean = (of(0) * of(1)).sqrt();
        let pct = row["rms_pct"].as_f64().unwrap();
        assert!((pct / mean - 1.0).abs() < 1e-9, "{pct} {mean}");
        let of = |key: &str| [0, 1].map(|i| row["logs"][i][key].as_f64().unwrap());
        let [a, b] = of("rms_rad_s");
        let rms = row["rms_rad_s"].as_f64().unwrap();
        assert!((rms / ((a * a + b * b) / 2.0).sqrt() - 1.0).abs() < 1e-9);
        let [a, b] = of("p99_rad_s");
        assert_eq!(row["p99_rad_s"].as_f64().unwrap(), a.max(b));
    }
}

#[test]
fn unsuitable_logs_are_refused() {
    let folder = Folder::new(HOST_SIM);
    let line = folder.refused(&["recommend", "none.csv"]);
    assert!(line.contains("none.csv: cannot read"), "{line}");
    folder.write("no-counts.csv", "t,speed\n0,0\n1e-3,1\n");
    let line = folder.refused(&["recommend", "no-counts.csv"]);
    assert!(
        line.contains("no-counts.csv: line 1: no column counts_large"),
        "{line}"
    );
    let short: String = swing().lines().take(100).collect::<Vec<_>>().join("\n");
    folder.write("short.csv", format!("{short}\n"));
    let line = folder.refused(&["recommend", "short.csv", "--report", "page"]);
    assert!(
        line.contains("short.csv: 99 rows; scores need at least 201"),
        "{line}"
    );
    let still: String = (0..500)
        .map(|k| format!("{}.{:03},7\n", k / 1000, k % 1000))
        .collect();
    folder.write("still.csv", format!("t,counts_large\n{still}"));
    let line = folder.refused(&["recommend", "still.csv"]);
    assert!(
        line.contains("still.csv: counts_large changes at 0 rows"),
        "{line}"
    );
    folder.write("swing.csv", swing());
    let line = folder.refused(&["recommend", "swing.csv", "--instructions", "0"]);
    assert!(
        line.contains("--instructions 0: must be a number above 0"),
        "{line}"
    );
    let fast = swing()
        .replace("\n0.", "\n0.0")
        .replace("\n1.", "\n0.1")
        .replace("\n2.", "\n0.2");
    folder.write("fast.csv", fast);
    let few: Vec<_> = folder
        .text("fast.csv")
        .lines()
        .take(2001)
        .map(str::to_owned)
        .collect();
    folder.write("few.csv", few.join("\n") + "\n");
    let line = folder.refused(&["recommend", "few.csv"]);
    let said = "few.csv: 2000 rows; scores need at least 2001, 0.2 s at 10000 rows a second; check the unit of t";
    assert!(line.contains(said), "{line}");
    for [first, second] in [["swing.csv", "fast.csv"], ["fast.csv", "swing.csv"]] {
        let line = folder.refused(&["recommend", first, second]);
        let said = format!("{second}: its rate is ");
        assert!(line.contains(&said) && line.contains(first), "{line}");
    }
    folder.write(
        "stated.csv",
        format!("# counts_per_rev = 16384\n{}", swing()),
    );
    for logs in [["swing.csv", "stated.csv"], ["stated.csv", "swing.csv"]] {
        let line = folder.refused(&["recommend", logs[0], logs[1]]);
        let said =
            "stated.csv: states 16384 counts/rev and swing.csv none; give the counts of both";
        assert!(line.contains(said), "{line}");
        folder.good(&["recommend", logs[0], logs[1], "--counts-per-rev", "4096"]);
    }
    let line = folder.refused(&["recommend", "-", "-"]);
    assert!(line.contains("standard input can be read once"), "{line}");
}

#[test]
fn page_has_every_section_and_escapes_the_name_of_the_log() {
    let folder = Folder::new(HOST_SIM);
    let name = "a<b>&c.csv";
    folder.write(name, swing());
    let arguments = ["recommend", name, "--report", "page", "--json", "-"];
    let rows = json(&folder.good(&arguments));
    let page = folder.text("page/index.html");
    assert!(!page.contains("a<b>"));
    let escaped = "a&lt;b&gt;&amp;c.csv";
    let blocks: Vec<_> = page.split("<pre class=\"scroll\">").collect();
    let [head, lines, table] = blocks[..] else {
        panic!("{} parts", blocks.len());
    };
    for said in [
        format!("host-sim recommend '{escaped}' --report page"),
        "4096 counts/rev assumed".to_owned(),
        format!("{escaped}: no column true_omega; scores are against a reference"),
        "instructions: of one update on the emulated board".to_owned(),
    ] {
        assert!(head.contains(&said), "{said}: {head}");
    }
    assert!(lines.contains("Most accurate") && lines.contains("ESTIMATOR.update(&amp;mut self.0"));
    // The ranking and one velocity.
    assert_eq!(page.matches("<figure>").count(), 2);
    let velocity = format!("{escaped}: the second with the largest errors");
    assert!(lines.contains(&velocity), "{lines}");
    let figure = folder.text("page/figures/02.svg");
    assert!(figure.contains("reference") && !figure.contains("truth"));
    for row in rows {
        let estimator = row["estimator"].as_str().unwrap();
        assert!(table.contains(&format!("\n  {estimator} ")), "{estimator}");
    }
}

#[test]
fn bytes_do_not_depend_on_the_number_of_threads() {
    let folder = Folder::new(HOST_SIM);
    folder.write("swing.csv", swing());
    let log = format!("{DATA}/back-and-forth.csv");
    let run = |threads: &str| {
        let output = folder
            .command(&["recommend", "swing.csv", &log, "--json", "-"])
            .env("RAYON_NUM_THREADS", threads)
            .output()
            .unwrap();
        assert_eq!(output.status.code(), Some(0));
        output.stdout
    };
    assert_eq!(run("1"), run("2"));
}
