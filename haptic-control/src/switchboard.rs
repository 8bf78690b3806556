//! A controller of all scenes, one at a time.

use estimator_core::{
    AccelerationEstimator, Amps, Count, CountsPerTick, Hertz, Sample, VelocityEstimator,
};

use crate::limits::{Currents, within};
use crate::need::{Need, Senses};
use crate::rig::Rig;
use crate::scene::{AnyScene, ExciteState, Off, Scene};
use crate::stage::{ContinuousState, TransientState};
use crate::tick::{Action, Continuous, Estimated, HandleNeed, Parts, Transient, tick};
use crate::units::{RadPerS, Radians};

/// State of whichever scene is on.
#[derive(Clone, Copy, Debug, PartialEq)]
enum SceneState {
    Nothing,
    Phase(u32),
    Start(Radians),
    Excite(ExciteState),
}

/// The controller of all scenes: one `match` a tick, and of the parts they share only those that
/// the scene needs are run.
///
/// Scenes are swapped whole between two ticks. What the currents would jump by at a swap is
/// added and fades away over some 20 ms, so that the torque does not jump. An estimator that the
/// scene before needed too goes on; another starts at rest.
#[derive(Clone, Copy, Debug)]
pub struct Switchboard<L, H> {
    large: L,
    handle: H,
    rig: Rig,
    /// Part of the difference that fades in a tick.
    fade: f32,
}

/// State of a [`Switchboard`].
#[derive(Clone)]
pub struct SwitchboardState<L: VelocityEstimator, H: VelocityEstimator> {
    scene: AnyScene,
    scene_state: SceneState,
    shared: Shared<L, H>,
    origin: Count,
    /// Set by a swap until the next tick.
    swapped: bool,
    /// What was added to the currents, large and small, A.
    added: [f32; 2],
    applied: Currents,
}

#[derive(Clone)]
struct Shared<L: VelocityEstimator, H: VelocityEstimator> {
    large: L::State,
    continuous: ContinuousState,
    handle: H::State,
    transient: TransientState,
    /// Which of them ran in the last tick: the continuous stage, the handle's estimator, the
    /// transient stage.
    live: [bool; 3],
}

/// Time constant with which a difference at a swap fades, s.
const FADE_S: f64 = 0.02;

impl<L: VelocityEstimator, H: VelocityEstimator> SwitchboardState<L, H> {
    /// State of the large motor's estimator; it stands where it was while no scene needs it.
    #[must_use]
    pub const fn large(&self) -> &L::State {
        &self.shared.large
    }

    /// The same, to choose among estimators.
    pub const fn large_mut(&mut self) -> &mut L::State {
        &mut self.shared.large
    }

    /// Whether the large motor's estimator ran in the latest tick.
    #[must_use]
    pub const fn estimates_large(&self) -> bool {
        self.shared.live[0]
    }
}

