//! Ports and boards that cannot be used, and input that is refused: one line with a remedy, status 2.

use std::io::{Read as _, Write as _};
use std::net::{Shutdown, TcpListener};
use std::thread;

use drive::port::TAKEN;
use drivers::Command;
use drivers::link::Hello;
use haptic_control::Request;

use crate::player::appended;
use crate::scripted::{Board, Script, error, tool};

#[test]
fn port_that_cannot_be_opened_is_named() {
    for (port, said) in [
        ("/dev/no-such-port", "/dev/no-such-port: cannot open"),
        ("tcp:127.0.0.1:1", "start the board's server first"),
        ("tcp:nonsense", "tcp:nonsense: cannot open"),
        (
            "127.0.0.1:36907",
            "for a TCP port, write tcp: before the address",
        ),
    ] {
        let output = tool(&["info", "--port", port]).output().unwrap();
        assert_eq!(output.status.code(), Some(2), "{port}");
        let error = error(&output);
        assert!(error.contains(said), "{error}");
    }
}

/// Nothing is said of the scene, which the other program may keep alive.
#[test]
fn port_that_another_program_has_is_told() {
    for arguments in [
        &["info"][..],
        &["disarm"],
        &["watch", "--seconds", "1"],
        &["arm", "--seconds", "1"],
    ] {
        let listener = TcpListener::bind("127.0.0.1:0").unwrap();
        let port = format!("tcp:{}", listener.local_addr().unwrap());
        let server = thread::spawn(move || {
            let (mut stream, _) = listener.accept().unwrap();
            stream.write_all(TAKEN).unwrap();
            stream.shutdown(Shutdown::Write).unwrap();
            let _ = stream.read_to_end(&mut Vec::new());
        });
        let mut process = tool(arguments);
        process.args(["--port", &port, "--timeout", "30"]);
        let output = process.output().unwrap();
        server.join().unwrap();
        assert_eq!(output.status.code(), Some(2), "{arguments:?}");
        let said = format!("{port}: another program has this port; end it first");
        assert_eq!(error(&output), said, "{arguments:?}");
    }
}

#[test]
fn board_that_sends_nothing_is_told() {
    let board = Board::new(Script {
        instead: Some(Vec::new()),
        ..Script::default()
    });
    let (output, _) = board.run(&["info", "--timeout", "0.3"]);
    assert_eq!(output.status.code(), Some(2));
    assert!(error(&output).contains("the board sends nothing; check the port"));
}

/// Text of another program, and a frame of a kind that this protocol has not: kind 99, no payload.
#[test]
fn bytes_that_are_no_message_are_told() {
    for (instead, said) in [
        (
            b"some log\n".to_vec(),
            " bytes were no message; check the port",
        ),
        (
            appended(&[0x5A, 99, 0, 0, 0], &[]),
            " messages are of another protocol; check the port",
        ),
    ] {
        let board = Board::new(Script {
            instead: Some(instead),
            ..Script::default()
        });
        let (output, _) = board.run(&["info", "--timeout", "0.3"]);
        assert_eq!(output.status.code(), Some(2));
        let error = error(&output);
        assert!(error.contains("the board does not answer; "), "{error}");
        assert!(error.contains(said), "{error}");
    }
}

#[test]
fn list_needs_no_port() {
    let output = tool(&["list"]).output().unwrap();
    assert_eq!(output.status.code(), Some(0), "{output:?}");
    let [listed, said] = [output.stdout, output.stderr].map(|it| String::from_utf8(it).unwrap());
    match listed.is_empty() {
        true => assert_eq!(said, "no serial port; connect the board\n"),
        false => assert_eq!(said, ""),
    }
}

#[test]
fn list_takes_no_port() {
    for arguments in [["--port", "nope", "list"], ["list", "--port", "nope"]] {
        let output = tool(&arguments).output().unwrap();
        assert_eq!(output.status.code(), Some(2), "{output:?}");
        let said = "--port nope: list opens no port; leave --port out";
        assert_eq!(error(&output), said);
    }
    let help = tool(&["list", "--help"]).output().unwrap();
    let help = String::from_utf8(help.stdout).unwrap();
    assert!(
        !help.contains("--port") && !help.contains("--timeout"),
        "{help}"
    );
}

#[test]
fn missing_command_is_told_with_the_names_of_all() {
    let output = tool(&[]).output().unwrap();
    assert_eq!(output.status.code(), Some(2), "{output:?}");
    let said = error(&output);
    let begin = "a command is missing; give one of list, info, arm, disarm, select, ";
    assert!(said.starts_with(begin), "{said}");
    assert!(
        said.ends_with(", record, watch; see cargo drive --help"),
        "{said}"
    );
}

