//! Measured currents of a board: calibration of its DACs, and their check in the bring-up.

use std::process::{Command as Process, Output, Stdio};

use drivers::link::Hello;
use drivers::{Command, Setting, Settings};
use haptic_control::{Mode, Request, SceneKind, Stop};

use crate::commands::{ARM, DISARM, deduplicated, sorted};
use crate::scripted::{Board, Script};

/// Offset and slope of both motors.
const MEASURES: [(f32, f32); 2] = [(0.012, 0.96), (-0.006, 1.05)];

const EXCITE: Command = Command::Request(Request::Select(SceneKind::Excite.number()));
/// The zeros of a board at the begin, and those of its offsets in whole codes:
/// 2040 - 0.012 / 6 / 1.1 2047 = 2036.3, and 2048 + 0.006 / 1.5 2047 = 2056.2.
const ZEROS: [Command; 2] = [
    set(Setting::ZeroLarge, 2040.0),
    set(Setting::ZeroSmall, 2048.0),
];
const OTHER_ZEROS: [Command; 2] = [
    set(Setting::ZeroLarge, 2036.0),
    set(Setting::ZeroSmall, 2056.0),
];

/// What a board does with these measured currents, whose settings are not the default ones.
fn script(measures: [(f32, f32); 2]) -> Script {
    let mut settings = Settings::DEFAULT;
    assert!(settings.set(Setting::ZeroLarge, 2040.0) && settings.set(Setting::GainLarge, 1.1));
    Script {
        measures: Some(measures),
        settings,
        ..Script::default()
    }
}

fn board(measures: [(f32, f32); 2]) -> Board {
    Board::new(script(measures))
}

/// The commands without those that measure, and with each repetition left out.
fn afterwards(commands: &[Command]) -> Vec<Command> {
    let commands = deduplicated(sorted(commands).0);
    let [DISARM, ARM, select, DISARM, rest @ ..] = &commands[..] else {
        panic!("{commands:?}");
    };
    assert_eq!(*select, EXCITE);
    rest.to_vec()
}

const fn set(setting: Setting, value: f32) -> Command {
    Command::Set {
        setting: setting.number(),
        value,
    }
}

/// The changes of settings among the commands.
fn sets(mut commands: Vec<Command>) -> Vec<Command> {
    commands.retain(|command| matches!(command, Command::Set { .. }));
    commands
}

fn text(output: &Output) -> [String; 2] {
    [&output.stdout, &output.stderr].map(|bytes| String::from_utf8(bytes.clone()).unwrap())
}

#[test]
fn calibrate_sets_zero_and_gain_of_both_motors() {
    let (output, commands) = board(MEASURES).run(&["calibrate"]);
    let [shown, said] = text(&output);
    assert_eq!(output.status.code(), Some(0), "{shown}{said}");
    let lines: Vec<_> = shown.lines().collect();
    let begins = [
        "pass  large motor           offset 12.0 mA, slope 0.960, residual 0.0 mA of ",
        "pass  small motor           offset -6.0 mA, slope 1.050, residual 0.0 mA of ",
    ];
    assert_eq!(lines.len(), 2, "{shown}");
    for (line, begin) in lines.iter().zip(begins) {
        assert!(line.starts_with(begin), "{shown}");
    }
    // code = zero + current / full scale / gain 2047, and the current is zero at the command
    // -offset / slope.
    let zero_large = 2040.0 - 0.012 / 0.96 / 6.0 / 1.1 * 2047.0;
    let zero_small = 2048.0 + 0.006 / 1.05 / 1.5 * 2047.0;
    let expected = [
        (Setting::ZeroLarge, zero_large, 0.01),
        (Setting::GainLarge, 1.1 * 0.96, 1e-4),
        (Setting::ZeroSmall, zero_small, 0.01),
        (Setting::GainSmall, 1.05, 1e-4),
    ];
    let set = afterwards(&commands);
    assert_eq!(set.len(), 4, "{set:?}");
    // A step of the rounded value.
    for (command, (setting, value, step)) in set.iter().zip(expected) {
        let Command::Set {
            setting: number,
            value: new,
        } = command
        else {
            panic!("{set:?}");
        };
        assert_eq!(*number, setting.number());
        assert!(
            (f64::from(*new) - value).abs() <= step,
            "{setting:?} {new} {value}"
        );
        assert!(
            shown.contains(&format!("{} ", setting.facts().name)),
            "{shown}"
        );
        assert!(shown.contains(&format!(" to {new}")), "{shown}");
    }
    assert!(said.contains("settings --store keeps them"), "{said}");
}

#[test]
fn procedures_disarm_a_board_that_runs_a_scene_first() {
    for procedure in ["bring-up", "calibrate"] {
        let board = Board::new(Script {
            begin: Mode::Running,
            ..script(MEASURES)
        });
        let (output, commands) = board.run(&[procedure]);
        let first = sorted(&commands).0.first().copied();
        assert_eq!(first, Some(DISARM), "{procedure}: {output:?}");
        let [shown, _] = text(&output);
        assert!(shown.contains("motor"), "{procedure}: {shown}");
    }
}

