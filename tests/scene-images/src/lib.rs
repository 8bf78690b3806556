//! What the libraries in `examples/` share, each of which holds the controller of one scene; built
//! for the board and read by the test `scene_images`.
//!
//! Names matter: `large_*` and `handle_*` are in an image exactly if the scene needs them. They are
//! never inlined, so that the reader finds them.
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
    type Output = CountsPerTick;
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
    type Output = CountsPerTick;
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

/// The image of one scene: all that firmware calls of its controller, and what it weighs in RAM.
///
/// The controller lies in memory, as where a scene can be tuned: its parameters are not folded into
/// the code.
#[macro_export]
macro_rules! image {
    ($scene:ty = $value:expr) => {
        type OfScene = $crate::Controller<$scene, $crate::Large, $crate::OfHandle>;
        type State = $crate::ControllerState<$scene, $crate::Large, $crate::OfHandle>;

        const SCENE: $scene = $value;

        /// Bytes of the controller and of its state.
        pub static RAM: [usize; 2] = [size_of::<OfScene>(), size_of::<State>()];

        /// Makes the controller.
        #[inline(never)]
        pub fn make() -> OfScene {
            $crate::Controller::new(SCENE, $crate::LARGE, $crate::HANDLE, &$crate::RIG)
        }

        /// Starts it.
        #[inline(never)]
        pub fn start(controller: &OfScene, first: &$crate::Sample) -> State {
            controller.start(first)
        }

        /// One tick.
        #[inline(never)]
        pub fn step(
            controller: &OfScene,
            state: &mut State,
            sample: &$crate::Sample,
        ) -> $crate::Action {
            controller.step(state, sample)
        }
    };
}
