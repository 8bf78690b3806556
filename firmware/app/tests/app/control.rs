use core::f64::consts::TAU;

use drivers::{Command, Settings, encode};
use firmware_app::config::{AUTO_ARM, RATE_HZ};
use firmware_app::control::{Faults, Inputs, Message};
use firmware_app::scene::FIRST;
use haptic_control::{Mode, Request, Stop};

use crate::bench::{Bench, CALM, ZERO, messages, ticks};

#[test]
fn the_first_record_is_of_tick_0() {
    let mut bench = Bench::new();
    bench.step(&CALM);
    assert_eq!(bench.record().tick, 0);
    bench.run(41);
    assert_eq!(bench.record().tick, 41);
}

#[test]
fn record_has_the_sample_and_the_action_of_its_tick() {
    let mut bench = Bench::start(FIRST);
    bench.large = 1.0;
    let currents = bench.request(Request::KeepAlive).expect("enabled");
    let record = bench.record();
    assert_eq!(record.sample.count.0, 651); // 4096 / (2 pi), rounded down
    assert_eq!(record.action.currents, currents);
    assert_eq!(bench.control.applied(), currents);
}

#[test]
fn amplifiers_are_enabled_from_arm_to_disarm() {
    let mut bench = Bench::new();
    assert!(bench.step(&CALM).is_none());
    bench.request(Request::Select(FIRST));
    assert_eq!(bench.state(), (Mode::Boot, Stop::None));
    // 20 ms without a current first.
    for _ in 0..ticks(0.02) {
        assert_eq!(bench.request(Request::Arm), Some(ZERO));
        assert_eq!(bench.state().0, Mode::Settling);
    }
    assert!(bench.request(Request::KeepAlive).is_some());
    let running = if FIRST == 0 {
        Mode::Armed
    } else {
        Mode::Running
    };
    assert_eq!(bench.state(), (running, Stop::None));
    assert!(bench.request(Request::Disarm).is_none());
    assert_eq!(bench.state(), (Mode::Boot, Stop::None));
    assert_eq!(bench.control.applied(), ZERO);
}

/// Observers and telemetry take the currents of the latest tick for those that flow.
#[test]
fn a_tick_that_disables_reports_no_current() {
    for inputs in [
        Inputs {
            request: Some(Request::Disarm),
            ..CALM
        },
        Inputs {
            faults: Faults::INTERLOCK,
            ..CALM
        },
    ] {
        // The scene of an image of one, or free air.
        let mut bench = Bench::start(FIRST.max(1));
        while bench.handle < 0.15 {
            bench.handle += 4e-4;
            bench.request(Request::KeepAlive);
        }
        let is_off = cfg!(one_scene) && FIRST == 0;
        assert_eq!(bench.control.applied() == ZERO, is_off);
        assert_eq!(bench.step(&inputs), None);
        assert_eq!(bench.control.applied(), ZERO);
        assert_eq!(bench.record().action.currents, ZERO);
    }
}

#[test]
fn any_fault_disables_the_amplifiers_in_the_same_tick() {
    let calm = || Inputs { ..CALM };
    let faults = [
        (
            Inputs {
                faults: Faults::NOT_READY,
                ..calm()
            },
            Stop::AmplifierFault,
        ),
        (
            Inputs {
                faults: Faults::INTERLOCK,
                ..calm()
            },
            Stop::Interlock,
        ),
        (
            Inputs {
                faults: Faults::CLOCK,
                ..calm()
            },
            Stop::ClockFailure,
        ),
        (
            Inputs {
                missed: 4,
                ..calm()
            },
            Stop::TickOverrun,
        ),
    ];
    // At every phase of a tick, and whether the command channel is silent or not.
    for (inputs, cause) in faults {
        for wait in 1..=10 {
            for request in [None, Some(Request::KeepAlive)] {
                let mut bench = Bench::start(FIRST);
                bench.wait(wait);
                let inputs = Inputs { request, ..inputs };
                assert_eq!(bench.step(&inputs), None, "{cause:?}");
                assert_eq!(bench.state(), (Mode::Safe, cause));
            }
        }
    }
    // Fewer missed ticks do not.
    let mut bench = Bench::start(FIRST);
    assert!(
        bench
            .step(&Inputs {
                missed: 3,
                ..calm()
            })
            .is_some()
    );
    // A jump of the large encoder, which the monitor finds.
    let mut bench = Bench::start(FIRST);
    bench.large = 100.0;
    assert_eq!(bench.step(&CALM), None);
    assert_eq!(bench.state(), (Mode::Safe, Stop::Jump));
    // The monitor starts again where the encoder is now.
    bench.request(Request::Arm);
    bench.run(ticks(0.1));
    assert_eq!(bench.state().0, Mode::Armed);
}

