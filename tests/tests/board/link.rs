//! The serial port of the board: its commands and its messages.

use drivers::link::{Message, Parser, Rejected};
use experiments::closed_loop::Hand;
use haptic_control::{Mode, SceneKind, Stop};
use recordings::telemetry::{SideLines, Telemetry};
use virtual_board::command::Command;
use virtual_board::fault::Fault;
use virtual_board::run::{Outcome, Setup};

use crate::image::{end, free_air, of_scene, run, run_image};

/// Messages of the link, and the number of bytes outside of them.
pub(crate) fn messages(bytes: impl IntoIterator<Item = u8>) -> (Vec<Message>, u32) {
    let (mut parser, mut found) = (Parser::default(), Vec::new());
    for byte in bytes {
        parser.take(byte, |message| found.push(message));
    }
    assert_eq!(parser.foreign(), 0);
    (found, parser.garbage())
}

/// Messages of the port.
pub(crate) fn of_port(run: &Outcome) -> (Vec<Message>, u32) {
    messages(run.port.iter().map(|(_, byte)| *byte))
}

/// Messages as telemetry.
pub(crate) fn telemetry(messages: &[Message]) -> Telemetry {
    let mut telemetry = Telemetry::default();
    for message in messages {
        telemetry.add(*message);
    }
    telemetry
}

/// The counts of rejected commands that the port gives last.
pub(crate) fn rejected(run: &Outcome) -> Option<Rejected> {
    let (messages, _) = of_port(run);
    messages.iter().rev().find_map(|message| match message {
        Message::Rejected(counts) => Some(*counts),
        _ => None,
    })
}

pub(crate) fn frame(command: Command) -> Vec<u8> {
    command.encode().to_vec()
}

/// The command `identify`, which the emulated board's list has not.
pub(crate) const IDENTIFY: [u8; 11] = [0xA5, 8, 0, 0, 0, 0, 0, 0, 0, 0, 0xC1];

/// A keep-alive every 50 ms.
pub(crate) fn keep_alive(until_s: f64) -> impl Iterator<Item = (f64, Vec<u8>)> {
    let times = (1..).map(|k| 0.05 * f64::from(k));
    times
        .take_while(move |at| *at < until_s)
        .map(|at| (at, frame(Command::KeepAlive)))
}

/// Free air in a moving hand for so long, commanded by the port alone, which is silent from
/// `silent_s` on.
pub(crate) fn commanded_by_port(seconds: f64, silent_s: f64) -> Setup {
    let commands = [
        (0.05, frame(Command::Scene(SceneKind::FreeAir))),
        (0.1, frame(Command::Arm)),
    ];
    Setup {
        seconds,
        commands: Vec::new(),
        keep_alive: false,
        port: commands.into_iter().chain(keep_alive(silent_s)).collect(),
        ..Setup::default()
    }
}

/// What the log says last of the port's faults: errors and lost frames.
pub(crate) fn port_faults(run: &Outcome) -> Option<[u32; 2]> {
    let log = run.telemetry.log.iter().rev();
    let said = log.clone().find_map(|said| said.strip_prefix("port "))?;
    let mut numbers = said.split_whitespace().zip(["errors=", "lost="]);
    let mut number = || {
        let (word, key) = numbers.next().expect("two fields");
        let number = word.strip_prefix(key).expect("the field's name");
        number.parse().expect("a number")
    };
    Some([number(), number()])
}

#[test]
fn port_arms_selects_and_keeps_alive() {
    let run = run(&commanded_by_port(1.0, 1.0));
    assert_eq!(end(&run), (Mode::Running, Stop::None));
    assert_eq!(rejected(&run), None);
    assert_eq!(port_faults(&run), None, "{:?}", run.telemetry.log);
}

/// The scene is off after 0.5 s and the amplifiers are after 5 s.
#[test]
fn silence_of_the_port_ends_the_scene_and_then_the_arming() {
    let until = |seconds| run(&commanded_by_port(seconds, 0.31));
    assert_eq!(end(&until(0.79)), (Mode::Running, Stop::None));
    assert_eq!(end(&until(0.81)), (Mode::Armed, Stop::CommandTimeout));
    let disarmed = until(5.4);
    assert_eq!(end(&disarmed), (Mode::Boot, Stop::CommandTimeout));
    let off_ns = disarmed.enables.last().expect("enables").0;
    assert!((5.29e9..5.32e9).contains(&(off_ns as f64)), "{off_ns} ns");
}

#[test]
fn frames_of_the_port_are_those_of_the_log() {
    let run = free_air();
    let (messages, garbage) = of_port(run);
    let Some(Message::Hello(hello)) = messages.first() else {
        panic!("{:?}", messages.first());
    };
    let boot = &run.telemetry.boots[0];
    assert_eq!(f64::from(hello.rate), boot.rate_hz);
    assert_eq!(Some(hello.device), boot.device.map(|hash| hash.0));
    assert_eq!(Some(hello.presets), boot.presets.map(|hash| hash.0));
    let telemetry = telemetry(&messages);
    let (mine, log) = (&telemetry.frames, &run.telemetry.frames);
    // The last one is on its way.
    assert!(mine.len() + 2 > log.len(), "{}, {}", mine.len(), log.len());
    for (mine, other) in mine.iter().zip(log) {
        assert_eq!(mine, other);
    }
    assert!(garbage < 100, "{garbage} bytes of the frame on its way");
}

