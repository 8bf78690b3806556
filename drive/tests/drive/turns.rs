//! Counts of a turn in the bring-up of a board that captures index pulses.

use haptic_control::DualStage;

use crate::scripted::{Board, Script, error};

/// Standard output of `bring-up` with these arguments on a board with these turns, whose shafts rest.
fn shown(turns: Option<[u32; 2]>, arguments: &[&str]) -> String {
    let board = Board::new(Script {
        measures: Some([(0.0, 1.0); 2]),
        turns,
        ..Script::default()
    });
    let (output, _) = board.run(&[&["bring-up"], arguments].concat());
    // The shafts do not turn, or those of the turns are wrong.
    assert_eq!(output.status.code(), Some(1), "{output:?}");
    String::from_utf8(output.stdout).unwrap()
}

/// Counts of a turn by the device file.
fn stated() -> [u32; 2] {
    let DualStage { large, small, .. } = tuned::DEVICE;
    [large.counts_per_rev, small.counts_per_rev]
}

/// The lines on turns, and the number of the lines before them.
fn of_turns(shown: &str) -> (Vec<&str>, usize) {
    let lines: Vec<_> = shown.lines().collect();
    let is_of_turn = |line: &&&str| line.contains("  turn, ");
    let before = lines.iter().position(|line| is_of_turn(&line));
    let found = lines.iter().filter(is_of_turn).copied();
    (found.collect(), before.unwrap_or(lines.len()))
}

#[test]
fn turns_of_the_device_file_pass() {
    let [large, small] = stated();
    for (arguments, at) in [(&["--turns"][..], 1), (&[], 7)] {
        let shown = shown(Some(stated()), arguments);
        let (found, before) = of_turns(&shown);
        assert_eq!((found.len(), before), (2, at), "{shown}");
        for (line, (name, counts)) in found.iter().zip([("large", large), ("handle", small)]) {
            assert!(
                line.starts_with(&format!("pass  turn, {name} encoder ")),
                "{shown}"
            );
            assert!(
                line.ends_with(&format!(
                    " {counts} counts from index to index, {counts} in the device file"
                )),
                "{shown}"
            );
        }
        // The bring-up goes on.
        assert!(shown.contains("pass  at rest"), "{shown}");
    }
}

/// The motors move the device later.
#[test]
fn hands_are_sent_to_the_shafts_and_away_from_them() {
    let board = Board::new(Script {
        turns: Some(stated()),
        ..Script::default()
    });
    let (output, _) = board.run(&["bring-up", "--turns"]);
    let said = String::from_utf8(output.stderr).unwrap();
    let begins = [
        "turn the shafts of both motors by hand, ",
        "take your hands off the device",
        "leave the handle free and do not touch it: ",
    ];
    let lines: Vec<_> = said.lines().take(begins.len()).collect();
    assert_eq!(lines.len(), begins.len(), "{said}");
    for (line, begin) in lines.iter().zip(begins) {
        assert!(line.starts_with(begin), "{said}");
    }
}

#[test]
fn wrong_turns_by_hand_end_the_bring_up() {
    let [large, small] = stated();
    let shown = shown(Some([2 * large, small]), &["--turns"]);
    let lines: Vec<_> = shown.lines().collect();
    assert_eq!(lines.len(), 3, "{shown}");
    assert!(
        lines[1].starts_with("FAIL  turn, large encoder ")
            && lines[1].contains(&format!("{} counts from", 2 * large))
            && lines[1].contains(&format!("{large} in the device file")),
        "{shown}"
    );
    assert!(
        lines[2].starts_with("pass  turn, handle encoder "),
        "{shown}"
    );
}

#[test]
fn turns_that_are_not_seen_are_skipped_and_no_pass() {
    // Pulses of one place.
    let shown = shown(Some([0; 2]), &[]);
    let (found, _) = of_turns(&shown);
    assert_eq!(found.len(), 2, "{shown}");
    for line in found {
        assert!(line.starts_with("skip  turn, "), "{shown}");
        assert!(line.contains("bring-up --turns"), "{shown}");
    }
}

#[test]
fn image_without_index_pulses_has_no_turns() {
    assert_eq!(of_turns(&shown(None, &[])).0, [""; 0]);
    let (output, _) = Board::new(Script::default()).run(&["bring-up", "--turns"]);
    assert_eq!(output.status.code(), Some(1));
    let text = String::from_utf8(output.stdout.clone()).unwrap();
    assert_eq!(text.lines().count(), 1, "{text}");
    let error = error(&output);
    assert!(
        error.contains("index-pulse") && error.contains("leave --turns out"),
        "{error}"
    );
}
