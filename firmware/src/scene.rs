//! What the image holds: its estimators and scenes. The only file with `cfg`.

use estimator_core::{
    EndFit, Foaw, Hertz, Model, NoInput, Sample, SteadyKalman, SteadyKalmanTriple, preset,
};
use haptic_control::{
    Action, AnyScene, Detents, DualStage, FreeAir, Hold, LoopPoles, Off, Radians, Rig,
    SpringDamper, Switchboard, SwitchboardState, Texture, Viscous, Wall,
};

use crate::board::RATE_HZ;

const RATE: Hertz = Hertz(RATE_HZ as f64);
const RIG: Rig = preset!(Rig::new(&DualStage::DEFAULT, RATE, LoopPoles::DEFAULT));

type Large = Foaw<32, EndFit>;
type Handle = SteadyKalmanTriple;
const LARGE: Large = preset!(Foaw::new(32, 1));
const HANDLE_MODEL: Model<3, NoInput> = preset!(Model::triple_integrator(20_000, RATE, 4e3));
const HANDLE: Handle = preset!(SteadyKalman::new(&HANDLE_MODEL));

/// The scenes by their number on the command channel.
pub(crate) const SCENES: [AnyScene; 8] = [
    AnyScene::Off(Off),
    AnyScene::FreeAir(FreeAir),
    AnyScene::Wall(preset!(Wall::new(Radians(0.1), 0.30, 0.0))),
    AnyScene::SpringDamper(preset!(SpringDamper::new(Radians(0.0), 0.10, 0.5e-3))),
    AnyScene::Viscous(preset!(Viscous::new(2e-3))),
    AnyScene::Detents(preset!(Detents::new(8e-3, 24))),
    AnyScene::Texture(preset!(Texture::new(6e-3, Hertz(150.0), RATE))),
    AnyScene::Hold(preset!(Hold::new(0.2, 1e-3))),
];

static BOARD: Switchboard<Large, Handle> = Switchboard::new(LARGE, HANDLE, RIG, RATE);

/// The control core of this image.
pub(crate) struct Core(SwitchboardState<Large, Handle>);

impl Core {
    /// At rest at the first sample, with no scene.
    pub(crate) fn start(first: &Sample) -> Self {
        Self(BOARD.start(first))
    }

    /// Swaps the scene before the next tick.
    pub(crate) fn select(&mut self, scene: usize, sample: &Sample) {
        if let Some(scene) = SCENES.get(scene) {
            BOARD.select(&mut self.0, *scene, sample);
        }
    }

    /// One tick.
    pub(crate) fn step(&mut self, sample: &Sample) -> Action {
        BOARD.step(&mut self.0, sample)
    }
}
