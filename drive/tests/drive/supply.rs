//! The supply of the amplifiers, of a board that reads it.

use std::fs;
use std::path::PathBuf;

use crate::scripted::{Board, Script};

/// Standard output of the tool on a board with this supply, V, whose shafts rest, and its exit status.
fn shown(supply: Option<f32>, arguments: &[&str]) -> (String, Option<i32>) {
    let board = Board::new(Script {
        supply,
        measures: Some([(0.0, 1.0); 2]),
        ..Script::default()
    });
    let (output, _) = board.run(arguments);
    let shown = String::from_utf8(output.stdout).unwrap();
    (shown, output.status.code())
}

#[test]
fn bring_up_has_a_line_for_the_supply() {
    let (text, _) = shown(Some(24.25), &["bring-up"]);
    let lines: Vec<_> = text.lines().collect();
    let line =
        "pass  supply                24.25 V, from 24.25 to 24.25 V; 20.4 to 28.8 V are allowed";
    assert_eq!(lines[1], line, "{text}");
    assert!(lines[2].starts_with("pass  at rest "), "{text}");
    assert!(lines[3].starts_with("pass  armed, no scene "), "{text}");
    // Once.
    assert_eq!(text.matches("  supply ").count(), 1, "{text}");
    let (text, _) = shown(None, &["bring-up"]);
    assert!(!text.contains("supply"), "{text}");
}

/// Nothing is armed then.
#[test]
fn bring_up_ends_with_a_supply_that_is_not_in_its_range() {
    for volts in [12.0, 36.0] {
        let (text, status) = shown(Some(volts), &["bring-up"]);
        assert_eq!(status, Some(1), "{text}");
        let lines: Vec<_> = text.lines().collect();
        assert_eq!(lines.len(), 3, "{text}");
        assert!(lines[1].starts_with("FAIL  supply "), "{text}");
        assert!(
            lines[1].contains("check the supply of the amplifiers"),
            "{text}"
        );
    }
}

#[test]
fn lines_of_watch_have_the_supply() {
    let arguments = ["watch", "--every", "0.1", "--seconds", "0.35"];
    let (text, status) = shown(Some(24.25), &arguments);
    assert_eq!(status, Some(0), "{text}");
    let lines: Vec<_> = text.lines().collect();
    assert_eq!(lines.len(), 4, "{text}");
    let has = |line: &&&str| line.ends_with(", supply 24.25 V");
    // The voltage comes after its frame, so that the first one may lack it.
    assert!(lines[1..].iter().filter(has).count() == 3, "{text}");
    let (text, _) = shown(None, &arguments);
    assert!(!text.contains("supply"), "{text}");
}

#[test]
fn recording_has_the_supply_as_a_column() {
    let out = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join("supply.csv");
    let path = out.to_str().unwrap();
    let (_, status) = shown(Some(24.25), &["record", "--out", path, "--seconds", "0.2"]);
    assert_eq!(status, Some(0));
    let text = fs::read_to_string(&out).unwrap();
    let lines: Vec<_> = text.lines().collect();
    assert!(lines[0].ends_with(",supply"), "{}", lines[0]);
    // The last one may be on its way.
    let [_, rows @ .., _] = &lines[..] else {
        panic!("{text}");
    };
    assert!(rows.len() >= 199, "{}", rows.len());
    assert!(rows.iter().all(|row| row.ends_with(",24.25")), "{text}");
}
