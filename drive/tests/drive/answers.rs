//! Changes whose answer is late or lost, and those that may have arrived damaged.

use std::process::Output;

use drivers::Command;

use crate::scripted::{Board, Part, Script, error};

/// Each question is answered when the next one comes: the answer before the change is of no use.
#[test]
fn refusal_is_found_by_an_answer_to_a_later_question_alone() {
    let board = Board::new(Script {
        refuses: true,
        answers_late: true,
        ..Script::default()
    });
    let (output, _) = board.run(&["tune", "wall", "stiffness", "0.2"]);
    assert_eq!(output.status.code(), Some(1), "{output:?}");
    assert!(error(&output).contains("the board refuses it"));
}

/// Another program at the debug probe, or noise on a line that damages no command.
#[test]
fn bytes_that_are_no_command_end_no_session() {
    let tune = ["select", "wall", "--tune", "stiffness=0.2@0.2"];
    for arguments in [&["watch"][..], &["arm"], &tune] {
        let board = Board::new(Script {
            garbles: true,
            ..Script::default()
        });
        let (output, _) = board.run(&[arguments, &["--seconds", "0.5"]].concat());
        assert_eq!(output.status.code(), Some(0), "{arguments:?}: {output:?}");
    }
}

/// Changes that arrive damaged: one, and each.
#[test]
fn change_that_may_be_damaged_is_sent_again() {
    const SAID: &str = "check the line of the board, and end what writes to its debug probe";
    let number = |commands: &[Command]| {
        let values = commands.iter();
        values
            .filter(|it| matches!(it, Command::Tune { .. }))
            .count()
    };
    for (damages, sent) in [(1, 2), (9, 4)] {
        let board = || {
            Board::new(Script {
                damages: (1, damages),
                ..Script::default()
            })
        };
        let said = |output: &Output| String::from_utf8(output.stderr.clone()).unwrap();
        let (output, commands) = board().run(&["tune", "wall", "stiffness", "0.2"]);
        assert_eq!(output.status.code(), Some(i32::from(damages == 9)));
        assert_eq!(number(&commands), sent);
        assert_eq!(said(&output).contains(SAID), damages == 9, "{output:?}");
        let tune = ["select", "wall", "--tune", "stiffness=0.2@0.1"];
        let (output, commands) = board().run(&[&tune[..], &["--seconds", "2"]].concat());
        assert_eq!(output.status.code(), Some(0), "{output:?}");
        assert_eq!(number(&commands), sent);
        assert_eq!(said(&output).contains(SAID), damages == 9, "{output:?}");
    }
}

/// The question after the first change is the third one, after that of the connection and that after the scene.
#[test]
fn change_after_a_lost_answer_is_sent_again_if_it_may_be_damaged() {
    for part in [Part::Identity, Part::Counts] {
        let board = Board::new(Script {
            loses: Some((3, part)),
            damages: (2, 2),
            ..Script::default()
        });
        let (output, commands) = board.run(&[
            "select",
            "wall",
            "--tune",
            "stiffness=0.2@0.1",
            "--tune",
            "damping=0.001@0.2",
            "--seconds",
            "5",
        ]);
        assert_eq!(output.status.code(), Some(0), "{part:?}: {output:?}");
        let damping = |command: &&Command| matches!(command, Command::Tune { parameter: 2, .. });
        assert_eq!(
            commands.iter().filter(damping).count(),
            2,
            "{part:?}: {commands:?}"
        );
    }
}

/// The answer to the question after a change would come with the next question.
#[test]
fn change_without_an_answer_is_told_at_the_end() {
    let board = Board::new(Script {
        answers_late: true,
        ..Script::default()
    });
    let tune = ["select", "wall", "--tune", "stiffness=0.2@0.4"];
    let (output, _) = board.run(&[&tune[..], &["--seconds", "0.5"]].concat());
    assert_eq!(output.status.code(), Some(0), "{output:?}");
    let note = "wall stiffness 0.2 N\u{b7}m/rad: the session ended before the board told whether it took it; \
                give a longer --seconds\n";
    let said = String::from_utf8(output.stderr).unwrap();
    assert!(said.starts_with(note), "{said}");
}
