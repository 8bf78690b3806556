//! A controller of one scene, with only the parts that the scene needs.

use estimator_core::{Count, Sample, Scale, VelocityEstimator};

use crate::compensation::{Compensation, CompensationState};
use crate::limits::CurrentScale;
use crate::need::{Need, Senses};
use crate::rig::{AccelerationScale, AngleScale, Rig};
use crate::scene::Scene;
use crate::stage::{ContinuousStage, ContinuousState, TransientStage, TransientState};
use crate::tick::{Action, Continuous, Estimated, HandleNeed, Parts, Transient, tick};
use crate::units::{RadPerS, Radians};

type Of<N, T> = <N as Need>::Of<T>;

/// The controller of one scene `S`, with the estimators `L` of the large motor and `H` of the
/// handle: counts in, currents out, one pure step a tick.
///
/// The controller has the parameters; its state is a [`ControllerState`]. A part that `S` does not
/// need is `()`, which takes no memory and no code.
///
/// ```
/// use estimator_core::*;
/// use haptic_control::*;
/// const RATE: Hertz = Hertz(10e3);
/// const RIG: Rig = preset!(Rig::new(&DualStage::DEFAULT, RATE, LoopPoles::DEFAULT));
/// const LOOP: Pll = preset!(Pll::new(Hertz(100.0), RATE));
/// const WALL: Wall = preset!(Wall::new(Radians(0.1), 0.30, 0.0));
///
/// let wall = Controller::new(WALL, LOOP, LOOP, &RIG);
/// let mut state = wall.start(&Sample::default());
/// // 1000 counts are 0.314 rad, which is 0.214 rad into the wall: the torque is -64 mN.m.
/// let inside = Sample::default().with_coupled(Count(1000));
/// let action = wall.step(&mut state, &inside);
/// assert!((action.torque.0 + 0.0642).abs() < 1e-4 && action.currents.small.get() < 0.0);
///
/// // The controller of a scene that needs no part has the position of the first sample as state.
/// let off = Controller::new(Off, LOOP, LOOP, &RIG);
/// assert_eq!(size_of_val(&off.start(&inside)), size_of::<Count>());
/// ```
pub struct Controller<S: Scene, L, H> {
    scene: S,
    continuous: Of<S::Continuous, (L, Scale, ContinuousStage, Compensation)>,
    handle: Of<HandleNeed<S>, (H, Scale)>,
    acceleration: Of<S::Acceleration, AccelerationScale>,
    transient: Of<S::Transient, TransientStage>,
    angle: AngleScale,
}

/// State of a [`Controller`].
pub struct ControllerState<S: Scene, L: VelocityEstimator, H: VelocityEstimator> {
    scene: S::State,
    continuous: Of<S::Continuous, (L::State, ContinuousState, CompensationState)>,
    handle: Of<HandleNeed<S>, H::State>,
    transient: Of<S::Transient, TransientState>,
    origin: Count,
}

impl<S: Scene, L: VelocityEstimator, H: VelocityEstimator> ControllerState<S, L, H> {
    /// State of the large motor's estimator, if the scene needs one.
    #[must_use]
    pub fn large(&self) -> Option<&L::State> {
        let large = S::Continuous::map(S::Continuous::as_ref(&self.continuous), |(large, ..)| {
            Some(large)
        });
        S::Continuous::or(large, None)
    }

    /// State of the large motor's estimator, to change the choice among several estimators.
    pub fn large_mut(&mut self) -> Option<&mut L::State> {
        let large = S::Continuous::map(
            S::Continuous::as_mut(&mut self.continuous),
            |(large, ..)| Some(large),
        );
        S::Continuous::or(large, None)
    }
}

impl<S: Scene, L: VelocityEstimator, H: VelocityEstimator> Clone for ControllerState<S, L, H> {
    fn clone(&self) -> Self {
        Self {
            scene: self.scene.clone(),
            continuous: S::Continuous::copy(&self.continuous),
            handle: HandleNeed::<S>::copy(&self.handle),
            transient: S::Transient::copy(&self.transient),
            origin: self.origin,
        }
    }
}

impl<S: Scene, L: VelocityEstimator, H: VelocityEstimator> PartialEq for ControllerState<S, L, H> {
    fn eq(&self, other: &Self) -> bool {
        self.scene == other.scene
            && S::Continuous::same(&self.continuous, &other.continuous)
            && HandleNeed::<S>::same(&self.handle, &other.handle)
            && S::Transient::same(&self.transient, &other.transient)
            && self.origin == other.origin
    }
}

