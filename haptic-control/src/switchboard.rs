//! A controller of all scenes, one of which is active.

use estimator_core::{AccelerationEstimator, Amps, Count, Hertz, Sample, VelocityEstimator};

use crate::compensation::CompensationState;
use crate::limits::{CurrentScale, Currents, within};
use crate::need::{Need, Senses};
use crate::rig::Rig;
use crate::scene::*;
use crate::scenes;
use crate::stage::{ContinuousState, TransientState};
use crate::tick::{Action, Continuous, Estimated, HandleNeed, Parts, Transient, tick};
use crate::units::{RadPerS, Radians};

macro_rules! active_scene {
    ($($number:literal, $name:literal, $scene:ident, $facts:tt;)+) => {
        /// The active scene and its state.
        #[derive(Clone)]
        enum Active {
            $($scene($scene, <$scene as Scene>::State),)+
        }

        impl Active {
            /// `scene` with its initial state, for a handle at `angle`.
            fn start(scene: AnyScene, angle: Radians) -> Self {
                match scene {
                    $(AnyScene::$scene(scene) => Self::$scene(scene, scene.start(angle)),)+
                }
            }

            /// Changes the parameters and keeps the state; `false` if another scene is active.
            fn retune(&mut self, tuned: AnyScene) -> bool {
                match (self, tuned) {
                    $((Self::$scene(scene, _), AnyScene::$scene(tuned)) => *scene = tuned,)+
                    _ => return false,
                }
                true
            }
        }

        impl<L, H> Switchboard<L, H>
        where
            L: VelocityEstimator,
            H: AccelerationEstimator,
        {
            /// One tick of the active scene.
            // As a call of its own it costs a tick with `adaptive` 4 instructions.
            #[inline(always)]
            fn run_active(
                &self,
                active: &mut Active,
                shared: &mut Shared<L, H>,
                origin: Count,
                sample: &Sample,
            ) -> Action {
                match active {
                    $(Active::$scene(scene, state) => {
                        self.run(scene, state, shared, origin, sample)
                    })+
                }
            }
        }
    };
}
scenes!(active_scene);

/// The controller of all scenes. A tick runs one scene, and of the shared parts only those that the
/// scene needs.
///
/// The scene changes between two ticks. The difference of the currents before and after the change
/// is added to the new currents and fades with a time constant of 20 ms, so that the torque does
/// not jump. Changes in every tick are low-passed with this time constant, and so are the currents by
/// which the scene answers motion meanwhile. An estimator that both scenes need continues; one that the
/// scene before did not need starts at rest.
#[derive(Clone, Copy, Debug)]
pub struct Switchboard<L, H> {
    large: L,
    handle: H,
    rig: Rig,
    /// Ratio by which the added currents decrease in a tick.
    fade: f32,
}

/// State of a [`Switchboard`].
// What may be large comes last, so that a float load, which reaches 1020 bytes, reaches the rest.
#[derive(Clone)]
#[repr(C)]
pub struct SwitchboardState<L: VelocityEstimator, H: VelocityEstimator> {
    applied: Currents,
    /// Currents that are added to those of the large and the small motor after a change of scenes,
    /// A.
    added: [f32; 2],
    change: Change,
    origin: Count,
    active: Active,
    shared: Shared<L, H>,
}

/// What a change of scenes has left to do.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Change {
    /// Nothing.
    Over,
    /// The added currents fade.
    Fading,
    /// The scene was changed after the latest tick.
    New,
}

/// Parts that a tick runs, a bit each: one comparison finds a change.
#[derive(Clone, Copy, PartialEq, Eq)]
struct Live(u8);

impl Live {
    const NONE: Self = Self(0);
    const CONTINUOUS: u8 = 1;
    const HANDLE: u8 = 2;
    const TRANSIENT: u8 = 4;

    /// The parts that a scene needs.
    const fn of<S: Scene>() -> Self {
        let mut parts = 0;
        if S::Continuous::WANTED {
            parts |= Self::CONTINUOUS;
        }
        if HandleNeed::<S>::WANTED {
            parts |= Self::HANDLE;
        }
        if S::Transient::WANTED {
            parts |= Self::TRANSIENT;
        }
        Self(parts)
    }

    const fn has(self, part: u8) -> bool {
        self.0 & part != 0
    }

