//! Logs as users have them: every file of tests/data/logs reads to the motion that it was written from,
//! or is refused with one line.

mod commands;
mod interrupted;
mod motion;
mod notes;
mod packed;
mod refused;
mod units;

use std::collections::BTreeSet;
use std::f64::consts::{PI, TAU};
use std::fs;

use crate::{Folder, HOST_SIM};

const LOGS: &str = "../data/logs";

/// Number of rows of the motion, 1 ms apart.
const ROWS: usize = 240;

const COUNTS_PER_REV: f64 = 4096.0;

/// The motion of all logs: counts at `t` seconds after the first row, as README.md there states.
fn counts(t: f64) -> f64 {
    let revolutions = 0.8 + 0.6 * t + 0.4 * (2.0 * PI * 1.5 * t).sin();
    (COUNTS_PER_REV * revolutions).floor()
}

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
fn every_log_is_read_or_refused_by_a_test() {
    let files = fs::read_dir(Folder::new(HOST_SIM).path().join(LOGS))
        .unwrap()
        .map(|file| file.unwrap().file_name());
    let files: BTreeSet<_> = files.map(|name| name.into_string().unwrap()).collect();
    let named = motion::READ.iter().map(|(log, _)| *log);
    let named = named.chain(refused::REFUSED.iter().map(|(log, ..)| *log));
    let named = named.chain(["README.md", "missing-rows.csv", "stale-readings.csv"]);
    let named = named.chain(crate::uneven::LOGS.iter().copied());
    let named: BTreeSet<_> = named.map(str::to_owned).collect();
    assert_eq!(files, named);
}
