//! The safety state machine: what each mode does with findings. What it does with requests is in `safety_requests`.

use haptic_control::{Mode, Order, Request, Safety, SafetyState, Stop, SupplyFinding};

pub(crate) const SAFETY: Safety = Safety {
    settle: 0,
    silence: Some(100),
    disarm: Some(300),
    missed: 4,
    scenes: 8,
};
pub(crate) const WELL: Findings = Findings::well(Outside(false));

/// The order that disables the amplifiers and restarts the control.
pub(crate) const RESTARTED: Order = Order {
    enable: false,
    restart: true,
    select: None,
};

/// Findings of a device that measures its supply.
pub(crate) type Findings = haptic_control::Findings<Outside>;

/// Whether the supply is outside of its range.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Outside(bool);

impl SupplyFinding for Outside {
    fn is_outside(&self) -> bool {
        self.0
    }
}

pub(crate) fn tick(state: &mut SafetyState, findings: Findings, request: Option<Request>) -> Order {
    SAFETY.tick(state, &findings, request)
}

pub(crate) fn armed() -> SafetyState {
    let mut state = SAFETY.start(Stop::None);
    let armed = tick(&mut state, WELL, Some(Request::Arm));
    assert!(armed.enable && armed.restart && state.mode() == Mode::Armed);
    state
}

pub(crate) fn running() -> SafetyState {
    let mut state = armed();
    let on = tick(&mut state, WELL, Some(Request::Select(2)));
    assert_eq!((on.enable, on.restart, on.select), (true, false, Some(2)));
    assert_eq!(state.mode(), Mode::Running);
    state
}

/// With 3 ticks of settling, one of which is over.
const SLOW: Safety = Safety {
    settle: 3,
    ..SAFETY
};

pub(crate) fn settling() -> SafetyState {
    let mut state = SLOW.start(Stop::None);
    SLOW.tick(&mut state, &WELL, Some(Request::Arm));
    SLOW.tick(&mut state, &WELL, Some(Request::Select(2)));
    assert_eq!(state.mode(), Mode::Settling);
    state
}

/// Causes of a stop in order of their priority.
fn wrongs() -> [(Findings, Stop); 12] {
    let of = |cause| Findings {
        monitor: Some(cause),
        ..WELL
    };
    [
        (
            Findings {
                clock_failure: true,
                ..WELL
            },
            Stop::ClockFailure,
        ),
        (
            Findings {
                supply: Outside(true),
                ..WELL
            },
            Stop::Supply,
        ),
        (
            Findings {
                interlock: true,
                ..WELL
            },
            Stop::Interlock,
        ),
        (Findings { missed: 4, ..WELL }, Stop::TickOverrun),
        (NOT_READY, Stop::AmplifierFault),
        (of(Stop::HandleOverspeed), Stop::HandleOverspeed),
        (of(Stop::LargeOverspeed), Stop::LargeOverspeed),
        (of(Stop::Jump), Stop::Jump),
        (of(Stop::Stall), Stop::Stall),
        (of(Stop::RunawayDirection), Stop::RunawayDirection),
        (
            Findings {
                present: Some(Stop::Overload),
                ..WELL
            },
            Stop::Overload,
        ),
        (
            Findings {
                finite: false,
                ..WELL
            },
            Stop::NonFinite,
        ),
    ]
}

const NOT_READY: Findings = Findings {
    amplifiers_ready: false,
    ..WELL
};

/// The modes in which each cause stops the device. Amplifiers that settle may be not ready.
fn stopped_by(stop: Stop) -> Vec<SafetyState> {
    let mut modes = vec![armed(), running()];
    if stop != Stop::AmplifierFault {
        modes.push(settling());
    }
    modes
}

/// All that is found by either.
fn both(a: Findings, b: Findings) -> Findings {
    Findings {
        monitor: a.monitor.or(b.monitor),
        present: a.present.or(b.present),
        amplifiers_ready: a.amplifiers_ready && b.amplifiers_ready,
        interlock: a.interlock || b.interlock,
        clock_failure: a.clock_failure || b.clock_failure,
        finite: a.finite && b.finite,
        missed: a.missed.max(b.missed),
        debugger: a.debugger || b.debugger,
        supply: Outside(a.supply.0 || b.supply.0),
    }
}

#[test]
fn every_cause_disables_in_its_tick_and_stays_until_rearmed() {
    for (findings, stop) in wrongs() {
        for before in stopped_by(stop) {
            let mut state = before;
            let order = tick(&mut state, findings, None);
            assert_eq!(order, RESTARTED);
            for request in [None, Some(Request::Select(1)), Some(Request::KeepAlive)] {
                assert!(!tick(&mut state, WELL, request).enable);
                assert_eq!((state.mode(), state.stop()), (Mode::Safe, stop));
            }
            // The scene selected before the stop does not start again.
            let order = tick(&mut state, WELL, Some(Request::Arm));
            assert!(order.enable && order.select.is_none());
            assert_eq!((state.mode(), state.stop()), (Mode::Armed, Stop::None));
        }
    }
}

#[test]
fn first_cause_of_the_list_is_reported() {
    let wrongs = wrongs();
    for (i, (first, stop)) in wrongs.iter().enumerate() {
        for (second, _) in &wrongs[i..] {
            let mut state = running();
            tick(&mut state, both(*first, *second), None);
            assert_eq!(state.stop(), *stop, "{first:?} {second:?}");
        }
    }
}