    /// Those of these parts that did not run in the tick `before`.
    const fn new_since(self, before: Self) -> Self {
        Self(self.0 & !before.0)
    }
}

#[derive(Clone)]
#[repr(C)]
struct Shared<L: VelocityEstimator, H: VelocityEstimator> {
    /// The parts that ran in the last tick.
    live: Live,
    transient: TransientState,
    compensated: CompensationState,
    continuous: ContinuousState,
    handle: H::State,
    large: L::State,
}

/// Time constant with which the difference of the currents at a change of scenes fades, s.
const FADE_S: f64 = 0.02;
/// Added current below which the fade ends, A. A step of a 12-bit converter for ±1.5 A is 700 times larger.
const FADED: f32 = 1e-6;

impl<L: VelocityEstimator, H: VelocityEstimator> SwitchboardState<L, H> {
    /// Currents of the latest tick.
    #[must_use]
    pub const fn applied(&self) -> Currents {
        self.applied
    }

    /// Records that the latest tick applies no current.
    pub fn withhold(&mut self) {
        self.applied = Currents::default();
    }

    /// State of the large motor's estimator. It does not change while no scene needs it.
    #[must_use]
    pub const fn large(&self) -> &L::State {
        &self.shared.large
    }

    /// State of the large motor's estimator, to change the choice among several estimators.
    pub const fn large_mut(&mut self) -> &mut L::State {
        &mut self.shared.large
    }

    /// Whether the large motor's estimator ran in the latest tick.
    #[must_use]
    pub const fn estimates_large(&self) -> bool {
        self.shared.live.has(Live::CONTINUOUS)
    }
}

