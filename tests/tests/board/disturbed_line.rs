//! A serial port whose line is disturbed, flooded or stopped.

use haptic_control::{Mode, SceneKind, Stop};
use object::{Object as _, ObjectSymbol as _};
use simulation::device::Device;
use virtual_board::command::Command;
use virtual_board::port::LineErrors;
use virtual_board::run::{ControlTick, CoreAccess, Outcome, RATE_HZ, Setup, on_board};

use crate::image::{end, free_air, image, run};
use crate::link::{commanded_by_port, frame, of_port, port_faults, rejected, telemetry};

/// Baud rate register of USART3; a rate so low that no frame of telemetry is sent in a run.
const BAUD_DIVIDER: u32 = 0x4000_4808;
const SLOW: u32 = 0xFFFF;
/// `DMA_S1M0AR`: buffer of the stream that receives. A write while the stream uses it stops it with a
/// transfer error (RM0090, 10.3.9).
const RECEIVE_BUFFER: u32 = 0x4002_6034;

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
        LineErrors {
            noise: 1_000_000,
            framing: 0,
        },
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

/// `USART3_CR3`, and the requests of DMA for what is sent and for what is received.
const REQUESTS: u32 = 0x4000_4814;
const TO_SEND: u32 = 1 << 7;
const RECEIVED: u32 = 1 << 6;

/// DMA that takes no byte for 10 ms of a flood: each look finds the overrun, and reception goes on afterwards.
#[test]
fn overrun_of_what_is_received_is_counted() {
    let mut setup = commanded_by_port(0.9, 0.9);
    setup.port.push((0.31, vec![0xA5; 3_000]));
    setup.accesses = vec![
        (0.315, CoreAccess::Store(REQUESTS, TO_SEND)),
        (0.325, CoreAccess::Store(REQUESTS, TO_SEND | RECEIVED)),
    ];
    let run = run(&setup);
    let [found, lost] = port_faults(&run).expect("faults");
    assert!((90..=110).contains(&found), "{found}");
    assert_eq!(lost, 0);
    assert_eq!(end(&run), (Mode::Running, Stop::None));
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
    assert_eq!(end(&run).0, Mode::Running);
}

/// DMA that stopped is started again, and the bytes after that are taken.
#[test]
fn stopped_reception_is_started_again() {
    let mut setup = commanded_by_port(1.0, 1.0);
    setup.accesses = vec![(0.32, CoreAccess::Store(RECEIVE_BUFFER, 0x2000_0000))];
    let run = run(&setup);
    assert_eq!(run.values, [0x2000_0000]);
    assert_eq!(end(&run), (Mode::Running, Stop::None));
    assert_eq!(port_faults(&run), Some([1, 0]));
}

/// The ring has bytes of before from end to end, which would be commands again.
#[test]
fn reception_that_is_started_again_takes_no_byte_twice() {
    let mut setup = commanded_by_port(0.9, 0.9);
    // 1100 bytes; the ring has 1024.
    let commands = frame(Command::Estimator(99)).repeat(100);
    setup.port.push((0.2, commands));
    // The second of both buffers, which are the same, is in use then.
    let stop = CoreAccess::Store(RECEIVE_BUFFER + 4, 0x2000_0000);
    setup.accesses = vec![(0.32, stop)];
    let run = run(&setup);
    assert_eq!(port_faults(&run), Some([1, 0]));
    let counts = rejected(&run).expect("counts");
    assert_eq!((counts.unknown, counts.garbage), (100, 0));
}

/// `DMA_S3PAR`: address to which the stream sends; the data register of USART3, and one without a register.
const SENDS_TO: u32 = 0x4002_6060;
const DATA: u32 = 0x4000_4804;
const NOTHING: u32 = 0x4000_8000;

/// DMA that stopped while it sent is started again.
#[test]
fn stopped_transmission_is_started_again() {
    let setup = Setup {
        seconds: 0.9,
        accesses: vec![
            (0.3, CoreAccess::Store(SENDS_TO, NOTHING)),
            (0.5, CoreAccess::Store(SENDS_TO, DATA)),
        ],
        ..Setup::default()
    };
    let run = on_board(image(""), &setup, |_| ()).expect("a run");
    let refused = |objection: &String| objection.contains("refused: 0x40008000");
    assert!(run.objections.iter().all(refused), "{:?}", run.objections);
    let [errors, _] = port_faults(&run).expect("faults");
    assert!(errors > 0);
    let (messages, _) = of_port(&run);
    let frames = telemetry(&messages).frames;
    let sent = frames.last().expect("frames").seq;
    let last = run.telemetry.frames.last().expect("frames").seq;
    assert!(sent + 2 > last, "{sent} of {last}");
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

/// When both amplifiers of a run are enabled and disabled again, ns: at 0.3 s and 0.5 s, but for a poll of the
/// probe, a full queue and a tick.
fn is_armed_and_disarmed_in_time(run: &Outcome) {
    let on: Vec<_> = run.enables.iter().map(|(ns, on)| (*ns, on[0])).collect();
    let [(_, false), (armed, true), (disarmed, false)] = on[..] else {
        panic!("{on:?}");
    };
    for (at, from) in [(armed, 300_000_000), (disarmed, 500_000_000)] {
        assert!((from..from + 4_000_000).contains(&at), "{at} ns");
    }
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
    is_armed_and_disarmed_in_time(&run);
}

/// Valid commands as fast as the probe is: those of the port are taken too.
#[test]
fn flood_of_commands_leaves_the_port_its_share() {
    let flood = frame(Command::KeepAlive).repeat(8_000);
    let run = run(&Setup {
        seconds: 0.8,
        commands: vec![(0.05, Command::Scene(SceneKind::FreeAir))],
        keep_alive: false,
        garbage: vec![(0.2, flood)],
        port: vec![(0.3, frame(Command::Arm)), (0.5, frame(Command::Disarm))],
        ..Setup::default()
    });
    is_armed_and_disarmed_in_time(&run);
}

/// The control block of RTT, and where the up channel, the one of the link and the down channel have the index
/// of their writer and that of their reader.
const CONTROL_BLOCK: &str = "_SEGGER_RTT";
const INDICES: [u32; 3] = [24 + 12, 48 + 12, 72 + 12];

/// A probe that has lost its connection writes indices that no ring has: control and port go on.
#[test]
fn indices_of_rtt_beyond_its_rings_leave_control_as_it_is() {
    let file = object::File::parse(image("").elf()).expect("an image");
    let block = file
        .symbols()
        .find(|symbol| symbol.name() == Ok(CONTROL_BLOCK))
        .expect("the control block");
    let block = u32::try_from(block.address()).expect("an address");
    let stores = INDICES.into_iter().flat_map(|at| [at, at + 4]).zip(0..);
    let accesses = stores.map(|(at, k)| {
        let store = CoreAccess::Store(block + at, u32::MAX - k);
        (0.2 + 1e-3 * f64::from(k), store)
    });
    let setup = Setup {
        accesses: accesses.collect(),
        ..commanded_by_port(0.5, 0.5)
    };
    let run = on_board(image(""), &setup, |_| ()).expect("a run");
    assert_eq!(run.restarts, []);
    let frames = telemetry(&of_port(&run).0).frames;
    let last = frames.last().expect("frames");
    assert!(last.tick > 4_900, "{}", last.tick);
    assert_eq!((last.state, last.cause), (Mode::Running, Stop::None));
    assert_eq!(last.overruns, 0);
}
