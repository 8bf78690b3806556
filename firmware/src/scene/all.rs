//! An image of all scenes, one at a time.

use estimator_core::Sample;
use haptic_control::{Action, AnyScene, Switchboard, SwitchboardState};

use super::preset::{DETENTS, FREE_AIR, HOLD, OFF, SPRING, TEXTURE, VISCOUS, WALL};
use super::{HANDLE, Handle, LARGE, Large, RATE, RIG, SCENES};

static SCENES_BY_NUMBER: [AnyScene; SCENES as usize] = [
    AnyScene::Off(OFF),
    AnyScene::FreeAir(FREE_AIR),
    AnyScene::Wall(WALL),
    AnyScene::SpringDamper(SPRING),
    AnyScene::Viscous(VISCOUS),
    AnyScene::Detents(DETENTS),
    AnyScene::Texture(TEXTURE),
    AnyScene::Hold(HOLD),
];

static SWITCHBOARD: Switchboard<Large, Handle> = Switchboard::new(LARGE, HANDLE, RIG, RATE);

/// The control core: a switchboard.
pub(crate) struct Core(SwitchboardState<Large, Handle>);

impl Core {
    /// At rest at the first sample, with no scene.
    pub(crate) fn start(first: &Sample) -> Self {
        Self(SWITCHBOARD.start(first))
    }

    /// Swaps the scene before the next tick.
    pub(crate) fn select(&mut self, scene: u8, latest: &Sample) {
        if let Some(scene) = SCENES_BY_NUMBER.get(usize::from(scene)) {
            SWITCHBOARD.select(&mut self.0, *scene, latest);
        }
    }

    /// One tick.
    pub(crate) fn step(&mut self, sample: &Sample) -> Action {
        SWITCHBOARD.step(&mut self.0, sample)
    }
}