impl<L, H> Switchboard<L, H>
where
    L: VelocityEstimator,
    H: AccelerationEstimator,
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

    /// State at the first sample, with the scene [`Off`]. Angles are relative to this sample.
    pub fn start(&self, first: &Sample) -> SwitchboardState<L, H> {
        SwitchboardState {
            active: Active::Off(Off, ()),
            shared: Shared {
                large: self.large.start(first),
                continuous: self.rig.continuous.start(RadPerS(0.0)),
                handle: self.handle.start(&Sample::new(first.coupled)),
                transient: self.rig.transient.start(),
                compensated: self.rig.free.start(RadPerS(0.0)),
                live: Live::NONE,
            },
            origin: first.coupled,
            change: Change::Over,
            added: [0.0; 2],
            applied: Currents::default(),
        }
    }

    /// Restarts at this sample, as at the first one. The choice among several estimators and the scale
    /// of the currents do not change.
    pub fn restart(&self, state: &mut SwitchboardState<L, H>, first: &Sample) {
        let mut fresh = self.start(first);
        let Shared {
            large,
            continuous,
            transient,
            ..
        } = &mut state.shared;
        self.large.restart(large, first);
        fresh.shared.large.clone_from(large);
        self.rig.continuous.restart(continuous, RadPerS(0.0));
        fresh.shared.continuous = *continuous;
        self.rig.transient.restart(transient);
        fresh.shared.transient = *transient;
        *state = fresh;
    }

    /// Scales the limits of both currents, from the next tick on.
    pub fn scale(&self, state: &mut SwitchboardState<L, H>, scale: CurrentScale) {
        self.rig
            .continuous
            .scale(&mut state.shared.continuous, scale);
        self.rig.transient.scale(&mut state.shared.transient, scale);
    }

    /// Changes the scene before the next tick; `sample` is the latest sample.
    pub fn select(&self, state: &mut SwitchboardState<L, H>, scene: AnyScene, sample: &Sample) {
        let angle = self.rig.angle_scale.of(sample.coupled - state.origin);
        state.active = Active::start(scene, angle);
        state.change = Change::New;
    }

    /// Changes the parameters of the active scene before the next tick. The state of the scene
    /// continues. If another scene is active, nothing changes.
    pub fn retune(&self, state: &mut SwitchboardState<L, H>, scene: AnyScene) {
        if state.active.retune(scene) {
            state.change = Change::New;
        }
    }

    /// One tick.
    pub fn step(&self, state: &mut SwitchboardState<L, H>, sample: &Sample) -> Action {
        self.step_inlined(state, sample)
    }

    /// [`step`](Self::step) as a part of its caller. With an adaptive observer a tick takes some 20 instructions
    /// less then; with other estimators the call costs less than the registers.
    #[inline(always)]
    pub fn step_inlined(&self, state: &mut SwitchboardState<L, H>, sample: &Sample) -> Action {
        let mut action =
            self.run_active(&mut state.active, &mut state.shared, state.origin, sample);
        if state.change != Change::Over {
            action.currents = self.faded(state, action.currents);
        }
        state.applied = action.currents;
        action
    }

    /// The currents plus the rest of the difference at the last change of scenes, within the
    /// limits. It is a function of its own because few ticks call it.
    #[cold]
    #[inline(never)]
    fn faded(&self, state: &mut SwitchboardState<L, H>, wanted: Currents) -> Currents {
        let wanted = [wanted.large.get(), wanted.small.get()];
        let before = [state.applied.large.get(), state.applied.small.get()];
        let largest = [
            state.shared.continuous.largest_current(),
            state.shared.transient.largest_current(),
        ];
        let mut applied = [0.0; 2];
        for (i, applied) in applied.iter_mut().enumerate() {
            if state.change == Change::New {
                // An earlier change fades on: changes in every tick must not hold the currents where they are.
                let faded = before[i] - self.fade * state.added[i];
                state.added[i] = faded - wanted[i];
            }
            *applied = within(wanted[i] + state.added[i], -largest[i], largest[i]);
            state.added[i] -= self.fade * state.added[i];
        }
        state.change = if state.added.iter().all(|added| added.abs() < FADED) {
            Change::Over
        } else {
            Change::Fading
        };
        let [large, small] = applied.map(Amps::new);
        Currents { large, small }
    }

    /// Restarts the parts that this tick wants and the last one did not. It is a function of its own because
    /// few ticks call it.
    #[cold]
    #[inline(never)]
    fn wake(&self, shared: &mut Shared<L, H>, wanted: Live, sample: &Sample) {
        let new = wanted.new_since(shared.live);
        if new.has(Live::CONTINUOUS) {
            self.large.restart(&mut shared.large, sample);
            let stage = &self.rig.continuous;
            stage.restart(&mut shared.continuous, RadPerS(0.0));
            shared.compensated = self.rig.free.start(RadPerS(0.0));
        }
        if new.has(Live::HANDLE) {
            shared.handle = self.handle.start(&Sample::new(sample.coupled));
        }
        if new.has(Live::TRANSIENT) {
            self.rig.transient.restart(&mut shared.transient);
        }
        shared.live = wanted;
    }

    fn run<S: Scene<Acceleration: Senses<H>>>(
        &self,
        scene: &S,
        scene_state: &mut S::State,
        shared: &mut Shared<L, H>,
        origin: Count,
        sample: &Sample,
    ) -> Action {
        let wanted = const { Live::of::<S>() };
        if shared.live != wanted {
            self.wake(shared, wanted, sample);
        }
        // The stages limit their currents, an open loop does not.
        let largest = [
            shared.continuous.largest_current(),
            shared.transient.largest_current(),
        ];
        let parts: Parts<'_, S, L, H> = Parts {
            continuous: S::Continuous::zip(
                S::Continuous::zip(
                    S::Continuous::lend(&mut shared.large),
                    S::Continuous::lend(&mut shared.compensated),
                    |estimated, compensated| (estimated, compensated),
                ),
                S::Continuous::lend(&mut shared.continuous),
                |(estimated, compensated), state| Continuous {
                    large: Estimated {
                        estimator: &self.large,
                        state: estimated,
                        scale: self.rig.large_scale,
                    },
                    compensation: self.rig.compensation::<S>(),
                    compensated,
                    stage: &self.rig.continuous,
                    state,
                },
            ),
            handle: HandleNeed::<S>::map(HandleNeed::<S>::lend(&mut shared.handle), |state| {
                Estimated {
                    estimator: &self.handle,
                    state,
                    scale: self.rig.handle_scale,
                }
            }),
            acceleration: S::Acceleration::make(|| self.rig.acceleration_scale),
            transient: S::Transient::map(S::Transient::lend(&mut shared.transient), |state| {
                Transient {
                    stage: &self.rig.transient,
                    state,
                }
            }),
        };
        let angle = self.rig.angle_scale.of(sample.coupled - origin);
        let mut action = tick(scene, scene_state, parts, angle, sample);
        if S::open_loop(scene_state).is_some() {
            action.currents = action.currents.within(largest);
        }
        action
    }
}