#[test]
fn calibrate_stores_after_it_has_set() {
    let (output, commands) = board(MEASURES).run(&["calibrate", "--store"]);
    let [_, said] = text(&output);
    assert_eq!(output.status.code(), Some(0), "{said}");
    let after = afterwards(&commands);
    let [set @ .., Command::Store] = &after[..] else {
        panic!("{after:?}");
    };
    assert_eq!(set.len(), 4, "{after:?}");
    assert!(said.contains("settings stored"), "{said}");
}

#[test]
fn nothing_is_set_if_one_motor_fails() {
    for (small, told) in [
        ((0.0, 0.1), "check the motor's leads"),
        ((0.0, -1.0), "exchange"),
        ((0.0, 1.3), "gain-small is at least 0.8 and at most 1.25"),
    ] {
        let (output, commands) = board([MEASURES[0], small]).run(&["calibrate", "--store"]);
        let [shown, said] = text(&output);
        assert_eq!(output.status.code(), Some(1), "{said}");
        let lines: Vec<_> = shown.lines().collect();
        assert!(lines[0].starts_with("pass  large motor "), "{shown}");
        assert!(lines[1].starts_with("FAIL  small motor "), "{shown}");
        assert!(lines[1].contains(told), "{shown}");
        assert!(
            said.contains("1 of 2 motors failed; no setting was changed"),
            "{said}"
        );
        assert_eq!(afterwards(&commands), []);
    }
}

/// A handle that is turned out of its bounds ends the strokes. They are repeated with the zeros of the
/// currents beside the command of zero, and these zeros are undone if the repeated ones end early too.
#[test]
fn short_strokes_are_repeated_once_with_other_zeros_which_a_failure_undoes() {
    let board = Board::new(Script {
        strokes_end_after: Some(60),
        ..script(MEASURES)
    });
    let (output, commands) = board.run(&["calibrate"]);
    let [shown, said] = text(&output);
    assert_eq!(output.status.code(), Some(1), "{shown}{said}");
    assert!(said.contains("the strokes are repeated"), "{said}");
    assert!(said.contains("2 of 2 motors failed"), "{said}");
    let after = afterwards(&commands);
    assert_eq!(
        after,
        [&OTHER_ZEROS[..], &[ARM, EXCITE, DISARM], &ZEROS].concat()
    );
}

/// The second change arrives damaged each time: one output would have its new zero with its old gain.
#[test]
fn change_that_fails_undoes_those_before() {
    let board = Board::new(Script {
        damages: (2, 5),
        ..script(MEASURES)
    });
    let (output, commands) = board.run(&["calibrate", "--store"]);
    let [_, said] = text(&output);
    assert_eq!(output.status.code(), Some(1), "{said}");
    assert!(said.contains(": sent 4 times, and not certain"), "{said}");
    assert!(!commands.contains(&Command::Store), "{commands:?}");
    let undone = [
        ZEROS[0],
        set(Setting::GainLarge, 1.1),
        ZEROS[1],
        set(Setting::GainSmall, 1.0),
    ];
    assert!(sets(commands).ends_with(&undone), "{said}");
}

/// The repeated strokes end with a fault of the board here.
#[test]
fn stop_in_the_repeated_strokes_undoes_the_other_zeros() {
    let board = Board::new(Script {
        strokes_end_after: Some(60),
        stop: Some((100, Mode::Safe, Stop::Jump)),
        stops_at: 2,
        ..script(MEASURES)
    });
    let (output, commands) = board.run(&["calibrate"]);
    let [_, said] = text(&output);
    assert_eq!(output.status.code(), Some(1), "{said}");
    assert!(said.contains("the board stopped"), "{said}");
    let [set_large, set_small, arm, excite, disarm, undone @ ..] = &afterwards(&commands)[..]
    else {
        panic!("{commands:?}");
    };
    assert_eq!([*set_large, *set_small], OTHER_ZEROS);
    assert_eq!((*arm, *excite), (ARM, EXCITE));
    // Before the settings, which take their time.
    assert_eq!(*disarm, DISARM);
    assert_eq!(undone, ZEROS);
}

