//! Settings in the flash of the board: programmed, kept, and interrupted by a loss of power.

use drivers::link::Message;
use drivers::{Command, Saved, Setting, Settings};
use haptic_control::Stop;
use virtual_board::fault::Fault;
use virtual_board::flash::{Change, FlashTimes, Sectors};
use virtual_board::run::{ControlTick, CoreAccess, Outcome, Setup};
use virtual_board::trace::Kind;

use crate::link::of_port;
use crate::second_core::records;
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

/// A board whose flash takes the longest times of the data sheet.
fn slow(setup: Setup) -> Setup {
    Setup {
        flash_times: FlashTimes::LONGEST,
        ..setup
    }
}

/// 256 bytes take 26 ms, and the watchdog waits 19 ms at the highest frequency of its oscillator.
#[test]
fn store_in_a_slow_flash_does_not_outlast_a_fast_watchdog() {
    for oscillator in [None, Some(Fault::FastWatchdog), Some(Fault::SlowWatchdog)] {
        let run = commanded(
            0.2,
            &[(0.05, serial(77.0)), (0.10, Command::Store)],
            slow(Setup {
                faults: oscillator.map(|fault| (0.0, fault)).into_iter().collect(),
                ..Setup::default()
            }),
        );
        assert_eq!(stored(&run), [Saved::Stored], "{oscillator:?}");
        assert!(
            run.restarts.is_empty(),
            "{oscillator:?}: {:?}",
            run.restarts
        );
        assert_eq!(run.flash.settings(), Some(numbered(77.0)));
        // No frame is lost meanwhile, at the debug probe or at the port.
        let sequence = run.telemetry.frames.iter().map(|frame| frame.seq);
        assert!(sequence.eq(0..run.telemetry.frames.len() as u32));
    }
}

/// The watchdog is fed for the frames of the control task alone.
#[test]
fn store_does_not_hide_a_dead_control_task() {
    const AT_S: f64 = 0.105;
    let run = commanded(
        0.3,
        &[(0.05, serial(77.0)), (0.10, Command::Store)],
        slow(Setup {
            faults: vec![(AT_S, Fault::HungControl)],
            ..Setup::default()
        }),
    );
    let [restart] = &run.restarts[..] else {
        panic!("{:?}", run.restarts)
    };
    // The latest frame came up to 1 ms before the fault.
    let late_ms = 1e3 * (restart.at_s - AT_S);
    assert!((26.9..28.1).contains(&late_ms), "{late_ms} ms");
}

/// Twice the longest time of an erasure, by an oscillator that is 1.5 times as fast.
#[test]
fn slow_erasure_is_shorter_than_the_patience_of_a_fast_watchdog() {
    let run = commanded(
        1.2,
        &[(1.1, Command::Settings)],
        slow(Setup {
            faults: vec![(0.0, Fault::FastWatchdog)],
            older_records: 64,
            ..Setup::default()
        }),
    );
    assert!(run.restarts.is_empty(), "{:?}", run.restarts);
    assert_eq!(run.flash_changes, [Change::Erase { sector: 0 }]);
    let first_s = run.ticks.first().expect("ticks").at_ns as f64 * 1e-9;
    assert!((0.8..0.95).contains(&first_s), "{first_s} s");
}

/// `FLASH_ACR`, and the enables of prefetch and both caches in it.
const ACCESS_CONTROL: u32 = 0x4002_3C00;
const CACHES: u32 = 0b111 << 8;

#[test]
fn store_leaves_the_caches_of_the_flash_on() {
    let load = CoreAccess::Load(ACCESS_CONTROL);
    let run = commanded(
        0.2,
        &[(0.05, serial(77.0)), (0.10, Command::Store)],
        Setup {
            accesses: vec![(0.09, load), (0.19, load)],
            ..Setup::default()
        },
    );
    assert_eq!(stored(&run), [Saved::Stored]);
    let [before, after] = run.values[..] else {
        panic!("{:?}", run.values)
    };
    assert_eq!((before & CACHES, after), (CACHES, before));
}

/// The data cache would keep bytes of before. It is reset while it is off, and on again afterwards (RM0090,
/// `DCRST` of `FLASH_ACR`).
#[test]
fn store_resets_the_data_cache() {
    let run = commanded(
        0.2,
        &[(0.05, serial(77.0)), (0.10, Command::Store)],
        Setup {
            trace: true,
            ..Setup::default()
        },
    );
    assert_eq!(stored(&run), [Saved::Stored]);
    let writes = records(&run.trace).into_iter();
    let cache: Vec<_> = writes
        .filter(|(kind, _, address, ..)| *kind == Kind::Write as u8 && *address == ACCESS_CONTROL)
        .map(|(_, _, _, value, _)| (value >> 10 & 1, value >> 12 & 1))
        .collect();
    let [.., off, reset, done, on] = cache[..] else {
        panic!("{cache:?}")
    };
    // Its enable and its reset.
    assert_eq!([off, reset, done, on], [(0, 0), (0, 1), (0, 0), (1, 0)]);
}

