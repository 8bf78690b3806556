//! The file of a recording.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command as Process;

use drivers::Command;
use haptic_control::{Mode, Stop};
use recordings::recording::Recording;

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

/// The lines of text go to standard error.
#[test]
fn recording_is_alone_on_standard_output() {
    let running = Script {
        begin: Mode::Running,
        ..Script::default()
    };
    let arguments = ["keep-alive", "--record", "-", "--seconds", "0.5"];
    let (output, _) = Board::new(running).run(&arguments);
    assert_eq!(output.status.code(), Some(0), "{output:?}");
    check(&String::from_utf8(output.stdout).unwrap(), 2);
    let said = String::from_utf8(output.stderr).unwrap();
    assert!(said.contains("state running, cause none"), "{said}");
    let report = "standard output: 501 frames recorded, 0 missing at 0 places";
    assert!(said.contains(report), "{said}");
}

#[test]
fn what_came_before_an_error_is_recorded() {
    let folder = folder("lost");
    let out = folder.join("run.csv");
    let path = out.to_str().unwrap();
    let lost = Script {
        hang_up: Some((Command::Identify, 500)),
        ..Script::default()
    };
    let (output, _) = Board::new(lost).run(&["record", "--out", path, "--seconds", "10"]);
    assert_eq!(output.status.code(), Some(2));
    let said = String::from_utf8_lossy(&output.stderr);
    assert!(said.contains("connection lost"), "{said}");
    assert_eq!(Recording::read(&out).unwrap().t.len(), 500);
    let stops = Script {
        stop: Some((100, Mode::Safe, Stop::Jump)),
        ..Script::default()
    };
    let (output, _) =
        Board::new(stops).run(&["select", "wall", "--record", path, "--seconds", "10"]);
    assert_eq!(output.status.code(), Some(1));
    let states = states(&out);
    let running = states.iter().filter(|it| it[0] == Mode::Running as u8);
    assert_eq!(running.count(), 100);
    let last = [Mode::Safe as u8, Stop::Jump as u8];
    assert_eq!(states.last(), Some(&last));
    assert_eq!(fs::read_dir(&folder).unwrap().count(), 1);
}

/// State and cause of each row.
fn states(path: &Path) -> Vec<[u8; 2]> {
    let text = fs::read_to_string(path).unwrap();
    let row = |row: &str| {
        let fields: Vec<_> = row.split(',').collect();
        [8, 9].map(|column| fields[column].parse().unwrap())
    };
    text.lines().skip(1).map(row).collect()
}

/// The time of a session begins with its scene, not with the select command.
#[test]
fn session_lasts_from_the_begin_of_its_scene() {
    let out = folder("late").join("run.csv");
    let path = out.to_str().unwrap();
    let late = Script {
        starts_after: Some(700),
        ..Script::default()
    };
    let arguments = ["select", "wall", "--seconds", "0.5", "--record", path];
    let (output, _) = Board::new(late).run(&arguments);
    assert_eq!(output.status.code(), Some(0), "{output:?}");
    let states = states(&out);
    let first = states.iter().position(|it| it[0] == Mode::Running as u8);
    let (before, scene) = states.split_at(first.expect("the scene"));
    assert!(before.len() >= 700, "{}", before.len());
    assert_eq!(scene, [[Mode::Running as u8, 0]; 501]);
}

/// Frames 100 to 129 from the first question on are lost.
#[test]
fn recording_reads_back_and_lost_frames_are_told() {
    let out = folder("gap").join("run.csv");
    let path = out.to_str().unwrap();
    let gap = Script {
        lost: Some((100, 129)),
        ..Script::default()
    };
    let (output, _) = Board::new(gap).run(&["record", "--out", path, "--seconds", "0.4"]);
    assert_eq!(output.status.code(), Some(0), "{output:?}");
    let said = String::from_utf8(output.stderr).unwrap();
    let expected = "371 frames recorded, 30 missing at 1 place\n";
    assert!(said.contains(expected), "{said}");
    let read = Recording::read(&out).unwrap();
    let numbers: Vec<u32> = (0..100).chain(130..=400).collect();
    let times: Vec<_> = numbers.iter().map(|k| f64::from(k * 10) / 1e4).collect();
    assert_eq!(read.t, times);
    assert_eq!(read.uneven_steps, 1);
    let large = &read.trace.counts_large;
    let small = read.trace.counts_small.as_ref().unwrap();
    for (k, number) in numbers.iter().enumerate() {
        assert_eq!(large[k].wrapping_sub(large[0]), 3 * number);
        assert_eq!(small[0].wrapping_sub(small[k]), *number);
    }
    assert_eq!(read.trace.current, Some(vec![0.5; 371]));
}

/// The longest run is written.
#[test]
fn runs_that_are_not_in_the_file_are_told_by_the_exit_status() {
    let out = folder("reset").join("run.csv");
    let path = out.to_str().unwrap();
    let starts = Script {
        starts_again: Some((Command::Identify, 99)),
        ..Script::default()
    };
    let (output, _) = Board::new(starts).run(&["record", "--out", path, "--seconds", "0.4"]);
    assert_eq!(output.status.code(), Some(1), "{output:?}");
    let said = String::from_utf8(output.stderr).unwrap();
    let expected = "the firmware started 2 times, and only the longest run is in the file";
    assert!(said.contains(expected), "{said}");
    assert!(Recording::read(&out).unwrap().t.len() > 250);
}

/// A pipe stays a pipe, and its reader gets the recording.
#[cfg(unix)]
#[test]
fn recording_replaces_no_file_that_is_not_regular() {
    use std::os::unix::fs::FileTypeExt as _;

    let pipe = folder("pipe").join("run.csv");
    let made = Process::new("mkfifo").arg(&pipe).status().unwrap();
    assert!(made.success());
    let reader = {
        let pipe = pipe.clone();
        std::thread::spawn(move || fs::read_to_string(pipe).unwrap())
    };
    let arguments = [
        "record",
        "--out",
        pipe.to_str().unwrap(),
        "--seconds",
        "0.5",
    ];
    let (output, _) = Board::new(Script::default()).run(&arguments);
    let kind = fs::symlink_metadata(&pipe).unwrap().file_type();
    assert!(kind.is_fifo(), "{kind:?}");
    assert_eq!(output.status.code(), Some(0), "{output:?}");
    check(&reader.join().unwrap(), 0);
}
