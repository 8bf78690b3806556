//! Identity of a board, and boards of another protocol.

use drivers::Command;
use drivers::link::{Features, Hello, PROTOCOL};
use haptic_control::Request;

use crate::scripted::{Board, Script, error};

/// A board of a later protocol, whose identity has more fields.
fn later() -> Board {
    let script = Script::default();
    Board::new(Script {
        hello: Hello {
            protocol: PROTOCOL + 1,
            ..script.hello
        },
        appended: vec![1, 2, 3],
        ..script
    })
}

#[test]
fn info_has_every_property_even_among_noise_and_half_frames() {
    // A start byte, a kind and a length that is never reached; a frame with a wrong checksum.
    let noise = vec![0x5A, 2, 100, 0xFF, 0x5A, 5, 1, 9, 0, 0];
    let board = Board::new(Script {
        noise,
        ..Script::default()
    });
    let (output, commands) = board.run(&["info"]);
    let text = String::from_utf8(output.stdout).unwrap();
    assert_eq!(output.status.code(), Some(0), "{text}");
    for said in [
        "protocol           1\n",
        "firmware           0.1.0, commit a1b2c3d\n",
        "features           reference, edge-capture\n",
        "control rate       10000 Hz\n",
        "reset              cause watchdog\n",
        "reset below 2.7 V  yes\n",
        "rejected commands  0 not finite, 0 out of bounds, 1 unknown, 0 before bring-up, 7 bytes of garbage\n",
    ] {
        assert!(text.contains(said), "{said}: {text}");
    }
    assert!(!text.contains("this tool is built for"), "{text}");
    assert!(commands.iter().all(|it| *it == Command::Identify));
}

#[test]
fn info_names_a_device_and_presets_that_are_not_those_of_the_tool() {
    let script = Script::default();
    let board = Board::new(Script {
        hello: Hello {
            device: 1,
            presets: 2,
            features: Features::default(),
            brown_out_reset: false,
            ..script.hello
        },
        ..script
    });
    let (output, _) = board.run(&["info"]);
    let text = String::from_utf8(output.stdout).unwrap();
    for said in [
        "device             00000001; this tool is built for ",
        "presets            00000002; this tool is built for ",
        "features           none\n",
    ] {
        assert!(text.contains(said), "{said}: {text}");
    }
    assert!(text.contains("reset below 2.7 V  no\n"), "{text}");
}

#[test]
fn info_tells_another_protocol() {
    let (output, _) = later().run(&["info"]);
    let text = String::from_utf8(output.stdout).unwrap();
    assert_eq!(output.status.code(), Some(0));
    let said = format!("protocol           {}; this tool speaks 1", PROTOCOL + 1);
    assert!(text.contains(&said), "{text}");
    assert!(text.contains("commit a1b2c3d") && !text.contains("rejected"));
}

#[test]
fn board_of_another_protocol_gets_no_command_but_disarm() {
    for arguments in [
        &["arm", "--seconds", "1"][..],
        &["select", "wall", "--seconds", "1"],
        &["tune", "wall", "stiffness", "0.2"],
        &["torque", "0.01", "--seconds", "1"],
        &["estimator", "foaw-end-fit"],
        &["keep-alive", "--seconds", "1"],
        &["settings", "serial=7"],
        &["bring-up"],
        &["calibrate"],
        &["watch", "--seconds", "1"],
        &["record", "--out", "-", "--seconds", "1"],
    ] {
        let (output, commands) = later().run(arguments);
        assert_eq!(output.status.code(), Some(2), "{arguments:?}");
        let said = error(&output);
        assert!(said.contains("speaks protocol 2, this tool protocol 1"));
        assert!(commands.iter().all(|it| *it == Command::Identify));
    }
    let (output, commands) = later().run(&["disarm"]);
    assert_eq!(output.status.code(), Some(0));
    let disarm = Command::Request(Request::Disarm);
    assert!(!commands.is_empty() && commands.iter().all(|it| *it == disarm));
}
