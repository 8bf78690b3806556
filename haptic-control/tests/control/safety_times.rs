//! The times of the safety state machine: settling, silence, missed ticks; and its numbers.

use haptic_control::{Findings, Mode, Order, Request, Safety, SafetyState, Stop};

use crate::safety::RESTARTED;

pub(crate) const SAFETY: Safety = Safety {
    settle: 20,
    silence: Some(100),
    disarm: Some(300),
    missed: 4,
    scenes: 8,
};
pub(crate) const WELL: Findings = Findings::WELL;

fn ask(state: &mut SafetyState, request: Request) -> Order {
    SAFETY.tick(state, &WELL, Some(request))
}

fn silent(state: &mut SafetyState) -> Order {
    SAFETY.tick(state, &WELL, None)
}

/// Armed, and settled, with the latest request at the end.
fn armed() -> SafetyState {
    let mut state = SAFETY.start(Stop::None);
    ask(&mut state, Request::Arm);
    for _ in 0..SAFETY.settle {
        ask(&mut state, Request::KeepAlive);
    }
    assert_eq!(state.mode(), Mode::Armed);
    state
}

fn running() -> SafetyState {
    let mut state = armed();
    ask(&mut state, Request::Select(2));
    assert_eq!(state.mode(), Mode::Running);
    state
}

/// A scene selected before arming, or in the first or the last tick of settling, starts from rest at
/// the end of settling; 0 is no scene.
#[test]
fn scene_starts_at_rest_after_settling() {
    for at in [None, Some(1), Some(20)] {
        for scene in [0, 5] {
            let mut state = SAFETY.start(Stop::None);
            if at.is_none() {
                ask(&mut state, Request::Select(scene));
            }
            let order = ask(&mut state, Request::Arm);
            let armed = Order {
                enable: true,
                restart: true,
                select: None,
            };
            assert_eq!((order, state.mode()), (armed, Mode::Settling));
            for k in 1..20 {
                let request = (at == Some(k)).then_some(Request::Select(scene));
                let order = SAFETY.tick(&mut state, &WELL, request);
                let nothing = Order {
                    enable: true,
                    ..Order::default()
                };
                assert_eq!((order, state.mode()), (nothing, Mode::Settling), "{k}");
            }
            let request = (at == Some(20)).then_some(Request::Select(scene));
            let order = SAFETY.tick(&mut state, &WELL, request);
            let on = scene != 0;
            let wanted = Order {
                select: on.then_some(scene),
                ..armed
            };
            assert_eq!(order, wanted);
            let mode = if on { Mode::Running } else { Mode::Armed };
            assert_eq!(state.mode(), mode);
        }
    }
}

#[test]
fn settling_refuses_an_unknown_scene_and_is_not_prolonged_by_arm() {
    let mut state = SAFETY.start(Stop::None);
    ask(&mut state, Request::Arm);
    for k in 1..20 {
        let request = if k % 2 == 0 {
            Request::Select(8)
        } else {
            Request::Arm
        };
        assert_eq!(ask(&mut state, request).select, None);
        assert_eq!(state.mode(), Mode::Settling);
    }
    assert_eq!(silent(&mut state).select, None);
    assert_eq!(state.mode(), Mode::Armed);
}

#[test]
fn settling_has_its_full_duration_after_every_arm() {
    let mut state = running();
    ask(&mut state, Request::Disarm);
    ask(&mut state, Request::Arm);
    for _ in 1..20 {
        silent(&mut state);
        assert_eq!(state.mode(), Mode::Settling);
    }
    silent(&mut state);
    assert_eq!(state.mode(), Mode::Armed);
}

#[test]
fn command_timeout_stops_the_scene_and_a_selection_starts_it_again() {
    let mut state = running();
    for _ in 0..100 {
        assert_eq!(silent(&mut state).select, None);
        assert_eq!((state.mode(), state.stop()), (Mode::Running, Stop::None));
    }
    let order = silent(&mut state);
    assert_eq!(
        (order.enable, order.restart, order.select),
        (true, false, Some(0))
    );
    let off = (Mode::Armed, Stop::CommandTimeout);
    assert_eq!((state.mode(), state.stop()), off);
    ask(&mut state, Request::Select(1));
    assert_eq!((state.mode(), state.stop()), (Mode::Running, Stop::None));
}

#[test]
fn long_command_timeout_disarms() {
    // The scene, where one is on, goes off on the way.
    for before in [armed(), running()] {
        let mut state = before;
        for k in 1..=300 {
            assert!(silent(&mut state).enable, "{k}");
            assert!(state.mode().is_enabled(), "{k}");
        }
        assert_eq!(silent(&mut state), RESTARTED);
        let boot = (Mode::Boot, Stop::CommandTimeout);
        assert_eq!((state.mode(), state.stop()), boot);
        // The cause stays until the next arm, which brings no scene back.
        assert_eq!(silent(&mut state), Order::default());
        assert_eq!((state.mode(), state.stop()), boot);
        ask(&mut state, Request::Arm);
        assert_eq!((state.mode(), state.stop()), (Mode::Settling, Stop::None));
        for _ in 0..20 {
            silent(&mut state);
        }
        assert_eq!(state.mode(), Mode::Armed);
    }
}

#[test]
fn every_request_counts_as_keep_alive() {
    // What is not taken, too.
    for request in [Request::KeepAlive, Request::Arm, Request::Select(8)] {
        for (before, longest) in [(running(), 100), (armed(), 300)] {
            let mode = before.mode();
            // At the last moment, and long before it.
            for pause in [longest, longest / 2] {
                let mut state = before;
                for _ in 0..6 {
                    for _ in 0..pause {
                        silent(&mut state);
                    }
                    ask(&mut state, request);
                }
                assert_eq!((state.mode(), state.stop()), (mode, Stop::None));
            }
        }
    }
}

