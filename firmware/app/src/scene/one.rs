//! An image of one scene, without code and memory of other scenes.

use estimator_core::Sample;
use haptic_control::{
    Action, Controller, ControllerState, CurrentScale, Currents, Refusal, SceneKind, Tunable,
};

use super::{BOUNDS, Estimation, FIRST, HANDLE, Handle, RIG, THE_SCENE, TORQUE_SCENE, TheScene};
use crate::config::DEVICE;
use crate::large::{Choice, LARGE, Large, LargeEstimator as _, Learned};

/// The scene with changed parameters, sent to the control task.
#[derive(Clone, Copy)]
pub struct Tuned(TheScene);

/// Parameters of the scene, kept at the lowest priority.
pub struct Parameters(TheScene);

/// The preset.
impl Default for Parameters {
    fn default() -> Self {
        Self(THE_SCENE)
    }
}

impl Parameters {
    /// Sets a parameter, within bounds.
    pub fn set(&mut self, number: u8, parameter: u8, value: f32) -> Result<Tuned, Refusal> {
        if number != FIRST {
            return Err(Refusal::Unknown);
        }
        self.0 = self.0.tuned(parameter, value, &BOUNDS)?;
        Ok(Tuned(self.0))
    }
}

/// The control core: one controller, on or off.
pub struct Core {
    controller: Controller<TheScene, Large, Handle>,
    state: ControllerState<TheScene, Large, Handle>,
    on: bool,
    scale: CurrentScale,
    applied: Currents,
}

/// Whether the scene commands its currents by itself. The stages limit all others.
const OPEN_LOOP: bool = FIRST == SceneKind::Excite.number();

impl Core {
    /// State at rest at the first sample, off.
    pub fn start(first: &Sample) -> Self {
        let controller = Controller::new(THE_SCENE, LARGE, HANDLE, &RIG);
        Self {
            state: controller.start(first),
            controller,
            on: false,
            scale: CurrentScale::FULL,
            applied: Currents::default(),
        }
    }

    /// Starts again at rest at this sample, off. Parameters stay.
    pub fn restart(&mut self, first: &Sample) {
        self.controller.restart(&mut self.state, first);
        self.on = false;
    }

    /// Starts the scene at rest, also if it is on, or switches it off. The torque set-point starts at zero.
    pub fn select(&mut self, scene: u8, latest: &Sample) {
        let on = scene == FIRST;
        if on && FIRST == TORQUE_SCENE {
            self.controller.retune(THE_SCENE);
        }
        if on {
            self.controller.restart(&mut self.state, latest);
        }
        self.on = on;
    }

    /// Changes the parameters, from the next tick on.
    pub fn retune(&mut self, tuned: Tuned) {
        self.controller.retune(tuned.0);
    }

    /// Scales the limits of the currents.
    pub fn scale(&mut self, scale: CurrentScale) {
        self.controller.scale(&mut self.state, scale);
        self.scale = scale;
    }

    /// Selects the estimator of the large motor.
    pub fn choose(&mut self, choice: Choice) {
        if let Some(state) = self.state.large_mut() {
            Large::choose(state, choice);
        }
    }

    /// One tick.
    pub fn step(&mut self, sample: &Sample) -> Action {
        let mut action = Action::default();
        if self.on {
            action = self.controller.step(&mut self.state, sample);
        }
        if OPEN_LOOP {
            action.currents = self.scale.within(&DEVICE, action.currents);
        }
        self.applied = action.currents;
        action
    }

    /// Currents of the latest tick.
    pub const fn applied(&self) -> Currents {
        self.applied
    }

    /// Records that the latest tick applies no current.
    pub fn withhold(&mut self) {
        self.applied = Currents::default();
    }

    /// Confidence and number of the large motor's estimator after the latest tick.
    pub fn estimation(&self) -> Estimation {
        match self.state.large() {
            Some(state) if self.on => Estimation::of(state),
            _ => Estimation::NONE,
        }
    }

    /// Parameters that the large motor's estimator adapted.
    pub fn learned(&self) -> Learned {
        self.state
            .large()
            .map(|state| LARGE.learned(state))
            .unwrap_or_default()
    }
}
