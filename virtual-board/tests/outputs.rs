//! What the program writes where.

use std::fs;
use std::path::PathBuf;
use std::process::Command;

use virtual_board::image::Image;

#[test]
fn recording_is_alone_on_standard_output() {
    Image::build("").unwrap();
    let mut board = Command::new(env!("CARGO_BIN_EXE_virtual-board"));
    let board = board.arg("--image").arg(Image::built());
    let board = board.args(["--seconds", "0.15", "--record", "-"]);
    let output = board.output().unwrap();
    let [out, report] = [output.stdout, output.stderr].map(|text| String::from_utf8(text).unwrap());
    assert_eq!(output.status.code(), Some(0), "{report}");
    assert!(out.starts_with("t,"), "{out}");
    let cells = |line: &str| line.split(',').count();
    let heading = out.lines().next().unwrap_or_default();
    assert!(out.lines().count() > 100, "{out}");
    for line in out.lines() {
        assert_eq!(cells(line), cells(heading), "{line}");
    }
    assert!(report.starts_with("run "), "{report}");
}

/// The run before the reset of the watchdog is the longer one.
#[test]
fn runs_that_are_not_in_the_recording_are_told_by_the_exit_status() {
    Image::build("").unwrap();
    let out = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join("reset.csv");
    let _ = fs::remove_file(&out);
    let mut board = Command::new(env!("CARGO_BIN_EXE_virtual-board"));
    let board = board.arg("--image").arg(Image::built());
    let board = board.args(["--seconds", "0.5", "--fault", "hung-core@0.3"]);
    let output = board.arg("--record").arg(&out).output().unwrap();
    let report = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(1), "{report}");
    for said in [
        "the firmware started 2 times; left out: runs of [",
        "the firmware started 2 times, and only the longest run is in the file",
    ] {
        assert!(report.contains(said), "{report}");
    }
    assert!(fs::read_to_string(&out).unwrap().lines().count() > 200);
}

#[test]
fn command_that_the_image_refuses_fails_the_run() {
    Image::build("").unwrap();
    let mut board = Command::new(env!("CARGO_BIN_EXE_virtual-board"));
    let board = board.arg("--image").arg(Image::built());
    let board = board.args(["--blank", "--scene", "wall", "--seconds", "0.4"]);
    let output = board.output().unwrap();
    let report = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(1), "{report}");
    let said = "the image refused a command: the signs of encoders and currents have not been verified; run \
                cargo drive bring-up, or leave --blank out";
    assert!(report.contains(said), "{report}");
}
