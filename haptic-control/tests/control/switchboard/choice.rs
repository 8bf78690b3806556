//! The choice of an operator among several estimators.

use estimator_core::{FiniteDifference, Handover, Side, preset};
use haptic_control::{SceneKind, Switchboard};

use super::at;
use crate::bench::{HANDLE, LARGE, Large, RATE, RIG, usual};

/// While scenes come and go and the control begins again.
#[test]
fn chosen_estimator_outlasts_scenes_and_restarts() {
    type Both = Handover<FiniteDifference, Large>;
    const BOTH: Both = preset!(Handover::new(FiniteDifference, LARGE, 10, 10));
    let board = Switchboard::new(BOTH, HANDLE, RIG, RATE);
    let mut state = board.start(&at(0));
    assert_eq!(state.large().in_charge(), Some(Side::First));
    state.large_mut().select(Side::Second);
    for restarts in [false, true] {
        if restarts {
            board.restart(&mut state, &at(0));
        }
        for kind in [SceneKind::FreeAir, SceneKind::Off, SceneKind::Wall] {
            board.select(&mut state, usual(kind), &at(0));
            for _ in 0..50 {
                board.step(&mut state, &at(0));
            }
            let chosen = state.large().in_charge();
            assert_eq!(chosen, Some(Side::Second), "{kind}, {restarts}");
        }
    }
}
