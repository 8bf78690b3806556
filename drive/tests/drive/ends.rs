//! The end of a session: the board is disarmed, whatever the reason.

use std::fs::OpenOptions;
use std::io::Read as _;
use std::process::{Child, Command as Process, Stdio};
use std::time::Duration;

use drivers::{Command, Setting, Settings};
use haptic_control::{Mode, Request, SceneKind, Stop};

use crate::commands::{ARM, DISARM, WALL, deduplicated, sorted};
use crate::scripted::{Board, Script, error};

/// Patience where it comes to its end.
const BRIEFLY: [&str; 2] = ["--timeout", "4"];
/// A session that ends later than by the reason that a test gives it.
const SELECT: [&str; 4] = ["select", "wall", "--seconds", "10"];

/// Sends a signal to the tool.
#[cfg(unix)]
fn send(tool: &Child, signal: &str) {
    let id = tool.id().to_string();
    let sent = Process::new("kill").args([signal, &id]).status().unwrap();
    assert!(sent.success());
}

#[cfg(unix)]
#[test]
fn interrupt_and_termination_disarm() {
    for signal in ["-INT", "-TERM", "-HUP"] {
        let board = Board::new(Script::default());
        let tool = board
            .tool(&["select", "wall", "--seconds", "500"])
            .stdout(Stdio::null())
            .stderr(Stdio::piped())
            .spawn()
            .unwrap();
        board.wait_for(WALL);
        send(&tool, signal);
        let output = tool.wait_with_output().unwrap();
        assert_eq!(output.status.code(), Some(0), "{signal}: {output:?}");
        let (others, _) = sorted(&board.commands());
        assert_eq!(deduplicated(others), [DISARM], "{signal}");
    }
}

/// The wait for it may be long.
#[cfg(unix)]
#[test]
fn interrupt_ends_the_wait_for_a_board_that_does_not_arm() {
    let board = Board::new(Script {
        armed: Mode::Safe,
        ..Script::default()
    });
    let tool = board.tool(&SELECT).stderr(Stdio::piped()).spawn().unwrap();
    board.wait_for(ARM);
    send(&tool, "-INT");
    let output = tool.wait_with_output().unwrap();
    assert_eq!(output.status.code(), Some(0), "{output:?}");
    // No scene is selected.
    assert_eq!(deduplicated(sorted(&board.commands()).0), [DISARM]);
}

/// As with `| head -1`.
#[test]
fn end_of_the_reader_of_the_lines_ends_the_session() {
    for (arguments, expected) in [
        (&["watch", "--seconds", "10"][..], &[][..]),
        (&SELECT, &[ARM, WALL, DISARM]),
    ] {
        let board = Board::new(Script::default());
        let mut tool = board.tool(arguments);
        let tool = tool.stdout(Stdio::piped()).stderr(Stdio::piped());
        let mut tool = tool.spawn().unwrap();
        let mut first = [0];
        tool.stdout.take().unwrap().read_exact(&mut first).unwrap();
        let output = tool.wait_with_output().unwrap();
        assert_eq!(output.status.code(), Some(0), "{output:?}");
        let said = String::from_utf8(output.stderr).unwrap();
        assert!(said.contains("nobody reads the lines any more"), "{said}");
        assert_eq!(deduplicated(sorted(&board.commands()).0), expected);
    }
}

/// A motor moves for lines that somebody has to read.
#[test]
fn bring_up_ends_before_it_arms_if_nobody_reads_its_lines() {
    let board = Board::new(Script::default());
    let mut tool = board.tool(&["bring-up"]);
    let (reader, writer) = std::io::pipe().unwrap();
    drop(reader);
    let tool = tool.stdout(writer).stderr(Stdio::piped());
    let output = tool.spawn().unwrap().wait_with_output().unwrap();
    assert_eq!(output.status.code(), Some(2), "{output:?}");
    let said = String::from_utf8(output.stderr).unwrap();
    assert!(said.contains("nobody reads the lines any more"), "{said}");
    let commands = board.commands();
    assert!(!commands.contains(&ARM), "{commands:?}");
}

#[test]
fn stop_of_the_board_ends_the_session_with_its_cause_and_disarms() {
    for (mode, stop, said) in [
        (Mode::Safe, Stop::Stall, "state safe, cause not-moving"),
        (
            Mode::Armed,
            Stop::CommandTimeout,
            "state armed, cause command-timeout",
        ),
        (Mode::Boot, Stop::None, "state boot, cause none"),
        (Mode::Settling, Stop::None, "state settling, cause none"),
    ] {
        let board = Board::new(Script {
            stop: Some((100, mode, stop)),
            ..Script::default()
        });
        let (output, commands) = board.run(&SELECT);
        assert_eq!(output.status.code(), Some(1));
        let error = error(&output);
        assert!(error.contains("the board stopped: ") && error.contains(said));
        assert_eq!(commands.last(), Some(&DISARM), "{commands:?}");
    }
}

