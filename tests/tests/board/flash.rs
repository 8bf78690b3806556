//! Settings in the flash of the board: programmed and kept.

use drivers::link::Message;
use drivers::{Command, Saved, Setting, Settings};
use virtual_board::fault::Fault;
use virtual_board::run::{Outcome, Setup};

use crate::link::of_port;
use crate::settings::{commanded, stored};

/// Bytes of a record: its number, the settings, the checksum.
const RECORD: usize = 256;

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
