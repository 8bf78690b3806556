//! Settings in the flash of the board: programmed and kept.

use drivers::link::Message;
use drivers::{Command, Saved, Setting, Settings};
use haptic_control::Stop;
use virtual_board::fault::Fault;
use virtual_board::run::{ControlTick, Outcome, Setup};

use crate::link::of_port;
use crate::settings::{commanded, stored};

/// Bytes of a record: its number, the settings, the checksum.
const RECORD: usize = 256;
/// Period of the control tick, ns.
const TICK_NS: u64 = 100_000;

fn serial(value: f32) -> Command {
    Command::Set {
        setting: Setting::Serial.number(),
        value,
    }
}

/// A commissioned board with a serial number.
fn numbered(serial: f32) -> Settings {
    let mut settings = Settings::COMMISSIONED;
    assert!(settings.set(Setting::Serial, serial));
    settings
}

/// The settings that the board told last.
fn told(run: &Outcome) -> Settings {
    let mut settings = Settings::DEFAULT;
    let (messages, _) = of_port(run);
    let mut count = 0;
    for message in messages {
        if let Message::Setting(told) = message {
            let setting = Setting::from_number(told.number).expect("a setting");
            assert!(settings.set(setting, told.value), "{setting:?}");
            count += 1;
        }
    }
    assert!(count >= Setting::ALL.len(), "{count} settings told");
    settings
}

#[test]
fn stored_settings_are_there_after_a_reset_and_in_the_next_run() {
    let commands = [
        (0.05, serial(77.0)),
        (0.10, Command::Store),
        // Not stored.
        (0.15, serial(78.0)),
        (0.45, Command::Settings),
    ];
    let run = commanded(
        0.6,
        &commands,
        Setup {
            faults: vec![(0.2, Fault::BrownOut)],
            ..Setup::default()
        },
    );
    assert_eq!((stored(&run), run.restarts.len()), (vec![Saved::Stored], 1));
    assert_eq!(told(&run), numbered(77.0));
    assert_eq!(run.flash.settings(), Some(numbered(77.0)));
    assert_eq!(run.flash_changes.len(), RECORD);
    let next = commanded(
        0.1,
        &[(0.05, Command::Settings)],
        Setup {
            flash: Some(run.flash),
            ..Setup::default()
        },
    );
    assert_eq!(told(&next), numbered(77.0));
}

/// Largest delay of a tick after the period of the ticks, ns, and largest number of instructions.
fn worst(ticks: &[ControlTick]) -> (u64, u32) {
    let first = ticks[0].at_ns;
    let late = ticks.iter().zip(0..).map(|(tick, k)| {
        let due = first + TICK_NS * k;
        tick.at_ns.abs_diff(due)
    });
    let instructions = ticks.iter().map(|tick| tick.instructions);
    (late.max().unwrap_or(0), instructions.max().unwrap_or(0))
}

/// A byte takes 16 us; a core that waits for the flash on the bus would begin a tick as late.
#[test]
fn store_does_not_delay_the_control_tick() {
    let run = |last| {
        let commands = [(0.05, serial(77.0)), (0.10, last)];
        commanded(0.2, &commands, Setup::default())
    };
    let (without, with) = (run(Command::Settings), run(Command::Store));
    assert_eq!(stored(&with), [Saved::Stored]);
    let last = with.telemetry.frames.last().expect("frames");
    assert_eq!((last.overruns, last.cause), (0, Stop::None));
    assert_eq!(with.ticks.len(), without.ticks.len());
    let (worst_with, worst_without) = (worst(&with.ticks), worst(&without.ticks));
    println!("with a store {worst_with:?}, without {worst_without:?}: ns late, instructions");
    // An interrupt waits for the instructions of a critical section at most.
    assert!(worst_with.0 <= worst_without.0 + 500);
    assert!(worst_with.1 <= worst_without.1);
}