#[test]
fn board_that_does_not_arm_is_told_and_disarmed() {
    let board = Board::new(Script {
        armed: Mode::Safe,
        ..Script::default()
    });
    let (output, commands) = board.run(&[&SELECT[..], &BRIEFLY].concat());
    assert_eq!(output.status.code(), Some(1));
    assert!(error(&output).contains("not armed: state safe"));
    assert_eq!(deduplicated(sorted(&commands).0), [ARM, DISARM]);
}

/// A frame of a stopped board may be from before the command, which clears the cause.
#[test]
fn stopped_board_is_disarmed_once_a_frame_has_no_cause() {
    for (disarms_after, said) in [(Some(100), "boot"), (None, "safe")] {
        let board = Board::new(Script {
            begin: Mode::Safe,
            disarms_after,
            ..Script::default()
        });
        let (output, commands) = board.run(&[&["disarm"][..], &BRIEFLY].concat());
        assert_eq!(output.status.code(), Some(0), "{output:?}");
        let told = String::from_utf8_lossy(&output.stderr);
        assert_eq!(told, format!("disarmed: state {said}, cause none\n"));
        assert_eq!(deduplicated(commands), [DISARM]);
    }
}

#[test]
fn board_that_stays_enabled_after_disarm_is_told() {
    let board = Board::new(Script {
        disarms_after: None,
        ..Script::default()
    });
    let (output, _) = board.run(&[&["arm", "--seconds", "0.2"][..], &BRIEFLY].concat());
    assert_eq!(output.status.code(), Some(1));
    assert!(error(&output).contains("stay enabled after disarm; switch off their supply"));
}

/// The board hears what comes after its own end.
#[test]
fn connection_that_closes_gets_a_disarm() {
    for (arguments, from, expected) in [
        (
            &["watch", "--seconds", "10"][..],
            Command::Identify,
            &[][..],
        ),
        (&SELECT, WALL, &[ARM, WALL, DISARM]),
        (&["disarm"], DISARM, &[DISARM]),
    ] {
        let board = Board::new(Script {
            hang_up: Some((from, 500)),
            // A board that is not disarmed before it closes.
            begin: if from == DISARM {
                Mode::Running
            } else {
                Mode::Boot
            },
            disarms_after: None,
            ..Script::default()
        });
        let (output, commands) = board.run(arguments);
        assert_eq!(output.status.code(), Some(2), "{output:?}");
        let said = error(&output);
        assert!(said.contains("connection lost"), "{said}");
        assert!(said.contains("run the command again"), "{said}");
        let end = "; the board ends the scene by itself when no command comes";
        assert_eq!(said.ends_with(end), !expected.is_empty(), "{said}");
        assert_eq!(deduplicated(sorted(&commands).0), expected);
    }
}

/// Standard output has no room.
#[cfg(target_os = "linux")]
#[test]
fn error_of_the_tool_itself_disarms() {
    for (begin, arguments, expected) in [
        (Mode::Boot, &SELECT[..], &[ARM, WALL, DISARM][..]),
        (Mode::Running, &["keep-alive", "--seconds", "10"], &[DISARM]),
    ] {
        let full = OpenOptions::new().write(true).open("/dev/full").unwrap();
        let board = Board::new(Script {
            begin,
            ..Script::default()
        });
        let output = board.tool(arguments).stdout(full).output().unwrap();
        assert_eq!(output.status.code(), Some(2), "{output:?}");
        assert!(error(&output).contains("standard output"));
        assert_eq!(deduplicated(sorted(&board.commands()).0), expected);
    }
}

#[test]
fn silence_ends_a_session_with_disarm_after_the_timeout_alone() {
    let pausing = |pause| {
        Board::new(Script {
            pause: Some((100, pause)),
            ..Script::default()
        })
    };
    let forever = Duration::from_secs(3600);
    let (output, commands) = pausing(forever).run(&[&SELECT[..], &BRIEFLY].concat());
    assert_eq!(output.status.code(), Some(2), "{output:?}");
    assert!(error(&output).contains("the board sends nothing"));
    assert_eq!(commands.last(), Some(&DISARM), "{commands:?}");
    // Longer than the default.
    let pause = Duration::from_millis(2100);
    let arguments = ["select", "wall", "--seconds", "0.5", "--timeout", "60"];
    let (output, _) = pausing(pause).run(&arguments);
    assert_eq!(output.status.code(), Some(0), "{output:?}");
}

