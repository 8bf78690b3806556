//! The switchboard of all scenes, one of which is on.
#![no_std]

use haptic_control::{AnyScene, Switchboard, SwitchboardState};
use scene_images::{Action, HANDLE, LARGE, Large, OfHandle, RATE, RIG, Sample};

type OfScenes = Switchboard<Large, OfHandle>;
type State = SwitchboardState<Large, OfHandle>;

/// Bytes of the controller and of its state.
pub static RAM: [usize; 2] = [size_of::<OfScenes>(), size_of::<State>()];

/// Makes the controller.
#[inline(never)]
pub fn make() -> OfScenes {
    Switchboard::new(LARGE, HANDLE, RIG, RATE)
}

/// Starts it.
#[inline(never)]
pub fn start(controller: &OfScenes, first: &Sample) -> State {
    controller.start(first)
}

/// Changes the scene.
#[inline(never)]
pub fn select(controller: &OfScenes, state: &mut State, scene: AnyScene, sample: &Sample) {
    controller.select(state, scene, sample);
}

/// One tick.
#[inline(never)]
pub fn step(controller: &OfScenes, state: &mut State, sample: &Sample) -> Action {
    controller.step(state, sample)
}
