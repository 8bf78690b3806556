//! The trace of a run, and its replay on the core of another emulator.

use std::process::{Command, Output};

use experiments::closed_loop::Hand;
use haptic_control::SceneKind;
use terminal::checksum::sum;
use virtual_board::run::{ControlTick, Outcome, Setup};
use virtual_board::trace::{Kind, MAGIC};

use crate::image::{image, of_scene, run};

/// TIM5 is interrupt 50 (RM0090, vector table), after 16 exceptions of the core.
const CONTROL: u16 = 16 + 50;
/// Counters of TIM4 (large encoder) and TIM3; holding registers of both channels, right aligned.
const COUNTERS: [u32; 2] = [0x4000_0824, 0x4000_0424];
pub(crate) const HOLDING: [u32; 2] = [0x4000_7408, 0x4000_7414];

/// A record: kind, number of the exception, address, value, and where the record begins.
type Record = (u8, u16, u32, u32, usize);

/// The records of a trace.
pub(crate) fn records(trace: &[u8]) -> Vec<Record> {
    let word = |at: usize| u32::from_le_bytes(trace[at..at + 4].try_into().unwrap());
    let (mut records, mut at) = (Vec::new(), 24);
    while at < trace.len() {
        let (kind, number) = (
            trace[at],
            u16::from_le_bytes([trace[at + 2], trace[at + 3]]),
        );
        records.push((kind, number, word(at + 4), word(at + 8), at));
        let bytes = [Kind::Load, Kind::HostWrite, Kind::HostRead];
        let follow = bytes.iter().any(|with| *with as u8 == kind);
        at += 20 + if follow { word(at + 8) as usize } else { 0 };
    }
    assert_eq!(at, trace.len(), "the last record is complete");
    records
}

fn traced() -> (Setup, Outcome) {
    let setup = Setup {
        trace: true,
        ..of_scene(SceneKind::Wall, Hand::Pushing, 0.15)
    };
    let outcome = run(&setup);
    (setup, outcome)
}

#[test]
fn a_trace_holds_what_each_tick_read_and_wrote() {
    let (_, run) = traced();
    assert_eq!(run.trace[..16], MAGIC);
    assert_eq!(run.trace[16..24], sum(image("").elf()).to_le_bytes());
    let records = records(&run.trace);
    assert_eq!(records.last().map(|record| record.0), Some(Kind::End as u8));
    let entry = |record: &Record| record.0 == Kind::Entry as u8;
    assert!(records.iter().filter(|r| entry(r)).all(|r| r.1 == CONTROL));
    let calls: Vec<_> = records.split(entry).skip(1).collect();
    // A call may be running at the end.
    assert!(calls.len().abs_diff(run.ticks.len()) <= 1);
    assert!(run.ticks.len() > 1000, "{}", run.ticks.len());
    for (tick, call) in run.ticks.iter().zip(calls) {
        let ControlTick { counts, codes, .. } = tick;
        for n in [0, 1] {
            let of = |kind: Kind, address| move |r: &&Record| r.0 == kind as u8 && r.2 == address;
            let read = call.iter().find(of(Kind::Read, COUNTERS[n]));
            assert_eq!(read.map(|r| r.3 as u16), counts[n], "{tick:?}");
            let written = call.iter().rfind(of(Kind::Write, HOLDING[n]));
            assert_eq!(written.map(|r| r.3 as u16), codes[n], "{tick:?}");
        }
    }
}

#[test]
fn a_trace_changes_nothing() {
    let (setup, with) = traced();
    let without = run(&Setup {
        trace: false,
        ..setup
    });
    assert!(without.trace.is_empty());
    assert_eq!(with.ticks, without.ticks);
    assert_eq!(with.rtt, without.rtt);
}

fn python(arguments: &[&std::ffi::OsStr]) -> Option<Output> {
    Command::new("python3").args(arguments).output().ok()
}

/// Another emulator makes the same accesses; a changed store to the DAC is a difference, and so is
/// an image that is not the trace's.
#[test]
fn another_core_replays_the_trace() {
    let has = python(&["-c".as_ref(), "import unicorn".as_ref()]);
    if !has.is_some_and(|output| output.status.success()) {
        println!("SKIPPED: python3 has no module unicorn; see tests/second-core/README.md");
        return;
    }
    let (_, run) = traced();
    let folder = tempdir();
    let [elf, same, other] = ["elf", "same", "other"].map(|name| folder.join(name));
    std::fs::write(&elf, image("").elf()).unwrap();
    std::fs::write(&same, &run.trace).unwrap();
    let store = |r: &&Record| r.0 == Kind::Write as u8 && HOLDING.contains(&r.2);
    let records = records(&run.trace);
    let at = records.iter().rfind(store).expect("a store").4;
    let mut changed = run.trace.clone();
    changed[at + 8] ^= 1;
    std::fs::write(&other, changed).unwrap();
    let second = concat!(env!("CARGO_MANIFEST_DIR"), "/second-core/");
    let program = format!("{second}replay.py");
    let replay = |trace: &std::path::Path| {
        let output = python(&[program.as_ref(), elf.as_ref(), trace.as_ref()]).unwrap();
        let text = String::from_utf8_lossy(&[output.stdout, output.stderr].concat()).into_owned();
        (output.status.code(), text)
    };
    let (code, text) = replay(&same);
    assert_eq!(code, Some(0), "{text}");
    let stores = records.iter().filter(|r| r.0 == Kind::Write as u8);
    let stores = stores.filter(|r| (0x4000_7400..0x4000_7800).contains(&r.2));
    let counted = format!(" {} DAC stores, ", stores.count());
    assert!(text.contains(&counted), "{text}");
    let sent = run.rtt.len() + run.rtt_link.len();
    assert!(
        text.contains(&format!(" {sent} telemetry bytes, ")),
        "{text}"
    );
    let (code, text) = replay(&other);
    assert_eq!(code, Some(1), "{text}");
    assert!(text.contains("expected write of 0x400074"), "{text}");
    std::fs::write(&elf, b"another").unwrap();
    assert_eq!(replay(&same).0, Some(2));
    let own = python(&[
        "-m".as_ref(),
        "unittest".as_ref(),
        "discover".as_ref(),
        second.as_ref(),
    ]);
    let own = own.expect("python3");
    let text = String::from_utf8_lossy(&own.stderr);
    assert!(own.status.success() && text.contains("OK"), "{text}");
}

/// A folder of this test.
fn tempdir() -> std::path::PathBuf {
    let folder = std::path::Path::new(env!("CARGO_TARGET_TMPDIR")).join("second-core");
    std::fs::create_dir_all(&folder).unwrap();
    folder
}
