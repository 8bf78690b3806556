//! Settings: what commands change, and what the control task makes of them.

use drivers::{Command, Setting, Settings, encode};
use firmware_app::commands::{Asked, Channel, Commands, Messages, Rejected};
use firmware_app::config::DEVICE;
use firmware_app::control::{Inputs, Message};
use firmware_app::large::{Large, LargeEstimator as _};
use firmware_app::scene::{self, FIRST};
use haptic_control::{Mode, Request, SceneKind, Stop};

use crate::bench::{Bench, CALM, ticks};

/// The messages of these commands on a board with these settings, what they asked for, and the counts.
fn followed(settings: Settings, commands: &[Command]) -> (Vec<Message>, Asked, Rejected, Settings) {
    let mut queue = Messages::new();
    let (producer, mut consumer) = queue.split();
    let mut receiver = Commands::new(producer, settings);
    let mut messages = Vec::new();
    for command in commands {
        let mut bytes = encode(*command).into_iter();
        receiver.receive(Channel::Port, || bytes.next());
        messages.extend(core::iter::from_fn(|| consumer.dequeue()));
    }
    let (asked, rejected) = (receiver.asked(), receiver.rejected());
    (messages, asked, rejected, *receiver.settings())
}

fn set(setting: Setting, value: f32) -> Command {
    Command::Set {
        setting: setting.number(),
        value,
    }
}

#[test]
fn changed_settings_reach_the_control_task_whole() {
    let commands = [
        set(Setting::ZeroLarge, 2051.5),
        set(Setting::CurrentScale, 0.5),
    ];
    let (messages, asked, rejected, settings) = followed(Settings::DEFAULT, &commands);
    let mut expected = Settings::DEFAULT;
    assert!(expected.set(Setting::ZeroLarge, 2051.5) && expected.set(Setting::CurrentScale, 0.5));
    assert_eq!(settings, expected);
    let [Message::Settings(..), Message::Settings(last, request)] = messages[..] else {
        panic!("two messages");
    };
    assert_eq!((last, request), (expected, Request::KeepAlive));
    assert_eq!((asked, rejected), (Asked::default(), Rejected::default()));
}

#[test]
fn values_and_numbers_that_no_setting_has_are_counted_and_change_nothing() {
    let commands = [
        set(Setting::CurrentScale, 1.5),
        set(Setting::SignsVerified, 0.5),
        set(Setting::GainSmall, f32::NAN),
        Command::Set {
            setting: Setting::ALL.len() as u8,
            value: 1.0,
        },
    ];
    let (messages, _, rejected, settings) = followed(Settings::DEFAULT, &commands);
    assert!(messages.is_empty() && settings == Settings::DEFAULT);
    let expected = Rejected {
        not_finite: 1,
        out_of_bounds: 2,
        unknown: 1,
        ..Rejected::default()
    };
    assert_eq!(rejected, expected);
}

#[test]
fn settings_are_asked_for_and_stored_by_commands() {
    let asked = |command| followed(Settings::DEFAULT, &[command]).1;
    let settings = Asked {
        settings: true,
        ..Asked::default()
    };
    let store = Asked {
        store: true,
        ..Asked::default()
    };
    assert_eq!(asked(Command::Settings), settings);
    assert_eq!(asked(Command::Store), store);
}

#[test]
fn closed_loop_scenes_are_refused_until_the_signs_are_verified() {
    let select = |scene: u8| Command::Request(Request::Select(scene));
    for kind in SceneKind::ALL {
        if !scene::has(kind.number()) {
            continue;
        }
        let needs = kind.facts().needs;
        let is_open = !needs.continuous && !needs.transient;
        let (messages, _, rejected, _) = followed(Settings::DEFAULT, &[select(kind.number())]);
        assert_eq!(messages.len(), usize::from(is_open), "{kind}");
        assert_eq!(rejected.unverified, u32::from(!is_open), "{kind}");
        let verified = [set(Setting::SignsVerified, 1.0), select(kind.number())];
        let (messages, _, rejected, _) = followed(Settings::DEFAULT, &verified);
        assert_eq!(
            (messages.len(), rejected),
            (2, Rejected::default()),
            "{kind}"
        );
    }
    // Only these command no motor, or a fixed pattern.
    let open = SceneKind::ALL
        .into_iter()
        .filter(|kind| !kind.is_closed_loop());
    assert!(open.eq([SceneKind::Off, SceneKind::Excite]));
}

/// However the scene came to be on or chosen while the signs were verified.
#[test]
fn signs_that_are_no_longer_verified_switch_the_scene_off() {
    if FIRST == 0 {
        return;
    }
    let taken_back = |mut bench: Bench| {
        let commands = [set(Setting::SignsVerified, 0.0)];
        let (messages, ..) = followed(Settings::COMMISSIONED, &commands);
        for message in messages {
            let request = bench.control.accept(Some(message));
            bench.step(&Inputs { request, ..CALM });
        }
        bench
    };
    // Running.
    let running = Bench::start(FIRST);
    assert_eq!(running.state().0, Mode::Running);
    assert_eq!(taken_back(running).state(), (Mode::Armed, Stop::None));
    // Chosen before the device is armed, and while it settles.
    let mut chosen = Bench::new();
    chosen.request(Request::Select(FIRST));
    let mut settling = Bench::new();
    settling.request(Request::Arm);
    settling.request(Request::Select(FIRST));
    for (mut bench, arms) in [(taken_back(chosen), true), (taken_back(settling), false)] {
        if arms {
            bench.request(Request::Arm);
        }
        bench.run(ticks(0.03));
        assert_eq!(bench.state(), (Mode::Armed, Stop::None));
    }
    // Signs that were not verified before are no change.
    let commands = [set(Setting::SignsVerified, 0.0)];
    let (messages, ..) = followed(Settings::DEFAULT, &commands);
    let request = Bench::new().control.accept(messages.into_iter().next());
    assert_eq!(request, Some(Request::KeepAlive));
}

