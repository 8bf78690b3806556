//! The serial port of the board: its commands, its messages, and a line that is disturbed.

use std::io::{Read as _, Write as _};
use std::net::TcpStream;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use drivers::link::{Message, Parser, Rejected};
use haptic_control::{Mode, SceneKind, Stop};
use recordings::telemetry::Telemetry;
use simulation::device::Device;
use virtual_board::bridge::Bridge;
use virtual_board::command::Command;
use virtual_board::port::LineErrors;
use virtual_board::run::{ControlTick, CoreAccess, Outcome, RATE_HZ, Setup};

use crate::image::{free_air, image, run, run_image};

/// Baud rate register of USART3; a rate so low that no frame of telemetry is sent in a run.
const BAUD_DIVIDER: u32 = 0x4000_4808;
const SLOW: u32 = 0xFFFF;
/// `DMA_S1M0AR`: buffer of the stream that receives. A write while the stream uses it stops it with a
/// transfer error (RM0090, 10.3.9).
const RECEIVE_BUFFER: u32 = 0x4002_6034;

/// Messages of the link, and the number of bytes outside of them.
fn messages(bytes: impl IntoIterator<Item = u8>) -> (Vec<Message>, u32) {
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
fn telemetry(messages: &[Message]) -> Telemetry {
    let mut telemetry = Telemetry::default();
    for message in messages {
        telemetry.add(*message);
    }
    telemetry
}

/// The counts of rejected commands that the port gives last.
fn rejected(run: &Outcome) -> Option<Rejected> {
    let (messages, _) = of_port(run);
    messages.iter().rev().find_map(|message| match message {
        Message::Rejected(counts) => Some(*counts),
        _ => None,
    })
}

fn frame(command: Command) -> Vec<u8> {
    command.encode().to_vec()
}

/// The command `identify`, which the emulated board's list has not.
const IDENTIFY: [u8; 11] = [0xA5, 8, 0, 0, 0, 0, 0, 0, 0, 0, 0xC1];

/// A keep-alive every 50 ms.
fn keep_alive(until_s: f64) -> impl Iterator<Item = (f64, Vec<u8>)> {
    let times = (1..).map(|k| 0.05 * f64::from(k));
    times
        .take_while(move |at| *at < until_s)
        .map(|at| (at, frame(Command::KeepAlive)))
}

/// Free air in a moving hand for so long, commanded by the port alone, which is silent from
/// `silent_s` on.
fn commanded_by_port(seconds: f64, silent_s: f64) -> Setup {
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

/// State and cause in the last frame.
fn last(run: &Outcome) -> (Mode, Stop) {
    let frame = run.telemetry.frames.last().expect("frames");
    (frame.state, frame.cause)
}

/// What the log says last of the port's faults: errors and lost frames.
fn port_faults(run: &Outcome) -> Option<[u32; 2]> {
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

/// Every control task begins at the same time and wakes the processor as without what disturbs the port; the
/// codes are the same, and the longest is as long. A keep-alive may come a tick earlier.
///
/// The emulator takes an edge between two blocks of instructions, and events of the port shift their ends: an
/// edge at the instant of a reading may be counted a tick later. From there on the runs differ, by less than
/// half of what a fingertip notices.
fn leaves_control_as_it_is(run: &Outcome) {
    let healthy = free_air();
    let quiet = &healthy.ticks[..run.ticks.len()];
    assert!(quiet.len() > 4_900);
    for (k, (mine, other)) in run.ticks.iter().zip(quiet).enumerate() {
        let all = |tick: &ControlTick| (tick.at_ns, tick.asleep, tick.enabled);
        assert_eq!(all(mine), all(other), "tick {k}");
    }
    let mut pairs = run.ticks.iter().zip(quiet);
    let differ = pairs.position(|(mine, other)| mine.counts != other.counts);
    let (mine, other) = match differ {
        Some(k) => (&run.ticks[..k], &quiet[..k]),
        None => (&run.ticks[..], quiet),
    };
    for (k, (mine, other)) in mine.iter().zip(other).enumerate() {
        assert_eq!(mine.codes, other.codes, "tick {k}");
    }
    assert_eq!(longest(mine), longest(other));
    if let Some(k) = differ {
        let apart = (0..2).map(|n| {
            let [mine, other] = [&run.ticks[k], &quiet[k]].map(|tick| tick.counts[n]);
            mine.expect("a count").abs_diff(other.expect("a count"))
        });
        assert_eq!(apart.sum::<u16>(), 1, "tick {k}");
    }
    let diameter = Device::default().handle.diameter_m;
    let end = quiet.len() as f64 / RATE_HZ;
    let force = run.spurious_mn(healthy, 0.0, end, diameter);
    assert!(force < 5.0, "{force} mN");
}

/// Instructions of the longest control task.
fn longest(ticks: &[ControlTick]) -> Option<u32> {
    ticks.iter().map(|tick| tick.instructions).max()
}

#[test]
fn port_arms_selects_and_keeps_alive() {
    let run = run(&commanded_by_port(1.0, 1.0));
    assert_eq!(last(&run), (Mode::Running, Stop::None));
    assert_eq!(rejected(&run), None);
    assert_eq!(port_faults(&run), None, "{:?}", run.telemetry.log);
}

/// The scene is off after 0.5 s and the amplifiers are after 5 s.
#[test]
fn silence_of_the_port_ends_the_scene_and_then_the_arming() {
    let until = |seconds| run(&commanded_by_port(seconds, 0.31));
    assert_eq!(last(&until(0.79)), (Mode::Running, Stop::None));
    assert_eq!(last(&until(0.81)), (Mode::Armed, Stop::CommandTimeout));
    let disarmed = until(5.4);
    assert_eq!(last(&disarmed), (Mode::Boot, Stop::CommandTimeout));
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
    let telemetry = telemetry(&of_port(&run).0);
    // Side lines of the last one are on their way.
    let (_, mine) = telemetry.frames.split_last().expect("frames");
    assert!(mine.len() > 480, "{}", mine.len());
    let mut with_all = 0;
    for (mine, other) in mine.iter().zip(&run.telemetry.frames) {
        assert_eq!(mine, other);
        let lines = &mine.side_lines;
        with_all += u32::from(lines.edge.is_some() && lines.learned.is_some());
    }
    assert!(with_all > 0);
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

/// Random bytes as fast as the line is.
#[test]
fn flood_of_random_bytes_leaves_control_as_it_is() {
    let mut state = 1_u32;
    let random = std::iter::repeat_with(|| {
        state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        (state >> 24) as u8
    });
    // 0.4 s of 150 000 bytes a second.
    let flood = random.take(60_000).collect();
    let run = run(&Setup {
        seconds: 0.9,
        port: vec![(0.3, flood)],
        ..Setup::default()
    });
    leaves_control_as_it_is(&run);
    // A frame of random bytes is whole in one of 65 000 and hardly ever means something.
    let counts = rejected(&run).expect("counts");
    assert!(counts.garbage > 59_900, "{counts:?}");
}

/// Each byte with noise or a framing error is counted, and none delays a control task.
#[test]
fn noise_and_framing_errors_leave_control_as_it_is() {
    for errors in [
        LineErrors {
            noise: 300_000,
            framing: 300_000,
        },
        LineErrors::EVERY_BYTE,
    ] {
        let run = run(&Setup {
            seconds: 0.9,
            port: vec![(0.3, vec![0xA5; 30_000])],
            port_errors: vec![(0.3, errors)],
            ..Setup::default()
        });
        leaves_control_as_it_is(&run);
        let [found, lost] = port_faults(&run).expect("faults");
        // A look at each tick for 0.2 s.
        assert!((1_000..=2_010).contains(&found), "{errors:?}: {found}");
        assert_eq!(lost, 0);
    }
}

/// Commands once a millisecond, of which some arrive with framing errors, and halves of commands
/// between them: no other command is lost.
#[test]
fn only_broken_commands_are_lost() {
    let at = |k: u32| 0.2 + 1e-3 * f64::from(k);
    let commands = (0..100).map(|k| (at(k), frame(Command::Estimator(99))));
    let torn = (0..100).map(|k| (at(k) - 0.4e-3, frame(Command::Arm)[..6].to_vec()));
    let run = run(&Setup {
        seconds: 0.6,
        port: commands.chain(torn).collect(),
        // From before the torn command that precedes it, number 20 is broken, and so on up to 29.
        port_errors: vec![
            (at(20) - 0.5e-3, LineErrors::EVERY_BYTE),
            (at(30) - 0.5e-3, LineErrors::default()),
        ],
        ..Setup::default()
    });
    leaves_control_as_it_is(&run);
    let counts = rejected(&run).expect("counts");
    assert_eq!(counts.unknown, 90, "{counts:?}");
    assert_eq!(counts.garbage, 90 * 6 + 10 * 17, "{counts:?}");
}

/// A line that is shorted and comes back: the scene ends by the command timeout, and commands count
/// again afterwards.
#[test]
fn line_that_breaks_ends_the_scene_and_can_be_used_again() {
    let mut setup = commanded_by_port(1.4, 1.4);
    let again = (1.3, frame(Command::Scene(SceneKind::FreeAir)));
    setup.port.push(again);
    setup.port_errors = vec![
        (0.301, LineErrors::EVERY_BYTE),
        (1.201, LineErrors::default()),
    ];
    let run = run(&setup);
    let frames = run.telemetry.frames.iter();
    let off = frames
        .clone()
        .find(|frame| frame.cause == Stop::CommandTimeout);
    let off_s = f64::from(off.expect("a timeout").tick) * 1e-4;
    // The last command came at 0.3 s.
    assert!((0.79..0.82).contains(&off_s), "{off_s} s");
    assert_eq!(last(&run).0, Mode::Running);
}

/// DMA that stopped is started again, and the bytes after that are taken.
#[test]
fn stopped_reception_is_started_again() {
    let mut setup = commanded_by_port(1.0, 1.0);
    setup.accesses = vec![(0.32, CoreAccess::Store(RECEIVE_BUFFER, 0x2000_0000))];
    let run = run(&setup);
    assert_eq!(run.values, [0x2000_0000]);
    assert_eq!(last(&run), (Mode::Running, Stop::None));
    assert_eq!(port_faults(&run), Some([1, 0]));
}

/// A line that is too slow for telemetry: whole frames are lost and counted, the others arrive, and
/// control does not change.
#[test]
fn line_that_does_not_drain_loses_whole_frames() {
    let run = run(&Setup {
        seconds: 0.9,
        accesses: vec![
            (0.3, CoreAccess::Store(BAUD_DIVIDER, SLOW)),
            (0.5, CoreAccess::Store(BAUD_DIVIDER, 28)),
        ],
        ..Setup::default()
    });
    let (messages, garbage) = of_port(&run);
    let frames = telemetry(&messages).frames;
    assert!(garbage < 100, "{garbage}");
    let [errors, lost] = port_faults(&run).expect("faults");
    assert_eq!(errors, 0);
    let (first, last) = (frames[0].seq, frames[frames.len() - 1].seq);
    let missing = last - first + 1 - frames.len() as u32;
    assert!((100..300).contains(&missing), "{missing}");
    assert_eq!(missing, lost);
    leaves_control_as_it_is(&run);
}

/// Valid commands as fast as the line is: those of RTT are taken too.
#[test]
fn flood_of_commands_leaves_rtt_its_share() {
    let flood = frame(Command::KeepAlive).repeat(8_000);
    let run = run(&Setup {
        seconds: 0.8,
        commands: vec![
            (0.05, Command::Scene(SceneKind::FreeAir)),
            (0.3, Command::Arm),
            (0.5, Command::Disarm),
        ],
        port: vec![(0.2, flood)],
        ..Setup::default()
    });
    let on: Vec<_> = run.enables.iter().map(|(ns, on)| (*ns, on[0])).collect();
    let [(_, false), (armed, true), (disarmed, false)] = on[..] else {
        panic!("{on:?}");
    };
    // A poll of the probe, a full queue and a tick.
    for (at, from) in [(armed, 300_000_000), (disarmed, 500_000_000)] {
        assert!((from..from + 4_000_000).contains(&at), "{at} ns");
    }
}

/// Messages that a client reads until it has one of these.
fn read_until(client: &mut TcpStream, wanted: impl Fn(&Message) -> bool) -> Message {
    let mut parser = Parser::default();
    let mut found = None;
    let mut byte = [0];
    while found.is_none() {
        client.read_exact(&mut byte).expect("the run ended");
        parser.take(byte[0], |message| {
            found = Some(message).filter(|it| wanted(it)).or(found);
        });
    }
    found.expect("a message")
}

/// A client on TCP commands the board; a second one is told that there is one, and is served once the
/// first has gone.
#[test]
fn bridge_serves_one_client_after_the_other() {
    let bridge = Bridge::bind(0).unwrap();
    let address = bridge.address();
    assert!(address.ip().is_loopback());
    let setup = Setup {
        // Until the clients are through.
        seconds: 60.0,
        commands: Vec::new(),
        keep_alive: false,
        ..Setup::default()
    };
    let stop = Arc::new(AtomicBool::new(false));
    let until = Arc::clone(&stop);
    let image = image("");
    let runs = std::thread::spawn(move || bridge.run(image, &setup, until).unwrap());
    let is_frame = |mode| move |message: &Message| matches!(message, Message::Frame(frame) if frame.state == mode);
    let mut first = TcpStream::connect(address).unwrap();
    first.write_all(&IDENTIFY).unwrap();
    read_until(&mut first, |it| matches!(it, Message::Hello(_)));
    read_until(&mut first, |it| matches!(it, Message::Rejected(_)));
    let mut refusal = String::new();
    let mut second = TcpStream::connect(address).unwrap();
    second.read_to_string(&mut refusal).unwrap();
    assert!(refusal.starts_with("the board has a client"), "{refusal}");
    first.write_all(&frame(Command::Arm)).unwrap();
    read_until(&mut first, is_frame(Mode::Armed as u8));
    drop(first);
    // The bridge sees the end at its next look; until then it refuses.
    let mut third = loop {
        let mut client = TcpStream::connect(address).unwrap();
        let mut byte = [0];
        client.read_exact(&mut byte).unwrap();
        if byte != [refusal.as_bytes()[0]] {
            break client;
        }
    };
    third.write_all(&frame(Command::Disarm)).unwrap();
    read_until(&mut third, is_frame(Mode::Boot as u8));
    stop.store(true, Ordering::Relaxed);
    let (pace, _) = runs.join().unwrap();
    assert!(pace.seconds < 60.0, "{pace:?}");
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
