//! The file of a recording.

use std::fs;
use std::path::PathBuf;

use haptic_control::{Mode, Stop};

use crate::scripted::{Board, Script};

const COLUMNS: &str = "t,counts_large,counts_small,current,current_small,torque,velocity_large,\
                       velocity_small,state,cause,sigma_large";

/// An empty folder of this test.
fn folder(name: &str) -> PathBuf {
    let path = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join(name);
    let _ = fs::remove_dir_all(&path);
    fs::create_dir_all(&path).unwrap();
    path
}

/// The rows of half a second: one for each frame, from the first one on.
fn check(text: &str, state: u8) {
    let mut lines = text.lines();
    assert_eq!(lines.next(), Some(COLUMNS));
    let rows: Vec<_> = lines.collect();
    assert_eq!(rows.len(), 501);
    let first: u32 = rows[0].split(',').nth(1).unwrap().parse().unwrap();
    assert_eq!(first % 3, 0);
    for (k, row) in (0..).zip(rows) {
        let seq = first / 3 + k;
        let t = f64::from(k * 10) / 1e4;
        let small = 0_u32.wrapping_sub(seq);
        let large = 3 * seq;
        let expected = format!("{t},{large},{small},0.5,-0.25,0.01,1.5,-2.5,{state},0,0.125");
        assert_eq!(row, expected);
    }
}

#[test]
fn recording_has_every_frame_although_the_stream_is_noisy() {
    let out = folder("record").join("run.csv");
    let board = Board::new(Script {
        noise: vec![0x5A, 0x5A, 2, 59, 1, 2, 3],
        ..Script::default()
    });
    let path = out.to_str().unwrap();
    let (output, _) = board.run(&["record", "--out", path, "--seconds", "0.5"]);
    assert_eq!(output.status.code(), Some(0), "{output:?}");
    check(&fs::read_to_string(&out).unwrap(), 0);
    let said = String::from_utf8(output.stderr).unwrap();
    assert!(
        said.contains("501 frames recorded, 0 missing at 0 places"),
        "{said}"
    );
}

#[test]
fn session_is_recorded_beside_its_lines() {
    let out = folder("session").join("run.csv");
    let path = out.to_str().unwrap();
    let running = Script {
        begin: Mode::Running,
        ..Script::default()
    };
    let arguments = ["keep-alive", "--record", path, "--seconds", "0.5"];
    let (output, _) = Board::new(running).run(&arguments);
    assert_eq!(output.status.code(), Some(0), "{output:?}");
    check(&fs::read_to_string(&out).unwrap(), 2);
}

#[test]
fn what_came_before_an_error_is_recorded() {
    let folder = folder("lost");
    let out = folder.join("run.csv");
    let path = out.to_str().unwrap();
    let lost = Script {
        hang_up: Some(500),
        ..Script::default()
    };
    let (output, _) = Board::new(lost).run(&["record", "--out", path]);
    assert_eq!(output.status.code(), Some(2));
    let said = String::from_utf8_lossy(&output.stderr);
    assert!(said.contains("connection lost"), "{said}");
    let rows = fs::read_to_string(&out).unwrap().lines().count();
    assert!((100..=502).contains(&rows), "{rows}");
    let stops = Script {
        stop: Some((100, Mode::Safe, Stop::Jump)),
        ..Script::default()
    };
    let (output, _) = Board::new(stops).run(&["select", "wall", "--record", path]);
    assert_eq!(output.status.code(), Some(1));
    let text = fs::read_to_string(&out).unwrap();
    let last: Vec<_> = text.lines().last().unwrap().split(',').collect();
    let [state, cause] = [8, 9].map(|column| last[column].parse::<u8>().unwrap());
    assert_eq!((state, cause), (Mode::Safe as u8, Stop::Jump as u8));
    assert_eq!(fs::read_dir(&folder).unwrap().count(), 1);
}
