//! Commands that read logs.

use std::fs;

use super::LOGS;
use crate::{Folder, HOST_SIM};

#[test]
fn every_command_on_recordings_takes_the_columns() {
    let folder = Folder::new(HOST_SIM);
    let log = format!("{LOGS}/semicolons-decimal-commas.csv");
    let columns = ["--column", "t=time_ms,counts_large=angle_deg"];
    let plot = [&["plot", &log, "--out", "p.svg"][..], &columns].concat();
    folder.good(&plot);
    assert!(folder.names().contains("p.svg"));
    // Read, and refused because this log has no current.
    let line = folder.refused(&[&["identify", &log][..], &columns].concat());
    assert!(line.contains("no column current;"), "{line}");
    let unnamed = format!("{LOGS}/unknown-names.csv");
    let line = folder.refused(&["identify", &unnamed]);
    assert!(line.contains("no column t; found: stamp"), "{line}");
    // A pipe can be read once.
    let script = format!(
        "cat '{LOGS}/own.csv' | '{HOST_SIM}' replay /dev/stdin --estimator pll --out v.csv",
    );
    let shell = std::process::Command::new("sh")
        .args(["-c", &script])
        .current_dir(folder.path())
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
        ["v.csv", "w.csv"].map(|file| fs::read(folder.path().join(file)).unwrap());
    assert_eq!(from_pipe, from_file);
}