#[test]
fn requests_to_arm_are_noted_once() {
    let mut queue = Messages::new();
    let (producer, _consumer) = queue.split();
    let mut commands = Commands::new(producer, Settings::COMMISSIONED);
    for (request, arms) in [(Request::Disarm, false), (Request::Arm, true)] {
        let mut bytes = encode(Command::Request(request)).into_iter();
        commands.receive(Channel::Rtt, || bytes.next());
        assert_eq!([commands.take_arms(), commands.take_arms()], [arms, false]);
    }
}

/// The flash is not written while a request to arm waits, whatever came behind it.
#[test]
fn request_to_arm_is_noted_with_commands_behind_it_in_the_same_call() {
    let mut queue = Messages::new();
    let (producer, _consumer) = queue.split();
    let mut commands = Commands::new(producer, Settings::COMMISSIONED);
    let requests = [Request::Arm, Request::KeepAlive, Request::Disarm];
    let frames = requests.map(|request| encode(Command::Request(request)));
    let mut bytes = frames.concat().into_iter();
    commands.receive(Channel::Port, || bytes.next());
    assert_eq!(bytes.len(), 0);
    assert!(commands.take_arms());
}

/// Largest current of the large motor with the handle held away from where the scene began, A.
fn largest(mut bench: Bench) -> f32 {
    let mut largest = 0.0_f32;
    bench.request(Request::Select(FIRST));
    bench.request(Request::Arm);
    for k in 0..ticks(0.5) {
        bench.handle = if k < ticks(0.05) { 0.0 } else { 1.0 };
        bench.run(1);
        largest = largest.max(bench.control.applied().large.get().abs());
    }
    largest
}

#[test]
fn control_task_scales_its_currents_at_the_start_and_by_message() {
    let part = |scale| {
        let mut settings = Settings::COMMISSIONED;
        assert!(settings.set(Setting::CurrentScale, scale));
        settings
    };
    if !SceneKind::ALL[usize::from(FIRST)].facts().needs.continuous {
        return;
    }
    let whole = largest(Bench::new());
    let limit = 0.01 * DEVICE.large.current_limit as f32;
    assert!(whole > 1.1 * limit, "{whole} A");
    let started = largest(Bench::with(&part(0.01), Stop::None, true));
    assert!((started - limit).abs() < 1e-6, "{started} A");
    let mut bench = Bench::new();
    let message = Message::Settings(part(0.01), Request::KeepAlive);
    let request = bench.control.accept(Some(message));
    assert_eq!(request, Some(Request::KeepAlive));
    let changed = largest(bench);
    assert!((changed - limit).abs() < 1e-6, "{changed} A");
}

#[test]
fn control_task_keeps_its_currents_below_the_limit_of_the_bench() {
    if !SceneKind::ALL[usize::from(FIRST)].facts().needs.continuous {
        return;
    }
    let limit = 0.01 * DEVICE.large.current_limit as f32;
    let mut settings = Settings::COMMISSIONED;
    assert!(settings.set(Setting::LimitLarge, limit));
    let started = largest(Bench::with(&settings, Stop::None, true));
    assert_eq!(started, limit);
    let mut bench = Bench::new();
    let message = Message::Settings(settings, Request::KeepAlive);
    bench.control.accept(Some(message));
    assert_eq!(largest(bench), limit);
}

#[test]
fn estimator_of_the_settings_is_in_charge_after_a_start() {
    let needs = SceneKind::ALL[usize::from(FIRST)].facts().needs;
    for number in 0..3u8 {
        let mut settings = Settings::COMMISSIONED;
        assert!(settings.set(Setting::Estimator, f32::from(number)));
        let mut bench = Bench::with(&settings, Stop::None, true);
        bench.request(Request::Select(FIRST));
        bench.request(Request::Arm);
        bench.run(ticks(0.2));
        let expected = if Large::choice(number).is_some() {
            number
        } else {
            0
        };
        let found = bench.record().estimation.number;
        assert_eq!(found, needs.continuous.then_some(expected));
    }
}

/// As one that is switched off and on again: hold keeps another angle, and the angles of an image of one scene
/// are relative to the one at the selection.
#[test]
fn selection_of_the_scene_that_is_on_starts_it_again() {
    let kinds = [SceneKind::Wall, SceneKind::SpringDamper, SceneKind::Hold].map(SceneKind::number);
    for scene in kinds.into_iter().filter(|scene| scene::has(*scene)) {
        let torque_after = |selections: &[u8]| {
            let mut bench = Bench::start(scene);
            bench.handle = 0.15;
            bench.run(ticks(0.05));
            assert!(bench.torque_mnm() < -10.0, "{scene}");
            for selection in selections {
                bench.request(Request::Select(*selection));
                bench.run(ticks(0.05));
            }
            bench.torque_mnm()
        };
        let (again, anew) = (torque_after(&[scene]), torque_after(&[0, scene]));
        assert!((again - anew).abs() < 0.1, "{scene}: {again} {anew}");
    }
}