/// The side lines of the port, which are those of the log, of at least so many frames.
fn side_lines(run: &Outcome, least: usize) -> Vec<SideLines> {
    let telemetry = telemetry(&of_port(run).0);
    // Side lines of the last one are on their way.
    let (_, mine) = telemetry.frames.split_last().expect("frames");
    assert!(mine.len() > least, "{}", mine.len());
    for (mine, other) in mine.iter().zip(&run.telemetry.frames) {
        assert_eq!(mine, other);
    }
    mine.iter().map(|frame| frame.side_lines).collect()
}

/// Edges and the reference encoder too.
#[test]
fn side_lines_of_the_port_are_those_of_the_log() {
    let run = run_image(
        "large-adaptive,edge-capture,reference",
        &Setup {
            seconds: 0.5,
            ..Setup::default()
        },
    );
    let lines = side_lines(&run, 480);
    let with_all = |lines: &SideLines| lines.edge.is_some() && lines.learned.is_some();
    assert!(lines.iter().any(with_all));
}

/// With positions and deviations of both encoders that differ.
#[test]
fn measured_side_lines_of_the_port_are_those_of_the_log() {
    let run = run_image(
        "large-adaptive,current-monitor,index-pulse,supply-monitor",
        &Setup {
            faults: vec![(0.5, Fault::LostCounts)],
            ..of_scene(SceneKind::FreeAir, Hand::Tracking, 1.5)
        },
    );
    assert_eq!(end(&run), (Mode::Safe, Stop::LostCounts));
    let with_all = |lines: &SideLines| {
        let Some([large, small]) = lines.index else {
            return false;
        };
        let differ = large.deviation != small.deviation && large.position != small.position;
        differ && lines.measured.is_some() && lines.supply.is_some()
    };
    assert!(side_lines(&run, 1480).iter().any(with_all));
}

/// RTT has the same messages, from the first command on that comes over RTT.
#[test]
fn rtt_has_the_messages_too_once_a_command_came_over_rtt() {
    let silent = run(&commanded_by_port(0.3, 0.3));
    assert_eq!(silent.rtt_link.len(), 0);
    let run = free_air();
    let (messages, garbage) = messages(run.rtt_link.iter().copied());
    let telemetry = telemetry(&messages);
    let from = telemetry.frames.first().expect("frames").seq as usize;
    let first_command = run.sent.first().expect("commands").0 as f64 * 1e-6;
    assert!((from as f64 - first_command).abs() < 4.0, "{from}");
    let log = &run.telemetry.frames[from..];
    assert!(telemetry.frames.len() + 2 > log.len());
    for (mine, other) in telemetry.frames.iter().zip(log) {
        assert_eq!(mine, other);
    }
    assert_eq!(garbage, 0);
}

/// The identity and the rejected commands, to the port and to RTT.
#[test]
fn identify_is_answered_after_the_commands_before_it() {
    let run = run(&Setup {
        seconds: 0.3,
        port: vec![
            (0.2, frame(Command::Estimator(99))),
            (0.2, IDENTIFY.to_vec()),
        ],
        ..Setup::default()
    });
    let (of_port, _) = of_port(&run);
    let (of_rtt, _) = messages(run.rtt_link.iter().copied());
    for (messages, hellos) in [(of_port, 2), (of_rtt, 1)] {
        let is_hello = |message: &Message| matches!(message, Message::Hello(_));
        assert_eq!(messages.iter().filter(|it| is_hello(it)).count(), hellos);
        let last = messages.iter().rposition(is_hello).expect("hello");
        let Message::Rejected(counts) = messages[last + 1] else {
            panic!("{:?}", messages[last + 1]);
        };
        assert_eq!((counts.unknown, counts.garbage), (1, 0));
    }
}

/// What git prints in this repository, if there is one.
fn git(arguments: &[&str]) -> Option<String> {
    let output = std::process::Command::new("git").args(arguments).output();
    let output = output.ok().filter(|output| output.status.success())?;
    Some(
        String::from_utf8(output.stdout)
            .unwrap()
            .trim_end()
            .to_owned(),
    )
}

/// The boot line and the identity have the commit that is checked out, and whether the sources of the
/// image differ from it.
#[test]
fn image_names_its_version_commit_and_features() {
    let run = run_image("large-kalman", &commanded_by_port(0.1, 0.1));
    let boot = &run.telemetry.log[0];
    let word = |key: &str| {
        let mut words = boot.split_whitespace();
        words.find_map(|word| word.strip_prefix(key)).expect(key)
    };
    let Some(Message::Hello(hello)) = of_port(&run).0.first().copied() else {
        panic!("no identity");
    };
    assert_eq!(word("version="), env!("CARGO_PKG_VERSION"));
    assert_eq!(word("version="), hello.version.as_str());
    assert_eq!(word("commit="), hello.commit.as_str());
    assert_eq!(word("features="), "large-kalman");
    assert!(hello.features.names().eq(["large-kalman"]));
    assert_eq!(word("protocol="), hello.protocol.to_string());
    let Some(head) = git(&["rev-parse", "HEAD"]) else {
        assert_eq!(word("commit="), "unknown");
        return;
    };
    let (hash, is_dirty) = match word("commit=").strip_suffix("-dirty") {
        Some(hash) => (hash, true),
        None => (word("commit="), false),
    };
    assert!(hash.len() >= 4 && head.starts_with(hash), "{boot}, {head}");
    let changes = |of: &str| git(&["--no-optional-locks", "status", "--porcelain", of]);
    let is_clean = |of: &str| changes(of).is_some_and(|changes| changes.is_empty());
    assert!(!(is_dirty && is_clean("..")), "{boot}");
    // The tests are no sources of the image.
    assert!(is_dirty || is_clean("../firmware"), "{boot}");
}