impl<L, H> Switchboard<L, H>
where
    L: VelocityEstimator<Output = CountsPerTick>,
    H: AccelerationEstimator<Output = CountsPerTick>,
{
    /// A controller on `rig`, which was designed for `rate`.
    pub const fn new(large: L, handle: H, rig: Rig, rate: Hertz) -> Self {
        Self {
            large,
            handle,
            rig,
            fade: (1.0 / (FADE_S * rate.0 + 1.0)) as f32,
        }
    }

    /// State at the first sample, with [`Off`]; angles count from there.
    pub fn start(&self, first: &Sample) -> SwitchboardState<L, H> {
        SwitchboardState {
            scene: AnyScene::Off(Off),
            scene_state: SceneState::Nothing,
            shared: Shared {
                large: self.large.start(first),
                continuous: self.rig.continuous.start(RadPerS(0.0)),
                handle: self.handle.start(&Sample::new(first.small)),
                transient: TransientState::default(),
                live: [false; 3],
            },
            origin: first.small,
            swapped: false,
            added: [0.0; 2],
            applied: Currents::default(),
        }
    }

    /// Begins again at this sample, as at the first; the choice among estimators stays.
    pub fn restart(&self, state: &mut SwitchboardState<L, H>, first: &Sample) {
        let mut fresh = self.start(first);
        self.large.restart(&mut state.shared.large, first);
        fresh.shared.large.clone_from(&state.shared.large);
        *state = fresh;
    }

    /// Swaps the scene before the next tick; `sample` is the latest.
    pub fn select(&self, state: &mut SwitchboardState<L, H>, scene: AnyScene, sample: &Sample) {
        let angle = self.rig.angle.of(sample.small - state.origin);
        state.scene_state = match &scene {
            AnyScene::Texture(texture) => SceneState::Phase(texture.start(angle)),
            AnyScene::Hold(hold) => SceneState::Start(hold.start(angle)),
            AnyScene::Excite(excite) => SceneState::Excite(excite.start(angle)),
            _ => SceneState::Nothing,
        };
        state.scene = scene;
        state.swapped = true;
    }

    /// Changes the parameters of the scene that is on, before the next tick: what it carries from
    /// tick to tick goes on. Another scene than the one that is on is not taken.
    pub fn retune(&self, state: &mut SwitchboardState<L, H>, scene: AnyScene) {
        if core::mem::discriminant(&state.scene) == core::mem::discriminant(&scene) {
            state.scene = scene;
            state.swapped = true;
        }
    }

    /// One tick.
    pub fn step(&self, state: &mut SwitchboardState<L, H>, sample: &Sample) -> Action {
        let SwitchboardState {
            scene,
            scene_state,
            shared,
            origin,
            ..
        } = state;
        let angle = self.rig.angle.of(sample.small - *origin);
        let mut action = match (scene, scene_state) {
            (AnyScene::FreeAir(scene), _) => self.run(scene, &mut (), shared, angle, sample),
            (AnyScene::Wall(scene), _) => self.run(scene, &mut (), shared, angle, sample),
            (AnyScene::SpringDamper(scene), _) => self.run(scene, &mut (), shared, angle, sample),
            (AnyScene::Viscous(scene), _) => self.run(scene, &mut (), shared, angle, sample),
            (AnyScene::Detents(scene), _) => self.run(scene, &mut (), shared, angle, sample),
            (AnyScene::Torque(scene), _) => self.run(scene, &mut (), shared, angle, sample),
            (AnyScene::Inertia(scene), _) => self.run(scene, &mut (), shared, angle, sample),
            (AnyScene::Texture(scene), SceneState::Phase(phase)) => {
                self.run(scene, phase, shared, angle, sample)
            }
            (AnyScene::Hold(scene), SceneState::Start(start)) => {
                self.run(scene, start, shared, angle, sample)
            }
            (AnyScene::Excite(scene), SceneState::Excite(state)) => {
                self.run(scene, state, shared, angle, sample)
            }
            // A scene whose state is another's cannot come from `select`; it is off.
            (
                AnyScene::Off(_) | AnyScene::Texture(_) | AnyScene::Hold(_) | AnyScene::Excite(_),
                _,
            ) => self.run(&Off, &mut (), shared, angle, sample),
        };
        action.currents = self.faded(state, action.currents);
        action
    }

    /// The currents with what is left of the last swap's difference, within their limits.
    fn faded(&self, state: &mut SwitchboardState<L, H>, wanted: Currents) -> Currents {
        let wanted = [wanted.large.get(), wanted.small.get()];
        let before = [state.applied.large.get(), state.applied.small.get()];
        let largest = [
            self.rig.continuous.largest_current(),
            self.rig.transient.largest_current(),
        ];
        let mut applied = [0.0; 2];
        for (i, applied) in applied.iter_mut().enumerate() {
            if state.swapped {
                state.added[i] = before[i] - wanted[i];
            }
            *applied = within(wanted[i] + state.added[i], -largest[i], largest[i]);
            state.added[i] -= self.fade * state.added[i];
        }
        state.swapped = false;
        let [large, small] = applied.map(Amps::new);
        state.applied = Currents { large, small };
        state.applied
    }

    fn run<S: Scene<Acceleration: Senses<H>>>(
        &self,
        scene: &S,
        scene_state: &mut S::State,
        shared: &mut Shared<L, H>,
        angle: Radians,
        sample: &Sample,
    ) -> Action {
        let wanted = [
            S::Continuous::WANTED,
            HandleNeed::<S>::WANTED,
            S::Transient::WANTED,
        ];
        if wanted[0] && !shared.live[0] {
            self.large.restart(&mut shared.large, sample);
            shared.continuous = self.rig.continuous.start(RadPerS(0.0));
        }
        if wanted[1] && !shared.live[1] {
            shared.handle = self.handle.start(&Sample::new(sample.small));
        }
        if wanted[2] && !shared.live[2] {
            shared.transient = TransientState::default();
        }
        shared.live = wanted;
        let parts: Parts<'_, S, L, H> = Parts {
            continuous: S::Continuous::zip(
                S::Continuous::lend(&mut shared.large),
                S::Continuous::lend(&mut shared.continuous),
                |estimated, state| Continuous {
                    large: Estimated {
                        estimator: &self.large,
                        state: estimated,
                        scale: self.rig.large,
                    },
                    stage: &self.rig.continuous,
                    state,
                },
            ),
            handle: HandleNeed::<S>::map(HandleNeed::<S>::lend(&mut shared.handle), |state| {
                Estimated {
                    estimator: &self.handle,
                    state,
                    scale: self.rig.handle,
                }
            }),
            acceleration: S::Acceleration::make(|| self.rig.acceleration),
            transient: S::Transient::map(S::Transient::lend(&mut shared.transient), |state| {
                Transient {
                    stage: &self.rig.transient,
                    state,
                }
            }),
        };
        tick(scene, scene_state, parts, angle, sample)
    }
}