/// Nobody reads the lines of the repeated strokes, or a signal comes in them.
#[cfg(unix)]
#[test]
fn calibrate_that_ends_in_any_other_manner_undoes_the_other_zeros() {
    for is_interrupted in [false, true] {
        let board = Board::new(Script {
            strokes_end_after: Some(60),
            ..script(MEASURES)
        });
        let (reader, writer) = std::io::pipe().unwrap();
        let reader = is_interrupted.then_some(reader);
        let mut tool = board.tool(&["calibrate"]);
        let tool = tool.stdout(writer).stderr(Stdio::piped()).spawn().unwrap();
        if is_interrupted {
            board.wait_for(OTHER_ZEROS[1]);
            board.wait_for(EXCITE);
            let id = tool.id().to_string();
            let killed = Process::new("kill").args(["-INT", &id]).status().unwrap();
            assert!(killed.success());
        }
        let output = tool.wait_with_output().unwrap();
        drop(reader);
        let [_, said] = text(&output);
        assert!(!output.status.success(), "{said}");
        assert!(
            is_interrupted || said.contains("nobody reads the lines"),
            "{said}"
        );
        let sets = sets(board.commands());
        assert_eq!(sets[sets.len().saturating_sub(2)..], ZEROS, "{said}");
    }
}

#[test]
fn failed_bring_up_takes_back_that_the_signs_are_verified() {
    let mut settings = Settings::DEFAULT;
    assert!(settings.set(Setting::SignsVerified, 1.0));
    let default = Script::default();
    // An image for another device fails at once.
    let board = Board::new(Script {
        hello: Hello {
            device: 1,
            ..default.hello
        },
        settings,
        ..default
    });
    let (output, commands) = board.run(&["bring-up"]);
    assert_eq!(output.status.code(), Some(1), "{output:?}");
    assert_eq!(sets(commands), [set(Setting::SignsVerified, 0.0)]);
}

#[test]
fn bring_up_names_settings_that_allow_no_current_and_arms_nothing() {
    for (setting, told) in [
        (Setting::CurrentScale, "0 mA of the large motor"),
        (Setting::LimitLarge, "0 mA of the large motor"),
        (Setting::LimitSmall, "0 mA of the small motor"),
    ] {
        let mut settings = Settings::COMMISSIONED;
        assert!(settings.set(setting, 0.0));
        let board = Board::new(Script {
            settings,
            turns: Some([0; 2]),
            ..Script::default()
        });
        let (output, commands) = board.run(&["bring-up", "--turns"]);
        let [shown, said] = text(&output);
        assert_eq!(output.status.code(), Some(1), "{shown}");
        let line = shown.lines().last().unwrap_or_default();
        assert!(line.starts_with("FAIL  settings"), "{shown}");
        let name = setting.facts().name;
        assert!(line.contains(told) && line.contains(name), "{shown}");
        assert!(!commands.contains(&ARM), "{commands:?}");
        // Nothing is asked of the person.
        assert_eq!(said.lines().count(), 1, "{said}");
    }
}

/// It passes no check, and no further step moves its motors.
#[test]
fn board_that_stays_enabled_after_a_step_ends_the_bring_up() {
    let board = Board::new(Script {
        disarms_after: None,
        measures: Some([(0.0, 1.0); 2]),
        ..Script::default()
    });
    let (output, commands) = board.run(&["bring-up", "--timeout", "4"]);
    assert_eq!(output.status.code(), Some(1), "{output:?}");
    let lines = String::from_utf8(output.stdout).unwrap();
    let last = lines.lines().last().expect("a line");
    assert!(
        last.starts_with("FAIL  armed, no scene ")
            && last.contains("stay enabled after disarm; switch off their supply"),
        "{lines}"
    );
    let is_select = |it: &Command| matches!(it, Command::Request(Request::Select(_)));
    assert!(!commands.iter().any(is_select), "{commands:?}");
}

#[test]
fn image_without_monitors_is_left_alone() {
    let (output, commands) = Board::new(Script::default()).run(&["calibrate"]);
    assert_eq!(output.status.code(), Some(1));
    let error = crate::scripted::error(&output);
    assert!(error.contains("current-monitor"), "{error}");
    assert!(
        error.contains("cargo drive settings zero-large="),
        "{error}"
    );
    assert_eq!(sorted(&commands), (Vec::new(), 0));
}

#[test]
fn bring_up_has_a_line_for_each_measured_current() {
    for (measures, begins) in [
        (MEASURES, ["pass", "pass"]),
        ([(0.0, 0.5), (0.0, 1.0)], ["FAIL", "pass"]),
        ([(0.0, 1.0), (0.1, 1.0)], ["pass", "FAIL"]),
    ] {
        let (output, commands) = board(measures).run(&["bring-up"]);
        let [shown, _] = text(&output);
        // Armed once without a scene.
        let verified = set(Setting::SignsVerified, 0.0);
        let expected = [DISARM, verified, ARM, DISARM, ARM, EXCITE, DISARM];
        assert_eq!(deduplicated(sorted(&commands).0), expected);
        let lines: Vec<_> = shown.lines().collect();
        let names = ["current, large motor", "current, small motor"];
        for ((line, begin), name) in lines[3..].iter().zip(begins).zip(names) {
            assert!(line.starts_with(&format!("{begin}  {name} ")), "{shown}");
        }
        // The shafts do not turn.
        assert!(lines[5].starts_with("FAIL  large motor "), "{shown}");
        assert_eq!(output.status.code(), Some(1));
    }
}