#[test]
fn no_command_timeout_without_a_limit() {
    let patient = Safety {
        silence: None,
        disarm: None,
        ..SAFETY
    };
    for before in [armed(), running()] {
        let mut state = before;
        for _ in 0..100_000 {
            assert!(patient.tick(&mut state, &WELL, None).enable);
        }
        assert_eq!(state.mode(), before.mode());
    }
    // The limits are apart: a running scene knows its own alone.
    let disarming = Safety {
        silence: None,
        ..SAFETY
    };
    let mut state = running();
    for _ in 0..1000 {
        assert!(disarming.tick(&mut state, &WELL, None).enable);
    }
    assert_eq!(state.mode(), Mode::Running);
}

#[test]
fn missed_ticks_at_the_limit_stop_and_one_fewer_does_not() {
    for (missed, mode) in [(3, Mode::Running), (4, Mode::Safe), (u32::MAX, Mode::Safe)] {
        let mut state = running();
        SAFETY.tick(&mut state, &Findings { missed, ..WELL }, None);
        assert_eq!(state.mode(), mode, "{missed}");
    }
    // A limit of none still lets pass what is no miss at all.
    let strict = Safety {
        missed: 0,
        ..SAFETY
    };
    let mut state = running();
    strict.tick(&mut state, &WELL, None);
    assert_eq!(state.mode(), Mode::Running);
    strict.tick(&mut state, &Findings { missed: 1, ..WELL }, None);
    assert_eq!(state.stop(), Stop::TickOverrun);
}

#[test]
fn one_missed_tick_in_16_is_tolerated_and_more_are_not() {
    // One in 16 weighs as much as the ticks that came; one in 15 adds 1 / 16 of a tick each time.
    for (every, stops) in [(16, false), (15, true), (8, true)] {
        let mut state = running();
        let mut stopped = None;
        for k in 1..2000 {
            let missed = u32::from(k % every == 0);
            let findings = Findings { missed, ..WELL };
            SAFETY.tick(&mut state, &findings, Some(Request::KeepAlive));
            if state.mode() == Mode::Safe && stopped.is_none() {
                stopped = Some(k);
            }
        }
        assert_eq!(stopped.is_some(), stops, "one in {every}: {stopped:?}");
    }
}

/// State of `safety` after arming and settling, without another request.
fn settled(safety: &Safety) -> SafetyState {
    let mut state = safety.start(Stop::None);
    safety.tick(&mut state, &WELL, Some(Request::Arm));
    for _ in 0..safety.settle {
        safety.tick(&mut state, &WELL, None);
    }
    assert_eq!(state.mode(), Mode::Armed);
    state
}

#[test]
fn ticks_on_time_offset_missed_ones_without_a_request() {
    let safety = Safety {
        silence: None,
        disarm: None,
        ..SAFETY
    };
    let missed = Findings { missed: 1, ..WELL };
    let run = |period: u32, ticks: u32| {
        let mut state = settled(&safety);
        for k in 0..ticks {
            let findings = if k % period == 0 { &missed } else { &WELL };
            safety.tick(&mut state, findings, None);
        }
        state.stop()
    };
    assert_eq!(run(17, 10_000), Stop::None);
    assert_eq!(run(15, 10_000), Stop::TickOverrun);
}

#[test]
fn silence_that_disarms_may_be_shorter_than_that_of_a_scene() {
    let safety = Safety {
        silence: Some(100),
        disarm: Some(30),
        ..SAFETY
    };
    let mut state = settled(&safety);
    let silent = (safety.settle..).take_while(|_| {
        safety.tick(&mut state, &WELL, None);
        state.mode() == Mode::Armed
    });
    assert_eq!(silent.count() as u32 + safety.settle, 30);
    assert_eq!(
        (state.mode(), state.stop()),
        (Mode::Boot, Stop::CommandTimeout)
    );
}

/// A missed tick, after which each tick is looked at for a while, does not bring the limit of an armed device forward.
#[test]
fn scene_outlasts_the_silence_that_disarms() {
    let safety = Safety {
        silence: Some(100),
        disarm: Some(30),
        ..SAFETY
    };
    for missed_at in [None, Some(50)] {
        let mut state = settled(&safety);
        safety.tick(&mut state, &WELL, Some(Request::Select(2)));
        let silent = (0..1000).take_while(|tick| {
            let missed = u32::from(missed_at == Some(*tick));
            safety.tick(&mut state, &Findings { missed, ..WELL }, None);
            state.mode() == Mode::Running
        });
        assert_eq!(silent.count(), 100, "{missed_at:?}");
        let off = (Mode::Armed, Stop::CommandTimeout);
        assert_eq!((state.mode(), state.stop()), off);
        // An armed device has been silent for too long already.
        assert_eq!(safety.tick(&mut state, &WELL, None), RESTARTED);
    }
}

/// What ends the calm ticks is not a command: the silence is as long as without it.
#[test]
fn end_of_the_calm_ticks_does_not_change_the_silence() {
    for found in [None, Some(1), Some(40), Some(99)] {
        let mut state = running();
        let silent = (0..1000).take_while(|tick| {
            if found == Some(*tick) {
                state.end_calm();
            }
            if !SAFETY.pass_calm(&mut state, None) {
                SAFETY.tick(&mut state, &WELL, None);
            }
            state.mode() == Mode::Running
        });
        assert_eq!(silent.count(), 100, "{found:?}");
        assert_eq!(state.stop(), Stop::CommandTimeout);
    }
    // Before the device is armed no tick is calm.
    let mut state = SAFETY.start(Stop::None);
    state.end_calm();
    silent(&mut state);
    assert_eq!((state.mode(), state.stop()), (Mode::Boot, Stop::None));
}