#[test]
fn cause_has_priority_over_a_request_of_the_same_tick() {
    for (findings, stop) in wrongs() {
        for request in [Request::Select(1), Request::Disarm, Request::Arm] {
            for before in stopped_by(stop) {
                let mut state = before;
                assert!(!tick(&mut state, findings, Some(request)).enable);
                assert_eq!((state.mode(), state.stop()), (Mode::Safe, stop));
            }
        }
    }
}

#[test]
fn present_cause_refuses_arming_and_a_past_one_does_not() {
    for (findings, stop) in wrongs() {
        let mut state = SAFETY.start(Stop::None);
        tick(&mut state, WELL, Some(Request::Select(3)));
        let order = tick(&mut state, findings, Some(Request::Arm));
        // What is latched or counted begins again with arm. Disabled amplifiers may be not ready.
        let over =
            findings.monitor.is_some() || findings.missed > 0 || stop == Stop::AmplifierFault;
        if over {
            assert!(order.enable && order.restart, "{stop:?}");
            assert_eq!((state.mode(), state.stop()), (Mode::Running, Stop::None));
        } else {
            assert_eq!(order, RESTARTED, "{stop:?}");
            assert_eq!((state.mode(), state.stop()), (Mode::Safe, stop));
            // The selection is gone.
            assert_eq!(tick(&mut state, WELL, Some(Request::Arm)).select, None);
        }
    }
}

/// Two of three ticks of settling may pass without ready amplifiers. The third one needs them, and
/// so does every tick from then on.
#[test]
fn amplifiers_have_to_be_ready_at_the_end_of_settling() {
    for scene in [0, 2] {
        let start = || {
            let mut state = SLOW.start(Stop::None);
            SLOW.tick(&mut state, &NOT_READY, Some(Request::Select(scene)));
            assert!(SLOW.tick(&mut state, &NOT_READY, Some(Request::Arm)).enable);
            for _ in 0..2 {
                assert!(SLOW.tick(&mut state, &NOT_READY, None).enable);
                assert_eq!((state.mode(), state.stop()), (Mode::Settling, Stop::None));
            }
            state
        };
        let mut late = start();
        let order = SLOW.tick(&mut late, &NOT_READY, None);
        assert_eq!((order.enable, order.select), (false, None));
        assert_eq!(
            (late.mode(), late.stop()),
            (Mode::Safe, Stop::AmplifierFault)
        );
        let mut ready = start();
        assert!(SLOW.tick(&mut ready, &WELL, None).enable);
        assert!(matches!(ready.mode(), Mode::Armed | Mode::Running));
        assert!(!SLOW.tick(&mut ready, &NOT_READY, None).enable);
        assert_eq!(ready.stop(), Stop::AmplifierFault);
    }
}

#[test]
fn ticks_missed_before_arming_are_ignored() {
    for before in [0, 500, u32::MAX] {
        let mut state = SAFETY.start(Stop::None);
        let missed = |missed| Findings { missed, ..WELL };
        tick(&mut state, missed(before), None);
        assert!(tick(&mut state, missed(500), Some(Request::Arm)).enable);
        for _ in 0..10 {
            assert!(tick(&mut state, WELL, None).enable);
        }
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
    for mut state in [settling(), armed(), running()] {
        let before = state.mode();
        assert!(SLOW.tick(&mut state, &debugger, None).enable);
        assert_eq!((state.mode(), state.stop()), (before, Stop::None));
    }
    // A fault of the hardware is reported first.
    for (findings, stop) in &wrongs()[..2] {
        let mut state = SAFETY.start(Stop::None);
        tick(&mut state, both(*findings, debugger), Some(Request::Arm));
        assert_eq!(state.stop(), *stop);
    }
}

#[test]
fn reset_with_a_cause_boots_in_state_safe() {
    for &stop in Stop::ALL.iter().filter(|stop| **stop != Stop::None) {
        let mut state = SAFETY.start(stop);
        assert!(!tick(&mut state, WELL, None).enable);
        assert_eq!((state.mode(), state.stop()), (Mode::Safe, stop));
        tick(&mut state, WELL, Some(Request::Disarm));
        assert_eq!((state.mode(), state.stop()), (Mode::Boot, Stop::None));
    }
    assert_eq!(SAFETY.start(Stop::None).mode(), Mode::Boot);
}

/// From every mode, whatever is found and asked: enabled is what the mode says, only `Arm` gets
/// there from the others, safe has a cause, and an order to select goes to what is enabled.
#[test]
fn only_arm_enables() {
    let modes = [
        SAFETY.start(Stop::None),
        SAFETY.start(Stop::Panic),
        settling(),
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
                for safety in [SAFETY, SLOW] {
                    let mut state = before;
                    let order = safety.tick(&mut state, &findings, request);
                    let is_on = before.mode().is_enabled();
                    assert_eq!(order.enable, state.mode().is_enabled());
                    assert!(!order.enable || is_on || request == Some(Request::Arm));
                    assert!(state.mode() != Mode::Safe || state.stop() != Stop::None);
                    assert!(order.select.is_none_or(|scene| scene < 8 && order.enable));
                    let may_wait = findings == NOT_READY && before.mode() == Mode::Settling;
                    let allowed = findings == WELL || may_wait;
                    assert!(!is_on || allowed || state.mode() == Mode::Safe);
                }
            }
        }
    }
}