#[test]
fn input_is_refused_before_the_board_gets_a_command() {
    // No port is opened for these.
    for (arguments, said) in [
        (&["select", "wal"][..], "no scene 'wal'; did you mean wall?"),
        (
            &["tune", "wall", "stifness", "1"],
            "did you mean stiffness?",
        ),
        (
            &["tune", "torque", "torque", "0"],
            "use cargo drive torque VALUE",
        ),
        (&["estimator", "pll"], "no estimator 'pll'"),
        (&["select", "wall", "--tune", "stiffness"], "NAME=VALUE@S"),
        (
            &["select", "wall", "--tune", "stifness=0.2@1"],
            "no parameter of wall 'stifness'; did you mean stiffness?",
        ),
        (
            &["select", "wall", "--estimator", "pll@1"],
            "no estimator 'pll'",
        ),
        (&["select", "wall", "--seconds", "-1"], "above 0 s"),
        (&["watch", "--every", "nan"], "above 0 s"),
        (&["info", "--timeout", "0"], "0.1 to 60 s"),
        (&["fly"], "see cargo drive --help"),
        (&["torque"], "see cargo drive torque --help"),
        (
            &["torque", "inf"],
            "torque inf N·m: not finite; give a number",
        ),
        (
            &["tune", "wall", "stiffness", "NaN"],
            "wall stiffness NaN N·m/rad: not finite; give a number",
        ),
        (
            &["select", "wall", "--tune", "stiffness=nan@1"],
            "wall stiffness NaN N·m/rad: not finite; give a number",
        ),
    ] {
        let mut tool = tool(arguments);
        let output = tool.args(["--port", "/dev/no-such-port"]).output().unwrap();
        assert_eq!(output.status.code(), Some(2), "{arguments:?}");
        let error = error(&output);
        assert!(error.contains(said), "{error}");
    }
}

#[test]
fn value_out_of_bounds_is_refused_with_the_bounds() {
    for arguments in [
        &["tune", "wall", "stiffness", "0.36"][..],
        &["select", "wall", "--tune", "stiffness=-1", "--seconds", "1"],
    ] {
        let (output, commands) = Board::new(Script::default()).run(arguments);
        assert_eq!(output.status.code(), Some(2));
        let said = error(&output);
        assert!(
            said.ends_with("out of bounds; give 0 to 0.35 N·m/rad"),
            "{said}"
        );
        assert!(commands.iter().all(|it| *it == Command::Identify));
    }
    let (output, commands) =
        Board::new(Script::default()).run(&["torque", "-0.05", "--seconds", "1"]);
    assert_eq!(output.status.code(), Some(2));
    assert!(error(&output).starts_with("torque -0.05 N·m: out of bounds"));
    assert!(!commands.contains(&Command::Request(Request::Arm)));
}

/// An image for another device has bounds of its own and checks them.
#[test]
fn bounds_of_another_device_are_left_to_the_board() {
    let other = || {
        let script = Script::default();
        Board::new(Script {
            hello: Hello {
                device: script.hello.device ^ 1,
                ..script.hello
            },
            ..script
        })
    };
    let (output, commands) = other().run(&["tune", "texture", "amplitude", "0.05"]);
    assert_eq!(output.status.code(), Some(0), "{output:?}");
    assert!(commands.iter().any(|it| matches!(it, Command::Tune { .. })));
    let (output, _) = other().run(&["tune", "texture", "amplitude", "inf"]);
    assert_eq!(output.status.code(), Some(2));
}

/// The image has two estimators, as its features tell.
#[test]
fn setting_of_an_estimator_that_the_image_has_not_is_refused() {
    let arguments = ["settings", "estimator=7", "--store"];
    let (output, commands) = Board::new(Script::default()).run(&arguments);
    assert_eq!(output.status.code(), Some(2), "{output:?}");
    let said = error(&output);
    assert!(
        said.starts_with("estimator=7: the image has no estimator 7; there are 0 (foaw"),
        "{said}"
    );
    assert!(commands.iter().all(|it| *it == Command::Identify));
}

#[test]
fn help_names_scenes_parameters_and_estimators() {
    for (command, said) in [
        ("select", "<SCENE>  Scene: off, free-air, wall"),
        ("tune", "detents        amplitude, per-turn"),
        ("estimator", "foaw-end-fit, kalman-triple-steady"),
    ] {
        let output = tool(&[command, "--help"]).output().unwrap();
        let text = String::from_utf8(output.stdout).unwrap();
        // Lines are wrapped.
        let words = |text: &str| text.split_whitespace().collect::<Vec<_>>().join(" ");
        assert!(words(&text).contains(&words(said)), "{text}");
        // Nothing of a scene lasts that has no parameter, or only the set-point of the torque.
        let nothing_lasts = |line: &str| ["off", "torque torque"].contains(&&*words(line));
        assert!(!text.lines().any(nothing_lasts), "{text}");
    }
}
