//! An image of all scenes, one of which is on.

use estimator_core::{Sample, preset};
use haptic_control::{
    Action, AnyScene, CurrentScale, Currents, Refusal, Switchboard, SwitchboardState,
};

use super::{BOUNDS, Estimation, HANDLE, Handle, RIG, SCENES, TORQUE_SCENE};
use crate::config::{DEVICE, RATE};
use crate::large::{Choice, LARGE, Large, LargeEstimator as _, Learned};

type Scenes = [AnyScene; SCENES as usize];

const SCENES_BY_NUMBER: Scenes = preset!(AnyScene::usual(&DEVICE, RATE));

static SWITCHBOARD: Switchboard<Large, Handle> = Switchboard::new(LARGE, HANDLE, RIG, RATE);

/// A scene with changed parameters, sent to the control task.
#[derive(Clone, Copy)]
pub struct Tuned {
    number: u8,
    scene: AnyScene,
}

/// Parameters of the scenes, kept at the lowest priority.
pub struct Parameters(Scenes);

/// The presets.
impl Default for Parameters {
    fn default() -> Self {
        Self(SCENES_BY_NUMBER)
    }
}

impl Parameters {
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

/// The control core: a switchboard and the parameters of its scenes.
// A tick needs the state alone, which comes first (see `Control`).
#[repr(C)]
pub struct Core {
    state: SwitchboardState<Large, Handle>,
    scenes: Scenes,
    on: u8,
}

impl Core {
    /// State at rest at the first sample, without a scene.
    pub fn start(first: &Sample) -> Self {
        Self {
            state: SWITCHBOARD.start(first),
            scenes: SCENES_BY_NUMBER,
            on: 0,
        }
    }

    /// Starts again at rest at this sample, without a scene. Parameters stay.
    pub fn restart(&mut self, first: &Sample) {
        SWITCHBOARD.restart(&mut self.state, first);
        self.on = 0;
    }

    /// Changes the scene before the next tick. The torque set-point starts at zero.
    pub fn select(&mut self, number: u8, latest: &Sample) {
        if let Some(scene) = self.scenes.get_mut(usize::from(number)) {
            if number == TORQUE_SCENE {
                *scene = SCENES_BY_NUMBER[usize::from(TORQUE_SCENE)];
            }
            SWITCHBOARD.select(&mut self.state, *scene, latest);
            self.on = number;
        }
    }

    /// Changes the parameters of a scene. Those of the scene that is on act from the next tick.
    pub fn retune(&mut self, tuned: Tuned) {
        if let Some(scene) = self.scenes.get_mut(usize::from(tuned.number)) {
            *scene = tuned.scene;
        }
        if self.on == tuned.number {
            SWITCHBOARD.retune(&mut self.state, tuned.scene);
        }
    }

    /// Scales the limits of the currents.
    pub fn scale(&mut self, scale: CurrentScale) {
        SWITCHBOARD.scale(&mut self.state, scale);
    }

    /// Selects the estimator of the large motor.
    pub fn choose(&mut self, choice: Choice) {
        Large::choose(self.state.large_mut(), choice);
    }

    /// One tick.
    // As `Control::step`.
    #[cfg_attr(feature = "large-adaptive", inline(always))]
    pub fn step(&mut self, sample: &Sample) -> Action {
        match cfg!(feature = "large-adaptive") {
            true => SWITCHBOARD.step_inlined(&mut self.state, sample),
            false => SWITCHBOARD.step(&mut self.state, sample),
        }
    }

    /// Currents of the latest tick.
    pub const fn applied(&self) -> Currents {
        self.state.applied()
    }

    /// Records that the latest tick applies no current.
    pub fn withhold(&mut self) {
        self.state.withhold();
    }

    /// Confidence and number of the large motor's estimator after the latest tick.
    pub fn estimation(&self) -> Estimation {
        if self.state.estimates_large() {
            Estimation::of(self.state.large())
        } else {
            Estimation::NONE
        }
    }

    /// Parameters that the large motor's estimator adapted.
    pub fn learned(&self) -> Learned {
        LARGE.learned(self.state.large())
    }
}
