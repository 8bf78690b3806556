//! What the program writes where, how its runs end, and what it sends to a board that it serves.

use std::fs;
use std::io::{BufRead as _, BufReader, Read as _, Write as _};
use std::net::TcpStream;
use std::path::PathBuf;
use std::process::{Child, Command, Stdio};
use std::time::Duration;

use drivers::encode;
use drivers::link::{Frame, Message, Parser};
use haptic_control::{Mode, Request, SceneKind, Stop};
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

/// Longest time without a byte of a board that is served.
const LONGEST: Duration = Duration::from_secs(60);

/// Exit status and standard error of a run with these arguments.
fn ended(arguments: &[&str]) -> (Option<i32>, String) {
    Image::build("").unwrap();
    let mut board = Command::new(env!("CARGO_BIN_EXE_virtual-board"));
    let board = board.arg("--image").arg(Image::built()).args(arguments);
    let output = board.output().unwrap();
    let report = String::from_utf8(output.stderr).unwrap();
    (output.status.code(), report)
}

#[test]
fn command_that_the_image_refuses_fails_the_run() {
    let (status, report) = ended(&["--blank", "--scene", "wall", "--seconds", "0.4"]);
    assert_eq!(status, Some(1), "{report}");
    let said = "the image refused a command: the signs of encoders and currents have not been verified; run \
                cargo drive bring-up, or leave --blank out";
    assert!(report.contains(said), "{report}");
}

/// Random bytes may be commands that the image refuses.
#[test]
fn flood_of_random_bytes_is_no_refused_command() {
    let arguments = ["--blank", "--scene", "wall", "--seconds", "0.4"];
    let (status, report) = ended(&[&arguments[..], &["--fault", "command-flood@0.2"]].concat());
    assert_eq!(status, Some(0), "{report}");
}

#[test]
fn run_without_a_control_task_fails() {
    let (status, report) = ended(&["--seconds", "0.0001"]);
    assert_eq!(status, Some(1), "{report}");
    assert!(report.contains("the control task never ran"), "{report}");
}

/// The frames that a client reads, up to one of these.
fn frames_until(client: &mut TcpStream, is_last: impl Fn(&Frame) -> bool) -> Vec<Frame> {
    let (mut parser, mut frames) = (Parser::default(), Vec::new());
    let mut byte = [0];
    while !frames.last().is_some_and(&is_last) {
        client.read_exact(&mut byte).expect("the run ended");
        parser.take(byte[0], |message| {
            if let Message::Frame(frame) = message {
                frames.push(frame);
            }
        });
    }
    frames
}

/// A program that ends with its test.
struct Running(Child);

impl Drop for Running {
    fn drop(&mut self) {
        // It may have ended.
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

/// The program that serves the board neither arms it nor keeps it alive.
#[test]
fn served_board_gets_the_commands_of_its_client_alone() {
    Image::build("").unwrap();
    let mut board = Command::new(env!("CARGO_BIN_EXE_virtual-board"));
    let board = board.arg("--image").arg(Image::built());
    let board = board.args(["--link", "0", "--seconds", "60", "--hand", "none"]);
    let mut board = Running(board.stdout(Stdio::piped()).spawn().unwrap());
    let mut line = String::new();
    let mut out = BufReader::new(board.0.stdout.take().unwrap());
    out.read_line(&mut line).unwrap();
    let address = line.trim_end().rsplit_once(" tcp:").unwrap().1;
    let mut client = TcpStream::connect(address).unwrap();
    client.set_read_timeout(Some(LONGEST)).unwrap();
    // A run without clients is armed at 0.1 s.
    let idle = frames_until(&mut client, |frame| frame.tick >= 2000);
    assert!(idle.iter().all(|frame| frame.state == Mode::Boot as u8));
    for (request, mode) in [
        (Request::Arm, Mode::Armed),
        (Request::Select(SceneKind::Excite.number()), Mode::Running),
    ] {
        let bytes = encode(drivers::Command::Request(request));
        client.write_all(&bytes).unwrap();
        frames_until(&mut client, |frame| frame.state == mode as u8);
    }
    // The scene ends without keep-alives long before its own end.
    let is_over = |frame: &Frame| frame.state != Mode::Running as u8;
    let last = *frames_until(&mut client, is_over).last().unwrap();
    let expected = (Mode::Armed as u8, Stop::CommandTimeout as u8);
    assert_eq!((last.state, last.cause), expected);
}
