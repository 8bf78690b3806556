//! Commands that a board gets, and the end of a session.

use drivers::link::Rejected;
use drivers::{Command, Setting, Settings};
use haptic_control::{Mode, Request};

use crate::scripted::{Board, Script, error};

pub(super) const ARM: Command = Command::Request(Request::Arm);
pub(super) const DISARM: Command = Command::Request(Request::Disarm);
const KEEP_ALIVE: Command = Command::Request(Request::KeepAlive);
pub(super) const WALL: Command = Command::Request(Request::Select(2));

fn board() -> Board {
    Board::new(Script::default())
}

/// The commands without questions, for settings too, and keep-alives, and the number of keep-alives.
pub(super) fn sorted(commands: &[Command]) -> (Vec<Command>, usize) {
    let (alive, others): (Vec<_>, Vec<_>) = commands
        .iter()
        .filter(|command| ![Command::Identify, Command::Settings].contains(command))
        .partition(|command| **command == KEEP_ALIVE);
    (others, alive.len())
}

/// `others` without the repetitions at its end: a disarm is sent until a frame shows it.
pub(super) fn deduplicated(mut others: Vec<Command>) -> Vec<Command> {
    others.dedup();
    others
}

#[test]
fn select_arms_keeps_alive_and_disarms_at_the_end() {
    let (output, commands) = board().run(&["select", "wall", "--seconds", "2"]);
    assert_eq!(output.status.code(), Some(0), "{output:?}");
    let (others, alive) = sorted(&commands);
    assert_eq!(deduplicated(others), [ARM, WALL, DISARM]);
    // One for each 0.1 s of the board, which is seen within a frame.
    assert!(alive >= 19, "{alive}");
    let last = commands.iter().rposition(|command| *command == KEEP_ALIVE);
    let end = commands.iter().position(|command| *command == DISARM);
    assert!(last < end, "{commands:?}");
    let text = String::from_utf8(output.stdout).unwrap();
    assert!(text.contains("state running, cause none; torque 0.0100 N·m"));
    let text = String::from_utf8(output.stderr).unwrap();
    assert_eq!(text, "disarmed: state boot, cause none\n");
}

#[test]
fn changes_are_sent_in_the_order_of_their_times() {
    let tune = |parameter, value| Command::Tune {
        scene: 2,
        parameter,
        value,
    };
    let (output, commands) = board().run(&[
        "select",
        "wall",
        "--tune",
        "stiffness=0.1@0.6",
        "--tune",
        "damping=0.001@0.2",
        "--tune",
        "stiffness=0.2",
        "--estimator",
        "kalman-triple-steady@0.4",
        "--seconds",
        "1",
    ]);
    assert_eq!(output.status.code(), Some(0), "{output:?}");
    let expected = [
        ARM,
        WALL,
        tune(1, 0.2),
        tune(2, 0.001),
        Command::Estimator(1),
        tune(1, 0.1),
        DISARM,
    ];
    assert_eq!(deduplicated(sorted(&commands).0), expected);
}

#[test]
fn torque_is_set_after_its_scene_is_selected() {
    let (output, commands) = board().run(&["torque", "-0.01", "--seconds", "0.5"]);
    assert_eq!(output.status.code(), Some(0), "{output:?}");
    let select = Command::Request(Request::Select(8));
    let expected = [ARM, select, Command::Torque(-0.01), DISARM];
    assert_eq!(deduplicated(sorted(&commands).0), expected);
}

#[test]
fn arm_and_keep_alive_end_with_disarm() {
    let (output, commands) = board().run(&["arm", "--seconds", "1"]);
    assert_eq!(output.status.code(), Some(0), "{output:?}");
    let (others, alive) = sorted(&commands);
    assert_eq!(deduplicated(others), [ARM, DISARM]);
    assert!(alive >= 9, "{alive}");
    let armed = Script {
        begin: Mode::Running,
        ..Script::default()
    };
    let (output, commands) = Board::new(armed).run(&["keep-alive", "--seconds", "1"]);
    assert_eq!(output.status.code(), Some(0), "{output:?}");
    let (others, alive) = sorted(&commands);
    assert_eq!(deduplicated(others), [DISARM]);
    assert!(alive >= 9, "{alive}");
}

#[test]
fn keep_alive_of_a_board_that_is_not_armed_is_refused() {
    let (output, commands) = board().run(&["keep-alive"]);
    assert_eq!(output.status.code(), Some(1));
    assert!(error(&output).starts_with("nothing to keep alive: state boot"));
    assert_eq!(sorted(&commands), (Vec::new(), 0));
}

#[test]
fn tune_and_estimator_change_a_board_without_arming_it() {
    let (output, commands) = board().run(&["tune", "wall", "stiffness", "0.2"]);
    assert_eq!(output.status.code(), Some(0), "{output:?}");
    let tune = Command::Tune {
        scene: 2,
        parameter: 1,
        value: 0.2,
    };
    assert_eq!(sorted(&commands), (vec![tune], 0));
    let (output, commands) = board().run(&["estimator", "kalman-triple-steady"]);
    assert_eq!(output.status.code(), Some(0), "{output:?}");
    assert_eq!(sorted(&commands), (vec![Command::Estimator(1)], 0));
    let said = String::from_utf8(output.stderr).unwrap();
    assert_eq!(
        said,
        "estimator kalman-triple-steady, until the next reset\n"
    );
}

/// Settings are shown, and until the next reset only those last that were changed.
#[test]
fn settings_that_stay_as_they_are_say_nothing_of_the_next_reset() {
    for (arguments, said) in [
        (&["settings"][..], ""),
        (
            &["settings", "serial=7"],
            "until the next reset; --store keeps them\n",
        ),
    ] {
        let (output, _) = board().run(arguments);
        assert_eq!(output.status.code(), Some(0), "{output:?}");
        assert_eq!(String::from_utf8_lossy(&output.stderr), said);
    }
}

