//! The safety state machine.

use haptic_control::{Cause, Findings, Mode, Order, Request, Safety, SafetyState, Stop};

const SAFETY: Safety = Safety {
    silence: Some(100),
    missed: 4,
    scenes: 8,
};
const WELL: Findings = Findings::WELL;

fn tick(state: &mut SafetyState, findings: Findings, request: Option<Request>) -> Order {
    SAFETY.tick(state, &findings, request)
}

fn armed() -> SafetyState {
    let mut state = SAFETY.start(Stop::None);
    let armed = tick(&mut state, WELL, Some(Request::Arm));
    assert!(armed.enable && armed.restart && state.mode() == Mode::Armed);
    state
}

fn running() -> SafetyState {
    let mut state = armed();
    let on = tick(&mut state, WELL, Some(Request::Select(2)));
    assert_eq!((on.enable, on.restart, on.select), (true, false, Some(2)));
    assert_eq!(state.mode(), Mode::Running);
    state
}

fn wrongs() -> [(Findings, Stop); 9] {
    let of = |cause| Findings {
        monitor: Some(cause),
        ..WELL
    };
    [
        (of(Cause::HandleOverspeed), Stop::HandleOverspeed),
        (of(Cause::LargeOverspeed), Stop::LargeOverspeed),
        (of(Cause::Jump), Stop::Jump),
        (of(Cause::NotMoving), Stop::NotMoving),
        (of(Cause::Against), Stop::Against),
        (
            Findings {
                amplifier_fault: true,
                ..WELL
            },
            Stop::AmplifierFault,
        ),
        (
            Findings {
                clock_failure: true,
                ..WELL
            },
            Stop::ClockFailure,
        ),
        (
            Findings {
                finite: false,
                ..WELL
            },
            Stop::NonFinite,
        ),
        (Findings { missed: 4, ..WELL }, Stop::TickOverrun),
    ]
}

#[test]
fn every_cause_disables_in_its_tick_and_stays_until_rearmed() {
    for (findings, stop) in wrongs() {
        let mut state = running();
        let order = tick(&mut state, findings, None);
        assert_eq!(
            order,
            Order {
                enable: false,
                restart: true,
                select: None
            }
        );
        for request in [None, Some(Request::Select(1)), Some(Request::KeepAlive)] {
            assert!(!tick(&mut state, WELL, request).enable);
            assert_eq!((state.mode(), state.stop()), (Mode::Safe, stop));
        }
        assert!(tick(&mut state, WELL, Some(Request::Arm)).enable);
        assert_eq!((state.mode(), state.stop()), (Mode::Armed, Stop::None));
    }
}

#[test]
fn a_cause_comes_before_a_request_of_the_same_tick() {
    for (findings, stop) in wrongs() {
        for request in [Request::Select(1), Request::Disarm, Request::Arm] {
            let mut state = running();
            assert!(!tick(&mut state, findings, Some(request)).enable);
            assert_eq!(state.stop(), stop);
        }
    }
}

#[test]
fn arming_is_refused_while_an_amplifier_or_the_clock_is_faulty() {
    for (findings, stop) in [wrongs()[5], wrongs()[6]] {
        let mut state = SAFETY.start(Stop::None);
        assert!(!tick(&mut state, findings, Some(Request::Arm)).enable);
        assert_eq!((state.mode(), state.stop()), (Mode::Safe, stop));
    }
}

#[test]
fn debug_settings_refuse_arming_and_do_not_stop_an_armed_device() {
    let debugger = Findings {
        debugger: true,
        ..WELL
    };
    for reset in [Stop::None, Stop::Watchdog] {
        for scene in [0, 2] {
            let mut state = SAFETY.start(reset);
            tick(&mut state, debugger, Some(Request::Select(scene)));
            let order = tick(&mut state, debugger, Some(Request::Arm));
            assert_eq!((order.enable, order.select), (false, None));
            assert_eq!((state.mode(), state.stop()), (Mode::Safe, Stop::Debugger));
            // Once the settings are cleared, the device can be armed.
            assert!(tick(&mut state, WELL, Some(Request::Arm)).enable);
            assert_eq!((state.mode(), state.stop()), (Mode::Armed, Stop::None));
        }
    }
    for mut state in [armed(), running()] {
        let before = state.mode();
        assert!(tick(&mut state, debugger, None).enable);
        assert_eq!((state.mode(), state.stop()), (before, Stop::None));
    }
    // A fault of the hardware is reported first.
    for (findings, stop) in [wrongs()[5], wrongs()[6]] {
        let mut state = SAFETY.start(Stop::None);
        let both = Findings {
            debugger: true,
            ..findings
        };
        tick(&mut state, both, Some(Request::Arm));
        assert_eq!(state.stop(), stop);
    }
}

