//! An image of one scene: no code and no memory of the others.

use estimator_core::Sample;
use haptic_control::{Action, Controller, ControllerState};

use super::{FIRST, HANDLE, Handle, LARGE, Large, RIG, THE_SCENE, TheScene};

/// The control core: one controller, on or off.
pub(crate) struct Core {
    controller: Controller<TheScene, Large, Handle>,
    state: ControllerState<TheScene, Large, Handle>,
    on: bool,
}

impl Core {
    /// At rest at the first sample, off.
    pub(crate) fn start(first: &Sample) -> Self {
        let controller = Controller::new(THE_SCENE, LARGE, HANDLE, &RIG);
        Self {
            state: controller.start(first),
            controller,
            on: false,
        }
    }

    /// Puts the one scene on, from rest, or off.
    pub(crate) fn select(&mut self, scene: u8, latest: &Sample) {
        let on = scene == FIRST;
        if on && !self.on {
            self.state = self.controller.start(latest);
        }
        self.on = on;
    }

    /// One tick.
    pub(crate) fn step(&mut self, sample: &Sample) -> Action {
        if self.on {
            self.controller.step(&mut self.state, sample)
        } else {
            Action::default()
        }
    }
}