#[test]
fn scene_that_does_not_start_is_told_and_disarmed() {
    let board = Board::new(Script {
        starts_after: None,
        ..Script::default()
    });
    let (output, commands) =
        board.run(&[&SELECT[..], &["--tune", "stiffness=0.2"], &BRIEFLY].concat());
    assert_eq!(output.status.code(), Some(1), "{output:?}");
    assert!(error(&output).contains("the scene does not start: state armed, cause none"));
    assert_eq!(deduplicated(sorted(&commands).0), [ARM, WALL, DISARM]);
}

/// The board stays armed.
#[test]
fn scene_off_has_no_start_to_wait_for() {
    let board = Board::new(Script {
        starts_after: None,
        ..Script::default()
    });
    let (output, commands) = board.run(&["select", "off", "--seconds", "0.2"]);
    assert_eq!(output.status.code(), Some(0), "{output:?}");
    let off = Command::Request(Request::Select(SceneKind::Off.number()));
    assert_eq!(deduplicated(sorted(&commands).0), [ARM, off, DISARM]);
}

/// The tool would take the frames of the scene that runs for those of its own.
#[test]
fn scene_of_another_program_ends_before_the_next_one_begins() {
    let board = |starts_after| {
        Board::new(Script {
            begin: Mode::Running,
            starts_after,
            ..Script::default()
        })
    };
    let select = ["select", "wall", "--seconds", "0.2"];
    let (output, commands) = board(Some(0)).run(&select);
    assert_eq!(output.status.code(), Some(0), "{output:?}");
    let expected = [DISARM, ARM, WALL, DISARM];
    assert_eq!(deduplicated(sorted(&commands).0), expected);
    // The command is lost.
    let (output, commands) = board(None).run(&[&select[..], &BRIEFLY].concat());
    assert_eq!(output.status.code(), Some(1), "{output:?}");
    assert!(error(&output).contains("the scene does not start: state armed, cause none"));
    assert_eq!(deduplicated(sorted(&commands).0), expected);
}

#[test]
fn what_cannot_be_done_is_refused_before_the_board_is_armed() {
    for (arguments, said) in [
        (
            &[
                "select",
                "wall",
                "--record",
                env!("CARGO_TARGET_TMPDIR"),
                "--seconds",
                "1",
            ][..],
            "is a folder; choose the name of a file",
        ),
        (
            &[
                "arm",
                "--record",
                concat!(env!("CARGO_BIN_EXE_drive"), "/run.csv"),
                "--seconds",
                "1",
            ],
            "is no folder; choose another path",
        ),
        (
            &[
                "select",
                "wall",
                "--tune",
                "stiffness=0.2@2",
                "--seconds",
                "2",
            ],
            "the change at 2 s comes after the end at 2 s; give a longer --seconds",
        ),
    ] {
        let (output, commands) = Board::new(Script::default()).run(arguments);
        assert_eq!(output.status.code(), Some(2), "{output:?}");
        let error = error(&output);
        assert!(error.contains(said), "{error}");
        assert!(commands.iter().all(|it| *it == Command::Identify));
    }
}

/// A bring-up of a board with verified signs, which has taken them back and has armed the board.
#[cfg(unix)]
fn armed_bring_up() -> (Board, Child) {
    let board = Board::new(Script {
        measures: Some([(0.0, 1.0); 2]),
        settings: Settings::COMMISSIONED,
        ..Script::default()
    });
    let tool = board
        .tool(&["bring-up"])
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    board.wait_for(Command::Set {
        setting: Setting::SignsVerified.number(),
        value: 0.0,
    });
    board.wait_for(ARM);
    (board, tool)
}

/// No command among these changes a setting.
#[cfg(unix)]
fn assert_sets_nothing(commands: &[Command]) {
    let is_set = |command: &Command| matches!(command, Command::Set { .. });
    assert!(!commands.iter().any(is_set), "{commands:?}");
}

/// A tool that is killed leaves no earlier verification: it is taken back before a motor moves.
#[cfg(unix)]
#[test]
fn killed_bring_up_leaves_no_earlier_verification() {
    let (board, mut tool) = armed_bring_up();
    tool.kill().unwrap();
    tool.wait().unwrap();
    assert_sets_nothing(&board.commands());
}

/// An interrupt is no failed check, and leaves no earlier verification.
#[cfg(unix)]
#[test]
fn interrupted_bring_up_fails_no_check_and_verifies_nothing() {
    let (board, tool) = armed_bring_up();
    send(&tool, "-INT");
    let output = tool.wait_with_output().unwrap();
    assert_eq!(output.status.code(), Some(1), "{output:?}");
    let [lines, said] = [output.stdout, output.stderr].map(|it| String::from_utf8(it).unwrap());
    assert!(
        lines.contains("pass  at rest") && !lines.contains("FAIL"),
        "{lines}"
    );
    let end = "error: bring-up: interrupted before its last check; scenes in closed loop are refused until it \
               passes or the board is reset\n";
    assert!(said.ends_with(end), "{said}");
    assert_sets_nothing(&board.commands());
}
