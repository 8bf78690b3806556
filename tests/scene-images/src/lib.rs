//! The controller of each scene alone, in a module named after the scene. The example `all` is the
//! switchboard of all scenes, a library of its own so that it shares no code with them. The test
//! `scene_images` builds both for the board and reads code and memory of each.
//!
//! `large_*` and `handle_*` are in an image exactly if the scene needs them. They are never inlined,
//! so that the test finds their names.
#![no_std]

pub use estimator_core::Sample;
use estimator_core::{
    AccelerationEstimator, CountsPerTick, CountsPerTickSquared, EndFit, Foaw, Hertz, Model,
    Signals, SteadyKalman, SteadyKalmanTriple, VelocityEstimator, preset,
};
pub use haptic_control::{Action, Controller, ControllerState};
use haptic_control::{DualStage, LoopPoles, Rig};

/// Control rate.
pub const RATE: Hertz = Hertz(10_000.0);

/// The default device at that rate.
pub const RIG: Rig = preset!(Rig::new(&DualStage::DEFAULT, RATE, LoopPoles::DEFAULT));

type LargeEstimator = Foaw<15, EndFit>;
type HandleEstimator = SteadyKalmanTriple;

/// The estimator of the large motor.
pub struct Large(LargeEstimator);

/// The estimator of the handle.
pub struct OfHandle(HandleEstimator);

/// First-order adaptive windowing over 15 intervals, end-fit.
pub const LARGE: Large = Large(preset!(Foaw::new(15, 1)));

/// Triple integrator with its steady gain.
pub const HANDLE: OfHandle = OfHandle(preset!(SteadyKalman::new(&preset!(
    Model::triple_integrator(DualStage::DEFAULT.small.counts_per_rev, RATE, 2e4)
))));

/// Starts the estimator of the large motor.
#[inline(never)]
pub fn large_start(
    estimator: &LargeEstimator,
    first: &Sample,
) -> <LargeEstimator as VelocityEstimator>::State {
    estimator.start(first)
}

/// Updates the estimator of the large motor.
#[inline(never)]
pub fn large_update(
    estimator: &LargeEstimator,
    state: &mut <LargeEstimator as VelocityEstimator>::State,
    sample: &Sample,
) -> CountsPerTick {
    estimator.update(state, sample)
}

/// Starts the estimator of the handle.
#[inline(never)]
pub fn handle_start(
    estimator: &HandleEstimator,
    first: &Sample,
) -> <HandleEstimator as VelocityEstimator>::State {
    estimator.start(first)
}

/// Updates the estimator of the handle.
#[inline(never)]
pub fn handle_update(
    estimator: &HandleEstimator,
    state: &mut <HandleEstimator as VelocityEstimator>::State,
    sample: &Sample,
) -> CountsPerTick {
    estimator.update(state, sample)
}

impl VelocityEstimator for Large {
    type State = <LargeEstimator as VelocityEstimator>::State;
    const NEEDS: Signals = LargeEstimator::NEEDS;

    #[inline]
    fn start(&self, first: &Sample) -> Self::State {
        large_start(&self.0, first)
    }

    #[inline]
    fn update(&self, state: &mut Self::State, sample: &Sample) -> CountsPerTick {
        large_update(&self.0, state, sample)
    }
}

impl AccelerationEstimator for OfHandle {
    #[inline]
    fn acceleration(&self, state: &Self::State) -> CountsPerTickSquared {
        self.0.acceleration(state)
    }
}

impl VelocityEstimator for OfHandle {
    type State = <HandleEstimator as VelocityEstimator>::State;
    const NEEDS: Signals = HandleEstimator::NEEDS;

    #[inline]
    fn start(&self, first: &Sample) -> Self::State {
        handle_start(&self.0, first)
    }

    #[inline]
    fn update(&self, state: &mut Self::State, sample: &Sample) -> CountsPerTick {
        handle_update(&self.0, state, sample)
    }
}

macro_rules! images {
    ($($number:literal, $name:literal, $scene:ident, $facts:tt;)+) => {$(
        #[doc = concat!("The scene ", $name, " alone.")]
        ///
        /// The controller is in memory, as where a scene can be tuned: its parameters are not
        /// constants in the code.
        #[allow(non_snake_case, reason = "named after the type of the scene")]
        pub mod $scene {
            use estimator_core::preset;
            use haptic_control::{DualStage, $scene as Scene};

            use crate::{
                Action, Controller, ControllerState, HANDLE, LARGE, Large, OfHandle, RATE, RIG,
                Sample,
            };

            type OfScene = Controller<Scene, Large, OfHandle>;
            type State = ControllerState<Scene, Large, OfHandle>;

            const SCENE: Scene = preset!(Scene::usual(&DualStage::DEFAULT, RATE));

            /// Bytes of the controller and of its state.
            pub static RAM: [usize; 2] = [size_of::<OfScene>(), size_of::<State>()];

            /// Makes the controller.
            #[inline(never)]
            pub fn make() -> OfScene {
                Controller::new(SCENE, LARGE, HANDLE, &RIG)
            }

            /// Starts it.
            #[inline(never)]
            pub fn start(controller: &OfScene, first: &Sample) -> State {
                controller.start(first)
            }

            /// One tick.
            #[inline(never)]
            pub fn step(controller: &OfScene, state: &mut State, sample: &Sample) -> Action {
                controller.step(state, sample)
            }
        }
    )+};
}
haptic_control::scenes!(images);