/// A part of what a byte or a sector passes through while its bits change.
type Noise = fn(&mut u32) -> u8;

/// The next state of a linear congruential generator; its upper byte.
fn random(state: &mut u32) -> u8 {
    *state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
    (*state >> 24) as u8
}

/// The content after a loss of power in the change behind the first `complete` ones. Of the bits that the
/// change would have changed, those of the noise have.
fn interrupted(before: &Sectors, changes: &[Change], complete: usize, noise: Noise) -> Sectors {
    let mut sectors = before.clone();
    for change in &changes[..complete] {
        sectors.apply(*change);
    }
    let Some(change) = changes.get(complete) else {
        return sectors;
    };
    let mut after = sectors.clone();
    after.apply(*change);
    let mut state = complete as u32;
    for at in change.range() {
        let changing = sectors.bytes()[at] ^ after.bytes()[at];
        sectors.bytes_mut()[at] ^= changing & noise(&mut state);
    }
    sectors
}

const NONE: Noise = |_| 0;
const SOME: Noise = random;

/// Starts a board with this content, and stores settings of another number: the settings at the start, and
/// those in flash at the end.
fn restarted(flash: Sectors, seconds: f64) -> (Settings, Option<Settings>) {
    let commands = [
        (seconds - 0.15, Command::Settings),
        (seconds - 0.12, serial(3.0)),
        (seconds - 0.10, Command::Store),
    ];
    let setup = Setup {
        flash: Some(flash),
        ..Setup::default()
    };
    let run = commanded(seconds, &commands, setup);
    assert_eq!(stored(&run), [Saved::Stored]);
    (told(&run), run.flash.settings())
}

/// What the firmware changes in flash to store the number 2 in the place of 1.
fn stored_once() -> (Sectors, Vec<Change>) {
    let before = Sectors::with(&numbered(1.0), 1).expect("settings");
    let setup = Setup {
        flash: Some(before.clone()),
        ..Setup::default()
    };
    let commands = [(0.05, serial(2.0)), (0.06, Command::Store)];
    let run = commanded(0.1, &commands, setup);
    assert_eq!(run.flash.settings(), Some(numbered(2.0)));
    assert_eq!(run.flash_changes.len(), RECORD);
    (before, run.flash_changes)
}

/// Bytes after which the power is lost on the emulated board: every 32nd, and the ends of the record's parts:
/// number, settings, checksum.
fn cuts() -> impl Iterator<Item = usize> {
    const ENDS: [usize; 8] = [1, 3, 4, 8, 251, 252, 253, 255];
    let every = (0..=RECORD).step_by(32);
    every.chain(ENDS)
}

#[test]
fn loss_of_power_while_settings_are_stored_leaves_the_old_or_the_new_ones() {
    let (before, changes) = stored_once();
    for cut in cuts() {
        let flash = interrupted(&before, &changes, cut, SOME);
        let [old, new] = [1.0, 2.0].map(numbered);
        let (at_start, at_end) = restarted(flash, 0.2);
        assert!(at_start == old || at_start == new, "{cut}: {at_start:?}");
        assert!((at_start == new) == (cut == RECORD), "{cut}");
        assert_eq!(at_end, Some(numbered(3.0)), "{cut}");
    }
}

/// As above at every byte, with the store of the drivers on the host.
#[test]
fn loss_of_power_at_every_byte_leaves_the_old_or_the_new_settings() {
    let (before, changes) = stored_once();
    let [old, new, later] = [1.0, 2.0, 3.0].map(numbered);
    for cut in 0..=changes.len() {
        for noise in [NONE, SOME] {
            let mut flash = interrupted(&before, &changes, cut, noise);
            let found = flash.settings().expect("settings");
            assert!(found == old || found == new, "{cut}: {found:?}");
            flash.store(&later).expect("room");
            assert_eq!(flash.settings(), Some(later), "{cut}");
        }
    }
}

#[test]
fn loss_of_power_while_a_full_sector_is_erased_keeps_the_settings() {
    // 64 records fill sector 12; the settings are in sector 13.
    let before = Sectors::with(&numbered(1.0), 64).expect("settings");
    let erasure = [Change::Erase { sector: 0 }];
    for seed in 0..64 {
        let mut flash = interrupted(&before, &erasure, 0, NONE);
        let mut state = seed;
        for byte in &mut flash.bytes_mut()[erasure[0].range()] {
            // Bits that are set already, or anything.
            let noise = random(&mut state);
            *byte = if seed % 2 == 0 { *byte | noise } else { noise };
        }
        assert_eq!(flash.settings(), Some(numbered(1.0)), "{seed}");
        if seed < 2 {
            let (at_start, at_end) = restarted(flash, 0.7);
            assert_eq!(at_start, numbered(1.0));
            assert_eq!(at_end, Some(numbered(3.0)));
        }
    }
}
