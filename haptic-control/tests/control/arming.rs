//! Arming with a cause that is present, and with one that is past.

use haptic_control::{Findings, Mode, Request, Stop};

use crate::safety_times::{SAFETY, WELL};

const HOT: Findings = Findings {
    present: Some(Stop::Overload),
    ..WELL
};

/// A winding that is too hot, or currents that are not the commanded ones.
#[test]
fn present_cause_refuses_to_enable_the_amplifiers_for_a_single_tick() {
    for reset in [Stop::None, Stop::Overload] {
        let mut state = SAFETY.start(reset);
        for _ in 0..3 {
            let order = SAFETY.tick(&mut state, &HOT, Some(Request::Arm));
            assert!(!order.enable && order.restart);
            assert_eq!((state.mode(), state.stop()), (Mode::Safe, Stop::Overload));
            assert!(!SAFETY.tick(&mut state, &HOT, None).enable);
        }
        assert!(SAFETY.tick(&mut state, &WELL, Some(Request::Arm)).enable);
        assert_eq!((state.mode(), state.stop()), (Mode::Settling, Stop::None));
    }
}

#[test]
fn present_cause_stops_an_enabled_device_behind_the_latched_one() {
    let latched = Findings {
        monitor: Some(Stop::Jump),
        ..HOT
    };
    for (findings, stop) in [(HOT, Stop::Overload), (latched, Stop::Jump)] {
        let mut state = SAFETY.start(Stop::None);
        assert!(SAFETY.tick(&mut state, &WELL, Some(Request::Arm)).enable);
        assert!(!SAFETY.tick(&mut state, &findings, None).enable);
        assert_eq!((state.mode(), state.stop()), (Mode::Safe, stop));
    }
}
