//! What the program writes where.

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