/// As where the supply of an amplifier opens the interlock loop. The cause is the one from which the others may
/// follow.
#[test]
fn several_faults_in_a_tick_disable_the_amplifiers_too() {
    let [not_ready, interlock, clock] = [Faults::NOT_READY, Faults::INTERLOCK, Faults::CLOCK];
    for (present, cause) in [
        (&[not_ready, interlock][..], Stop::Interlock),
        (&[not_ready, clock], Stop::ClockFailure),
        (&[interlock, clock], Stop::ClockFailure),
        (&[not_ready, interlock, clock], Stop::ClockFailure),
    ] {
        let with = |faults: Faults, fault: &Faults| faults.with(*fault, true);
        let faults = present.iter().fold(Faults::NONE, with);
        // In whatever order they are found.
        assert_eq!(faults, present.iter().rev().fold(Faults::NONE, with));
        let mut bench = Bench::start(FIRST);
        assert_eq!(bench.step(&Inputs { faults, ..CALM }), None);
        assert_eq!(bench.state(), (Mode::Safe, cause));
    }
}

/// Switched off by its selection, or by a restart without another one.
#[test]
fn scene_that_is_off_commands_no_current() {
    for requests in [&[Request::Select(0)][..], &[Request::Disarm, Request::Arm]] {
        let mut bench = Bench::start(FIRST.max(1));
        for request in requests {
            bench.request(*request);
        }
        bench.run(ticks(0.05));
        assert_eq!(bench.state(), (Mode::Armed, Stop::None));
        while bench.handle < 0.15 {
            bench.handle += 4e-4;
            assert_eq!(bench.request(Request::KeepAlive), Some(ZERO));
        }
        assert_eq!(bench.record().estimation.number, None, "{requests:?}");
    }
}

#[test]
fn debug_settings_refuse_to_arm() {
    let mut bench = Bench::new();
    let inputs = Inputs {
        debugger: || true,
        request: Some(Request::Arm),
        ..CALM
    };
    assert_eq!(bench.step(&inputs), None);
    assert_eq!(bench.state(), (Mode::Safe, Stop::Debugger));
}

#[test]
fn reset_with_a_cause_starts_in_state_safe() {
    let mut bench = Bench::after(Stop::Watchdog, true);
    bench.wait(ticks(0.3));
    assert_eq!(bench.state(), (Mode::Safe, Stop::Watchdog));
}

#[test]
fn missed_ticks_add_up_to_overruns() {
    let mut bench = Bench::new();
    for missed in [0, 1, 0, 2] {
        bench.step(&Inputs { missed, ..CALM });
    }
    assert_eq!(bench.record().overruns, 3);
}

#[test]
fn scene_is_switched_off_after_half_a_second_without_commands_except_with_auto_arm() {
    if FIRST == 0 {
        return;
    }
    let mut bench = Bench::start(FIRST);
    bench.wait(ticks(0.5));
    assert_eq!(bench.state(), (Mode::Running, Stop::None));
    bench.wait(1);
    let silent = if AUTO_ARM {
        (Mode::Running, Stop::None)
    } else {
        (Mode::Armed, Stop::CommandTimeout)
    };
    assert_eq!(bench.state(), silent);
    // 5 s in all, then the amplifiers are disabled too.
    bench.wait(ticks(4.4));
    assert!(bench.state().0.is_enabled());
    bench.wait(ticks(0.2));
    assert_eq!(bench.state().0.is_enabled(), AUTO_ARM);
}