#[test]
fn watch_sends_questions_alone() {
    let (output, commands) = board().run(&["watch", "--every", "0.1", "--seconds", "1"]);
    assert_eq!(output.status.code(), Some(0), "{output:?}");
    let text = String::from_utf8(output.stdout).unwrap();
    assert_eq!(text.lines().count(), 11, "{text}");
    for line in text.lines() {
        let (begin, end) = line.split_once(" s, state boot, cause none; ").unwrap();
        let seq = begin.parse::<f64>().unwrap() * 1e3;
        let counts = [3.0 * seq, -seq].map(f64::round);
        let expected = format!(
            "torque 0.0100 N·m; large {} counts, 1.500 rad/s (sigma 0.125), 0.500 A, estimator foaw-end-fit; \
             handle {} counts, -2.500 rad/s, -0.250 A; overruns 0, lost frames 0",
            counts[0], counts[1]
        );
        assert_eq!(end, expected);
    }
    assert_eq!(sorted(&commands), (Vec::new(), 0));
}

#[test]
fn refused_value_is_told_and_ends_a_session_with_disarm() {
    let refuses = || {
        Board::new(Script {
            refuses: true,
            ..Script::default()
        })
    };
    let (output, _) = refuses().run(&["tune", "wall", "stiffness", "0.2"]);
    assert_eq!(output.status.code(), Some(1));
    let said = error(&output);
    assert_eq!(
        said,
        "wall stiffness 0.2 N·m/rad: the board refuses it: the value is out of bounds"
    );
    let (output, _) = refuses().run(&["tune", "detents", "per-turn", "1000"]);
    assert_eq!(
        error(&output),
        "detents per-turn 1000: the board refuses it: the value is out of bounds; amplitude times per-turn is \
         at most 0.35 N·m/rad"
    );
    let (output, commands) = refuses().run(&[
        "select",
        "wall",
        "--tune",
        "stiffness=0.2@0.1",
        "--seconds",
        "10",
    ]);
    assert_eq!(output.status.code(), Some(1));
    assert_eq!(
        error(&output),
        "wall stiffness 0.2 N·m/rad: the board refuses it: the value is out of bounds"
    );
    assert_eq!(commands.last(), Some(&DISARM), "{commands:?}");
}

#[test]
fn values_that_a_scene_refuses_together_are_refused_before_the_board_is_armed() {
    let (output, commands) = board().run(&[
        "select",
        "detents",
        "--tune",
        "per-turn=1000@2",
        "--tune",
        "amplitude=0.04@1",
        "--seconds",
        "3",
    ]);
    assert_eq!(output.status.code(), Some(2));
    assert_eq!(
        error(&output),
        "detents per-turn 1000: the value is out of bounds; amplitude times per-turn is at most 0.35 N·m/rad"
    );
    assert_eq!(sorted(&commands), (Vec::new(), 0));
}

#[test]
fn changes_of_one_time_keep_their_order() {
    let tune = ["--tune", "stiffness=0.1", "--tune", "stiffness=0.2"];
    let arguments = [&["select", "wall", "--seconds", "0.2"][..], &tune].concat();
    let (output, commands) = board().run(&arguments);
    assert_eq!(output.status.code(), Some(0), "{output:?}");
    let values = commands.iter().filter_map(|command| match command {
        Command::Tune { value, .. } => Some(*value),
        _ => None,
    });
    assert_eq!(values.collect::<Vec<_>>(), [0.1, 0.2]);
}

/// The counts of a board that has started again begin at 0.
#[test]
fn reset_of_the_board_is_no_refusal() {
    let board = Board::new(Script {
        starts_again: Some((ARM, 300)),
        ..Script::default()
    });
    let (output, _) = board.run(&["arm", "--seconds", "10"]);
    assert_eq!(output.status.code(), Some(1), "{output:?}");
    let said = error(&output);
    assert!(said.starts_with("the board stopped: state boot"), "{said}");
}

/// No count of rejected commands tells the start.
#[test]
fn start_of_the_board_that_loses_a_setting_is_told_and_nothing_is_stored_for_it() {
    let set = Command::Set {
        setting: Setting::CurrentScale.number(),
        value: 0.5,
    };
    for (from, said) in [
        (
            set,
            ": the board has started again; find the cause of the reset",
        ),
        (
            Command::Settings,
            "not stored: the board has started again, and has lost what was changed",
        ),
    ] {
        let board = Board::new(Script {
            starts_again: Some((from, 0)),
            rejected: Rejected::default(),
            ..Script::default()
        });
        let arguments = ["settings", "current-scale=0.5", "serial=7", "--store"];
        let (output, _) = board.run(&arguments);
        assert_eq!(output.status.code(), Some(1), "{output:?}");
        let error = error(&output);
        assert!(error.contains(said), "{error}");
    }
}

#[test]
fn scene_in_closed_loop_is_refused_before_the_board_is_armed_if_the_signs_are_not_verified() {
    let blank = || {
        Board::new(Script {
            settings: Settings::DEFAULT,
            ..Script::default()
        })
    };
    let (output, commands) = blank().run(&["select", "wall", "--seconds", "0.5"]);
    assert_eq!(output.status.code(), Some(1), "{output:?}");
    assert_eq!(
        error(&output),
        "scene wall: the board refuses it: the signs of encoders and currents have not been verified; run cargo \
         drive bring-up"
    );
    assert_eq!(sorted(&commands), (Vec::new(), 0));
    // A scene without feedback needs no signs.
    let (output, _) = blank().run(&["select", "excite", "--seconds", "0.5"]);
    assert_eq!(output.status.code(), Some(0), "{output:?}");
}
