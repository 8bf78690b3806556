//! Settings: what a board without them refuses, and their way over the link.

use drivers::link::Message;
use drivers::{Command, Saved, Setting, Settings, encode};
use haptic_control::{Mode, Request, SceneKind, Stop};
use virtual_board::command::Command as Rtt;
use virtual_board::fault::Fault;
use virtual_board::flash::{Change, SECTOR};
use virtual_board::run::{Outcome, Setup};

use crate::image::{free_air, run, run_one};
use crate::link::of_port;

/// DAC codes of full scale.
const STEPS: u16 = 2047;
/// Code of zero current.
const MIDDLE: u16 = 2048;

/// A run whose port receives these commands, and a keep-alive every 50 ms.
pub(crate) fn commanded(seconds: f64, commands: &[(f64, Command)], setup: Setup) -> Outcome {
    let kept = (1..).map(|k| (0.05 * f64::from(k), Command::Request(Request::KeepAlive)));
    let kept = kept.take_while(|(at, _)| *at < seconds);
    let all = commands.iter().copied().chain(kept);
    let run = run(&Setup {
        seconds,
        commands: Vec::new(),
        keep_alive: false,
        port: all
            .map(|(at, command)| (at, encode(command).to_vec()))
            .collect(),
        ..setup
    });
    let last = run.telemetry.frames.last().expect("frames");
    assert_eq!(last.overruns, 0);
    run
}

/// Outcomes of the commands to store.
pub(crate) fn stored(run: &Outcome) -> Vec<Saved> {
    let (messages, _) = of_port(run);
    let outcomes = messages.iter().filter_map(|message| match message {
        Message::Stored(stored) => Saved::from_code(stored.outcome),
        _ => None,
    });
    outcomes.collect()
}

fn select(scene: SceneKind) -> Command {
    Command::Request(Request::Select(scene.number()))
}

pub(crate) const ARM: Command = Command::Request(Request::Arm);

/// The emulated amplifiers' full scales are the current limits of the device.
#[test]
fn board_before_its_bring_up_renders_no_closed_loop_and_has_a_tenth_of_the_current() {
    let commands = [
        (0.02, select(SceneKind::Wall)),
        (0.03, ARM),
        (0.10, select(SceneKind::FreeAir)),
        (0.15, select(SceneKind::Excite)),
        (4.50, Command::Identify),
    ];
    let blank = Setup {
        settings: None,
        ..Setup::default()
    };
    let run = commanded(4.6, &commands, blank);
    let mode_at = |tick: u32| {
        let frame = run.telemetry.frames.iter().find(|frame| frame.tick >= tick);
        frame.map(|frame| frame.state)
    };
    assert_eq!(mode_at(1000), Some(Mode::Armed));
    assert_eq!(mode_at(1400), Some(Mode::Armed));
    assert_eq!(mode_at(1700), Some(Mode::Running));
    let (messages, _) = of_port(&run);
    let refused = messages.iter().rev().find_map(|message| match message {
        Message::Rejected(counts) => Some(counts.unverified),
        _ => None,
    });
    assert_eq!(refused, Some(2));
    let steps = |channel: usize| {
        let codes = run.ticks.iter().filter_map(move |tick| tick.codes[channel]);
        codes.map(|code| code.abs_diff(MIDDLE)).max()
    };
    // After 3.9 s of strokes the excitation asks for 0.9 A, and has a tenth of 6 A.
    assert_eq!(steps(0), Some((STEPS + 5) / 10));
    assert!(steps(1).is_some_and(|most| most <= (STEPS + 5) / 10));
    let said = run.telemetry.log.join("\n");
    assert!(
        said.contains("no settings in flash") && said.contains("signs not verified"),
        "{said}"
    );
}

#[test]
fn settings_are_told_and_changed_over_the_link() {
    let mut stored = Settings::COMMISSIONED;
    assert!(stored.set(Setting::Serial, 77.0));
    let commands = [
        (0.05, Command::Settings),
        (
            0.10,
            Command::Set {
                setting: Setting::CurrentScale.number(),
                value: 0.25,
            },
        ),
        (0.15, Command::Settings),
    ];
    let setup = Setup {
        settings: Some(stored),
        ..Setup::default()
    };
    let run = commanded(0.2, &commands, setup);
    let (messages, _) = of_port(&run);
    let told: Vec<_> = messages
        .iter()
        .filter_map(|message| match message {
            Message::Setting(setting) => Some((setting.number, setting.value)),
            _ => None,
        })
        .collect();
    let mut changed = stored;
    assert!(changed.set(Setting::CurrentScale, 0.25));
    let expected = [stored, changed].map(|settings| {
        Setting::ALL
            .iter()
            .map(move |setting| (setting.number(), settings.get(*setting)))
    });
    assert_eq!(told, expected.into_iter().flatten().collect::<Vec<_>>());
}