/// The supply's dips look like power-on where no brown-out reset is programmed.
#[test]
fn auto_arm_requires_brown_out_reset_and_verified_signs() {
    for (settings, brown_out_reset, reset, arms) in [
        (Settings::COMMISSIONED, true, Stop::None, AUTO_ARM),
        (Settings::COMMISSIONED, false, Stop::None, false),
        (Settings::COMMISSIONED, true, Stop::BrownOut, false),
        (Settings::DEFAULT, true, Stop::None, false),
    ] {
        let mut bench = Bench::with(&settings, reset, brown_out_reset);
        bench.wait(ticks(0.1));
        assert!(!bench.state().0.is_enabled());
        bench.wait(ticks(0.03));
        let (mode, cause) = bench.state();
        assert_eq!(mode.is_enabled(), arms, "{brown_out_reset} {reset:?}");
        assert_eq!(cause, reset);
        if arms && FIRST != 0 {
            assert_eq!(mode, Mode::Running);
        }
    }
}

#[test]
fn command_before_auto_arm_takes_over_but_a_keep_alive_does_not() {
    for command in [Request::KeepAlive, Request::Disarm, Request::Select(FIRST)] {
        let mut bench = Bench::new();
        bench.wait(ticks(0.05));
        bench.request(command);
        // In every tick: the request of an image that arms by itself comes before keep-alives.
        bench.run(ticks(0.1));
        let arms = AUTO_ARM && command == Request::KeepAlive;
        assert_eq!(bench.state().0.is_enabled(), arms, "{command:?}");
    }
}

#[test]
fn parameter_commands_take_effect_and_count_as_keep_alive() {
    let mut bench = Bench::new();
    let request = |message| bench.control.accept(message);
    let mut requests: Vec<_> = messages(&[
        encode(Command::Request(Request::Select(FIRST))),
        encode(Command::Request(Request::Disarm)),
    ])
    .into_iter()
    .map(Some)
    .map(request)
    .collect();
    requests.push(bench.control.accept(None));
    let [select, disarm] = [Request::Select(FIRST), Request::Disarm].map(Some);
    assert_eq!(requests, [select, disarm, None]);
    // Scene 4 is viscous and has a damping; torque is of scene 8.
    for command in [
        Command::Tune {
            scene: 4,
            parameter: 0,
            value: 1e-3,
        },
        Command::Torque(0.001),
        Command::Estimator(1),
    ] {
        for message in messages(&[encode(command)]) {
            let is_setting = matches!(message, Message::Tuned(_) | Message::Estimator(_));
            assert!(is_setting, "{command:?}");
            assert_eq!(
                bench.control.accept(Some(message)),
                Some(Request::KeepAlive)
            );
        }
    }
}

/// A handle at 29.5 rad/s, which the monitor stops at 30 rad/s, and a control task that misses two ticks in 50.
#[test]
fn missed_ticks_are_no_overspeed() {
    let mut bench = Bench::new();
    bench.request(Request::Arm);
    bench.run(ticks(0.03));
    let step = 29.5 / f64::from(RATE_HZ);
    for k in 0..ticks(0.1) {
        let missed = if k % 50 == 20 { 2 } else { 0 };
        bench.handle += step * f64::from(1 + missed);
        bench.step(&Inputs {
            missed,
            request: Some(Request::KeepAlive),
            ..CALM
        });
        assert_eq!(bench.state(), (Mode::Armed, Stop::None), "{k}");
    }
}

/// Whenever the device is armed, so that a slot never ends in a tick that makes a frame.
#[test]
fn slots_of_the_monitor_end_five_ticks_after_a_frame() {
    for wait in 0..10 {
        let mut bench = Bench::new();
        bench.wait(wait);
        bench.request(Request::Arm);
        bench.run(ticks(0.03));
        // 600 counts of the handle at once: more than the limit of a window, less than a jump.
        bench.handle += 0.03 * TAU;
        while bench.state().0 == Mode::Armed {
            bench.run(1);
        }
        assert_eq!(bench.state(), (Mode::Safe, Stop::HandleOverspeed));
        assert_eq!(bench.record().tick % 10, 5, "armed after {wait} ticks");
    }
}