#[test]
fn a_reset_with_a_cause_boots_safe() {
    for stop in [
        Stop::Watchdog,
        Stop::BrownOut,
        Stop::ClockFailure,
        Stop::Panic,
        Stop::HardFault,
    ] {
        let mut state = SAFETY.start(stop);
        assert!(!tick(&mut state, WELL, None).enable);
        assert_eq!((state.mode(), state.stop()), (Mode::Safe, stop));
        tick(&mut state, WELL, Some(Request::Disarm));
        assert_eq!((state.mode(), state.stop()), (Mode::Boot, Stop::None));
    }
}

#[test]
fn a_scene_chosen_in_boot_comes_on_with_arm_and_is_forgotten_by_a_stop() {
    let mut state = SAFETY.start(Stop::None);
    assert!(!tick(&mut state, WELL, Some(Request::Select(3))).enable);
    let order = tick(&mut state, WELL, Some(Request::Arm));
    assert_eq!(
        (order.enable, order.restart, order.select),
        (true, true, Some(3))
    );
    assert_eq!(state.mode(), Mode::Running);
    tick(&mut state, wrongs()[0].0, None);
    let order = tick(&mut state, WELL, Some(Request::Arm));
    assert_eq!((order.enable, order.select), (true, None));
    assert_eq!(state.mode(), Mode::Armed);
}

#[test]
fn silence_puts_the_scene_off_and_a_scene_puts_it_on_again() {
    let mut state = running();
    for _ in 0..100 {
        assert_eq!(tick(&mut state, WELL, None).select, None);
    }
    let order = tick(&mut state, WELL, None);
    assert_eq!((order.enable, order.select), (true, Some(0)));
    assert_eq!(
        (state.mode(), state.stop()),
        (Mode::Armed, Stop::CommandTimeout)
    );
    tick(&mut state, WELL, Some(Request::Select(1)));
    assert_eq!((state.mode(), state.stop()), (Mode::Running, Stop::None));
}

#[test]
fn keep_alive_keeps_the_scene_on() {
    let mut state = running();
    for k in 0..1000 {
        tick(
            &mut state,
            WELL,
            (k % 100 == 0).then_some(Request::KeepAlive),
        );
    }
    assert_eq!(state.mode(), Mode::Running);
}

#[test]
fn rare_missed_ticks_are_forgiven_and_frequent_ones_are_not() {
    for (every, mode) in [(17, Mode::Running), (8, Mode::Safe)] {
        let mut state = running();
        for k in 1..1000 {
            let missed = u32::from(k % every == 0);
            tick(
                &mut state,
                Findings { missed, ..WELL },
                Some(Request::KeepAlive),
            );
        }
        assert_eq!(state.mode(), mode, "one in {every}");
    }
}

#[test]
fn codes_come_back() {
    for code in 0..=15 {
        assert_eq!(Stop::from_code(code).map(|stop| stop as u8), Some(code));
    }
    assert_eq!(Stop::from_code(16), None);
}

/// From every mode, whatever is found and asked: enabled means armed or running, only `Arm` gets
/// there from the others, safe has a cause, and an order to select goes to what is enabled.
#[test]
fn only_arm_enables() {
    let modes = [
        SAFETY.start(Stop::None),
        SAFETY.start(Stop::Panic),
        armed(),
        running(),
    ];
    let mut found = vec![WELL];
    found.extend(wrongs().map(|(findings, _)| findings));
    let mut asked = vec![
        None,
        Some(Request::Arm),
        Some(Request::Disarm),
        Some(Request::KeepAlive),
    ];
    asked.extend((0..=u8::MAX).map(|scene| Some(Request::Select(scene))));
    for before in modes {
        for &findings in &found {
            for &request in &asked {
                let mut state = before;
                let order = tick(&mut state, findings, request);
                let is_on = |mode| matches!(mode, Mode::Armed | Mode::Running);
                assert_eq!(order.enable, is_on(state.mode()));
                assert!(!order.enable || is_on(before.mode()) || request == Some(Request::Arm));
                assert!(state.mode() != Mode::Safe || state.stop() != Stop::None);
                assert!(order.select.is_none_or(|scene| scene < 8 && order.enable));
                assert!(!is_on(before.mode()) || findings == WELL || state.mode() == Mode::Safe);
            }
        }
    }
}