/// In scene off, with the amplifiers enabled.
#[test]
fn zeros_of_the_dac_act_once_they_are_set() {
    let set = |setting: Setting, value| Command::Set {
        setting: setting.number(),
        value,
    };
    let commands = [
        (0.05, ARM),
        (0.10, set(Setting::ZeroLarge, 2061.0)),
        (0.15, set(Setting::ZeroSmall, 2035.0)),
    ];
    let run = commanded(0.2, &commands, Setup::default());
    let codes_at = |at_s: f64| {
        let mut ticks = run.ticks.iter();
        let tick = ticks.find(|tick| tick.at_ns as f64 * 1e-9 >= at_s);
        let tick = tick.expect("a tick");
        assert_eq!(tick.enabled, [true; 2], "{at_s} s");
        tick.codes
    };
    assert_eq!(codes_at(0.099), [Some(MIDDLE); 2]);
    assert_eq!(codes_at(0.149), [Some(2061), Some(MIDDLE)]);
    assert_eq!(codes_at(0.199), [Some(2061), Some(2035)]);
}

#[test]
fn settings_are_stored_at_rest_alone() {
    let outcomes =
        |commands: &[(f64, Command)]| stored(&commanded(0.8, commands, Setup::default()));
    let running = [
        (0.10, select(SceneKind::FreeAir)),
        (0.15, ARM),
        (0.1502, Command::Store),
        (0.30, Command::Store),
        (0.50, Command::Request(Request::Disarm)),
        (0.505, Command::Store),
    ];
    assert_eq!(outcomes(&running), [Saved::Enabled; 3]);
    let at_rest = [(0.10, Command::Store), (0.30, ARM), (0.60, Command::Store)];
    assert_eq!(outcomes(&at_rest), [Saved::Stored, Saved::Enabled]);
}

/// A sector of the size of sector 12 is erased for 0.4 s, and the settings are in sector 13 then.
#[test]
fn full_sector_is_erased_at_the_start_under_a_patient_watchdog() {
    // 64 records fill a sector, and the next one is in the other sector.
    let setup = |older_records| Setup {
        older_records,
        seconds: 1.0,
        ..Setup::default()
    };
    let run = run(&setup(64));
    let first = |run: &Outcome| run.ticks.first().expect("ticks").at_ns;
    let later_ms = (first(&run) - first(free_air())) as f64 / 1e6;
    assert!((200.0..900.0).contains(&later_ms), "{later_ms} ms");
    let last = run.telemetry.frames.last().expect("frames");
    assert_eq!((last.state, last.cause), (Mode::Running, Stop::None));
    assert_eq!(run.flash_changes, [Change::Erase { sector: 0 }]);
    let (erased, kept) = run.flash.bytes().split_at(SECTOR as usize);
    assert!(erased.iter().all(|byte| *byte == 0xFF) && kept[0] != 0xFF);
    assert_eq!(run.flash.settings(), Some(Settings::COMMISSIONED));
}

#[test]
fn watchdog_waits_28_ms_again_after_an_erasure() {
    const AT_S: f64 = 0.9;
    let run = run(&Setup {
        older_records: 64,
        seconds: 1.0,
        faults: vec![(AT_S, Fault::HungIdle)],
        ..Setup::default()
    });
    assert_eq!(run.flash_changes, [Change::Erase { sector: 0 }]);
    let [restart] = &run.restarts[..] else {
        panic!("{:?}", run.restarts)
    };
    // It was fed with the latest frame, up to 1 ms before the fault.
    let late_ms = 1e3 * (restart.at_s - AT_S);
    assert!((27.0..28.1).contains(&late_ms), "{late_ms} ms");
}

/// The stages, which limit the currents of other scenes, are not in this image. The strokes ask for 0.3 A and
/// 0.15 A, and have a hundredth of 6 A and 1.5 A.
#[test]
fn image_of_the_excitation_alone_has_the_limits_of_the_bench() {
    let mut settings = Settings::COMMISSIONED;
    assert!(settings.set(Setting::CurrentScale, 0.01));
    let run = run_one(
        SceneKind::Excite,
        &Setup {
            settings: Some(settings),
            ..Setup::playing(SceneKind::Excite, 1.0)
        },
    );
    for channel in 0..2 {
        let codes = run.ticks.iter().filter_map(|tick| tick.codes[channel]);
        let steps = codes.map(|code| code.abs_diff(MIDDLE)).max();
        assert_eq!(steps, Some((STEPS + 50) / 100), "{channel}");
    }
}

#[test]
fn image_of_the_torque_alone_begins_at_zero_whenever_it_is_switched_on() {
    let on = Rtt::Scene(SceneKind::Torque);
    let run = run_one(
        SceneKind::Torque,
        &Setup {
            seconds: 0.5,
            commands: vec![
                (0.05, on),
                (0.1, Rtt::Arm),
                (0.2, Rtt::Torque(0.003)),
                (0.3, Rtt::Scene(SceneKind::Off)),
                (0.4, on),
            ],
            ..Setup::default()
        },
    );
    let torque_at = |tick: u32| {
        let frame = run.telemetry.frames.iter().find(|frame| frame.tick >= tick);
        frame.expect("a frame").torque
    };
    assert_eq!([2900, 3900, 4900].map(torque_at), [0.003, 0.0, 0.0]);
}
