//! An image of all scenes, one at a time.

use estimator_core::{Sample, preset};
use haptic_control::{Action, AnyScene, Refusal, Switchboard, SwitchboardState};

use super::{BOUNDS, Estimation, HANDLE, Handle, RIG, SCENES, TORQUE_SCENE};
use crate::config::{DEVICE, RATE};
use crate::large::{Choice, LARGE, Large, LargeEstimator as _, Learned};

type Scenes = [AnyScene; SCENES as usize];

const SCENES_BY_NUMBER: Scenes = preset!(AnyScene::usual(&DEVICE, RATE));

static SWITCHBOARD: Switchboard<Large, Handle> = Switchboard::new(LARGE, HANDLE, RIG, RATE);

/// A scene built anew, on its way to the control task.
#[derive(Clone, Copy)]
pub struct Tuned {
    number: u8,
    scene: AnyScene,
}

/// What the scenes are set to, as the lowest priority knows it.
pub struct Settings(Scenes);

/// The presets.
impl Default for Settings {
    fn default() -> Self {
        Self(SCENES_BY_NUMBER)
    }
}

impl Settings {
    /// Sets a parameter, within bounds.
    pub fn set(&mut self, number: u8, parameter: u8, value: f32) -> Result<Tuned, Refusal> {
        let Some(known) = self.0.get_mut(usize::from(number)) else {
            return Err(Refusal::Unknown);
        };
        let scene = known.tuned(parameter, value, &BOUNDS)?;
        *known = scene;
        Ok(Tuned { number, scene })
    }
}

/// The control core: a switchboard, and what its scenes are set to.
pub struct Core {
    state: SwitchboardState<Large, Handle>,
    scenes: Scenes,
    on: u8,
}

impl Core {
    /// At rest at the first sample, with no scene.
    pub fn start(first: &Sample) -> Self {
        Self {
            state: SWITCHBOARD.start(first),
            scenes: SCENES_BY_NUMBER,
            on: 0,
        }
    }

    /// At rest at this sample, with no scene; settings stay.
    pub fn restart(&mut self, first: &Sample) {
        SWITCHBOARD.restart(&mut self.state, first);
        self.on = 0;
    }

    /// Swaps the scene before the next tick. Torque begins at zero, whatever was set before.
    pub fn select(&mut self, number: u8, latest: &Sample) {
        if let Some(scene) = self.scenes.get_mut(usize::from(number)) {
            if number == TORQUE_SCENE {
                *scene = SCENES_BY_NUMBER[usize::from(TORQUE_SCENE)];
            }
            SWITCHBOARD.select(&mut self.state, *scene, latest);
            self.on = number;
        }
    }

    /// Takes settings; those of the scene that is on act from the next tick.
    pub fn retune(&mut self, tuned: Tuned) {
        if let Some(scene) = self.scenes.get_mut(usize::from(tuned.number)) {
            *scene = tuned.scene;
        }
        if self.on == tuned.number {
            SWITCHBOARD.retune(&mut self.state, tuned.scene);
        }
    }

    /// Puts this estimator in charge of the large motor.
    pub fn choose(&mut self, choice: Choice) {
        Large::choose(self.state.large_mut(), choice);
    }

    /// One tick.
    pub fn step(&mut self, sample: &Sample) -> Action {
        SWITCHBOARD.step(&mut self.state, sample)
    }

    /// What the large motor's estimator says of its latest velocity.
    pub fn estimation(&self) -> Estimation {
        if self.state.estimates_large() {
            Estimation::of(self.state.large())
        } else {
            Estimation::NONE
        }
    }

    /// What the large motor's estimator has learned.
    pub fn learned(&self) -> Learned {
        LARGE.learned(self.state.large())
    }
}
