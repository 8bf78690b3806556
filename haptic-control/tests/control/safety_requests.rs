//! Requests to the safety state machine of a device that is well.

use haptic_control::{Mode, Request, Stop};

use crate::safety::{RESTARTED, SAFETY, WELL, armed, running, settling, tick};

#[test]
fn scene_selected_during_boot_starts_at_the_first_arm() {
    let mut state = SAFETY.start(Stop::None);
    assert!(!tick(&mut state, WELL, Some(Request::Select(3))).enable);
    // There are eight scenes.
    assert!(!tick(&mut state, WELL, Some(Request::Select(8))).enable);
    let order = tick(&mut state, WELL, Some(Request::Arm));
    assert_eq!(
        (order.enable, order.restart, order.select),
        (true, true, Some(3))
    );
    assert_eq!(state.mode(), Mode::Running);
    tick(&mut state, WELL, Some(Request::Disarm));
    let order = tick(&mut state, WELL, Some(Request::Arm));
    assert_eq!((order.enable, order.select), (true, None));
    assert_eq!(state.mode(), Mode::Armed);
}

#[test]
fn disarm_clears_scene_and_cause_and_restarts() {
    let mut chosen = SAFETY.start(Stop::None);
    tick(&mut chosen, WELL, Some(Request::Select(3)));
    for before in [
        chosen,
        SAFETY.start(Stop::Panic),
        settling(),
        armed(),
        running(),
    ] {
        let mut state = before;
        let order = tick(&mut state, WELL, Some(Request::Disarm));
        assert_eq!(order, RESTARTED);
        assert_eq!((state.mode(), state.stop()), (Mode::Boot, Stop::None));
        assert_eq!(tick(&mut state, WELL, Some(Request::Arm)).select, None);
        assert_eq!(state.mode(), Mode::Armed);
    }
}

#[test]
fn selection_starts_stops_or_changes_a_scene() {
    let mut state = armed();
    for (scene, mode) in [
        (7, Mode::Running),
        (1, Mode::Running),
        (0, Mode::Armed),
        (0, Mode::Armed),
    ] {
        let order = tick(&mut state, WELL, Some(Request::Select(scene)));
        assert_eq!(
            (order.enable, order.restart, order.select),
            (true, false, Some(scene))
        );
        assert_eq!(state.mode(), mode);
    }
    let order = tick(&mut state, WELL, Some(Request::Select(8)));
    assert_eq!((order.select, state.mode()), (None, Mode::Armed));
}