impl<S, L, H> Controller<S, L, H>
where
    S: Scene<Acceleration: Senses<H>>,
    L: VelocityEstimator,
    H: VelocityEstimator,
{
    /// A controller for `scene` on `rig`. An estimator that the scene does not need is left out.
    pub fn new(scene: S, large: L, handle: H, rig: &Rig) -> Self {
        Self {
            scene,
            continuous: S::Continuous::make(|| {
                (
                    large,
                    rig.large_scale,
                    rig.continuous,
                    *rig.compensation::<S>(),
                )
            }),
            handle: HandleNeed::<S>::make(|| (handle, rig.handle_scale)),
            acceleration: S::Acceleration::make(|| rig.acceleration_scale),
            transient: S::Transient::make(|| rig.transient),
            angle: rig.angle_scale,
        }
    }

    /// State at rest at the first sample. Angles are relative to this sample.
    pub fn start(&self, first: &Sample) -> ControllerState<S, L, H> {
        let handle_sample = Sample::new(first.coupled);
        ControllerState {
            scene: self.scene.start(Radians(0.0)),
            continuous: S::Continuous::map(
                S::Continuous::as_ref(&self.continuous),
                |(large, _, stage, compensation)| {
                    let still = RadPerS(0.0);
                    (
                        large.start(first),
                        stage.start(still),
                        compensation.start(still),
                    )
                },
            ),
            handle: HandleNeed::<S>::map(HandleNeed::<S>::as_ref(&self.handle), |(handle, _)| {
                handle.start(&handle_sample)
            }),
            transient: S::Transient::map(
                S::Transient::as_ref(&self.transient),
                TransientStage::start,
            ),
            origin: first.coupled,
        }
    }

    /// Restarts at rest at this sample, to which angles are then relative. The choice among several
    /// estimators and the scale of the currents do not change.
    pub fn restart(&self, state: &mut ControllerState<S, L, H>, first: &Sample) {
        let mut fresh = self.start(first);
        S::Continuous::zip(
            S::Continuous::zip(
                S::Continuous::as_mut(&mut fresh.continuous),
                S::Continuous::as_mut(&mut state.continuous),
                |fresh, before| (fresh, before),
            ),
            S::Continuous::as_ref(&self.continuous),
            |(fresh, before), (large, _, stage, _)| {
                large.restart(&mut before.0, first);
                fresh.0.clone_from(&before.0);
                stage.restart(&mut before.1, RadPerS(0.0));
                fresh.1 = before.1;
            },
        );
        S::Transient::zip(
            S::Transient::zip(
                S::Transient::as_mut(&mut fresh.transient),
                S::Transient::as_mut(&mut state.transient),
                |fresh, before| (fresh, before),
            ),
            S::Transient::as_ref(&self.transient),
            |(fresh, before), stage| {
                stage.restart(before);
                *fresh = *before;
            },
        );
        *state = fresh;
    }

    /// Scales the limits of both currents, from the next tick on. The currents of an open loop have no
    /// limits here.
    pub fn scale(&self, state: &mut ControllerState<S, L, H>, scale: CurrentScale) {
        S::Continuous::zip(
            S::Continuous::as_ref(&self.continuous),
            S::Continuous::as_mut(&mut state.continuous),
            |(_, _, stage, _), (_, state, _)| stage.scale(state, scale),
        );
        S::Transient::zip(
            S::Transient::as_ref(&self.transient),
            S::Transient::as_mut(&mut state.transient),
            |stage, state| stage.scale(state, scale),
        );
    }

    /// Changes the scene's parameters before the next tick. The slew limit bounds the change of the
    /// currents.
    pub fn retune(&mut self, scene: S) {
        self.scene = scene;
    }

    /// One tick.
    pub fn step(&self, state: &mut ControllerState<S, L, H>, sample: &Sample) -> Action {
        let angle = self.angle.of(sample.coupled - state.origin);
        let parts = Parts {
            continuous: S::Continuous::zip(
                S::Continuous::as_ref(&self.continuous),
                S::Continuous::as_mut(&mut state.continuous),
                |(estimator, scale, stage, compensation), (estimated, state, compensated)| {
                    Continuous {
                        large: Estimated {
                            estimator,
                            state: estimated,
                            scale: *scale,
                        },
                        compensation,
                        compensated,
                        stage,
                        state,
                    }
                },
            ),
            handle: HandleNeed::<S>::zip(
                HandleNeed::<S>::as_ref(&self.handle),
                HandleNeed::<S>::as_mut(&mut state.handle),
                |(estimator, scale), state| Estimated {
                    estimator,
                    state,
                    scale: *scale,
                },
            ),
            acceleration: S::Acceleration::map(
                S::Acceleration::as_ref(&self.acceleration),
                |scale| *scale,
            ),
            transient: S::Transient::zip(
                S::Transient::as_ref(&self.transient),
                S::Transient::as_mut(&mut state.transient),
                |stage, state| Transient { stage, state },
            ),
        };
        tick(&self.scene, &mut state.scene, parts, angle, sample)
    }
}
