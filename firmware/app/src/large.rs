//! Estimators of the large motor's velocity: all that images have, and the choice of one image.

use core::convert::Infallible;

use estimator_core::{
    AdaptiveEdgeObserver, AdaptiveObserver, Confidence, EndFit, Foaw, Handover, HandoverState,
    Model, NoInput, ObserverDesign, ParameterErrors, Side, Skip, SteadyKalman, SteadyKalmanTriple,
    preset,
};

use crate::ammeter::{Ammeter, Measure};
use crate::config::{DEVICE, RATE, TIMERS};

/// Names of the estimators of [`Both`] in the catalogue of estimators, each at its number.
pub const NAMES: [&str; 2] = ["foaw-end-fit", "kalman-triple-steady"];

/// Names of [`Adaptive`] and [`AdaptiveEdge`] in the catalogue of estimators.
pub const LEARNING: [&str; 2] = ["adaptive", "adaptive-edge"];

/// Longest window of [`Window`], intervals.
pub const INTERVALS: usize = tuned::image("large", NAMES[0], RATE, "n") as usize;
// The build script knows the count of this window alone.
#[cfg(rate_is_checked)]
const _: () = match usize::from_str_radix(env!("COUNTED_WINDOW"), 10) {
    Ok(counted) => assert!(
        INTERVALS <= counted,
        "at this RATE, a window n of at most that with which the control task was counted"
    ),
    Err(_) => panic!("COUNTED_WINDOW"),
};
/// FOAW over at most [`INTERVALS`].
pub type Window = Foaw<INTERVALS, EndFit>;
/// The parameters of [`Window`].
pub const WINDOW: Window = preset!(Foaw::new(
    INTERVALS,
    tuned::image("large", NAMES[0], RATE, "d") as u16
));

/// A steady-state Kalman filter.
pub type Filter = SteadyKalmanTriple;
const MODEL: Model<3, NoInput> = preset!(Model::triple_integrator(
    DEVICE.large.counts_per_rev,
    RATE,
    tuned::image("large", NAMES[1], RATE, "jerk")
));
/// The parameters of [`Filter`].
pub const FILTER: Filter = preset!(SteadyKalman::new(&MODEL));

/// [`Window`], number 0, and [`Filter`], number 1, exchanged by command.
pub type Both = Handover<Window, Filter>;
/// 20 ms: the filter has settled by then, and the difference of the two velocities fades in more
/// slowly than a fingertip feels best.
const TICKS: u16 = (RATE.0 / 50.0) as u16;
/// The parameters of [`Both`].
pub const BOTH: Both = preset!(Handover::new(WINDOW, FILTER, TICKS, TICKS));

const fn observer(tuned_as: &str) -> ObserverDesign {
    let uncertainty = tuned::uncertainty(tuned_as, RATE);
    let mut motor = DEVICE.coupled_motor();
    if <Ammeter as Measure>::WANTED {
        // A measured current has the amplifier's lag in it.
        motor.amplifier_lag = 0.0;
    }
    ObserverDesign::new(&motor, RATE, &uncertainty)
}

/// An observer that learns damping, friction and torque constant from counts.
pub type Adaptive = AdaptiveObserver;
/// The parameters of [`Adaptive`], as tuned for the plant with friction.
pub const ADAPTIVE: Adaptive = preset!(observer(LEARNING[0]).adaptive().build());

/// An observer that learns damping, friction and torque constant from stamped edges.
pub type AdaptiveEdge = AdaptiveEdgeObserver;
/// The parameters of [`AdaptiveEdge`], as tuned for the plant with friction.
pub const ADAPTIVE_EDGE: AdaptiveEdge =
    preset!(observer(LEARNING[1]).with_edges(TIMERS).adaptive().build());

#[cfg(all(feature = "large-adaptive", not(feature = "edge-capture")))]
pub use self::{ADAPTIVE as LARGE, Adaptive as Large};
#[cfg(all(feature = "large-adaptive", feature = "edge-capture"))]
pub use self::{ADAPTIVE_EDGE as LARGE, AdaptiveEdge as Large};
#[cfg(not(any(
    feature = "large-foaw",
    feature = "large-kalman",
    feature = "large-adaptive"
)))]
pub use self::{BOTH as LARGE, Both as Large};
#[cfg(feature = "large-kalman")]
pub use self::{FILTER as LARGE, Filter as Large};
#[cfg(feature = "large-foaw")]
pub use self::{WINDOW as LARGE, Window as Large};

#[cfg(any(
    all(feature = "large-foaw", feature = "large-kalman"),
    all(feature = "large-foaw", feature = "large-adaptive"),
    all(feature = "large-kalman", feature = "large-adaptive")
))]
compile_error!("one estimator for the large motor: large-foaw, large-kalman or large-adaptive");

/// The choice between estimators that an image has.
pub type Choice = <Large as LargeEstimator>::Choice;
/// The parameter errors that an image learns.
pub type Learned = <Large as LargeEstimator>::Learned;

/// An estimator for the large motor of an image.
pub trait LargeEstimator: Confidence {
    /// A choice between estimators.
    type Choice: Copy;
    /// Learned parameter errors: [`ParameterErrors`], or [`Skip`] for an estimator that learns nothing.
    type Learned: Learnable;

    /// The choice of this number, if there is one.
    fn choice(number: u8) -> Option<Self::Choice>;

    /// Puts the chosen estimator in charge.
    fn choose(state: &mut Self::State, choice: Self::Choice);

    /// Number of the estimator in charge; `None` while one takes over.
    fn in_charge(state: &Self::State) -> Option<u8>;

    /// The learned parameters.
    fn learned(&self, state: &Self::State) -> Self::Learned;
}

impl LargeEstimator for Both {
    type Choice = Side;
    type Learned = Skip;

    fn choice(number: u8) -> Option<Side> {
        match number {
            0 => Some(Side::First),
            1 => Some(Side::Second),
            _ => None,
        }
    }

    fn choose(state: &mut Self::State, choice: Side) {
        HandoverState::select(state, choice);
    }

    fn in_charge(state: &Self::State) -> Option<u8> {
        state.in_charge().map(|side| side as u8)
    }

    fn learned(&self, _: &Self::State) -> Skip {
        Skip
    }
}

/// One estimator: there is no choice, and no code for one.
macro_rules! alone {
    ($($estimator:ty, $learned:ty, |$it:ident, $state:ident| $what:expr;)+) => {$(
        impl LargeEstimator for $estimator {
            type Choice = Infallible;
            type Learned = $learned;

            fn choice(_: u8) -> Option<Infallible> {
                None
            }

            fn choose(_: &mut Self::State, choice: Infallible) {
                match choice {}
            }

            fn in_charge(_: &Self::State) -> Option<u8> {
                Some(0)
            }

            fn learned(&self, $state: &Self::State) -> $learned {
                let $it = self;
                $what
            }
        }
    )+};
}

alone! {
    Window, Skip, |_it, _state| Skip;
    Filter, Skip, |_it, _state| Skip;
    Adaptive, ParameterErrors, |it, state| it.parameter_errors(state);
    AdaptiveEdge, ParameterErrors, |it, state| it.parameter_errors(state);
}

/// Learned parameter errors, or nothing in their place.
pub trait Learnable: Copy + Default {
    /// The errors, if they are learned.
    fn deviations(&self) -> Option<ParameterErrors>;
}

/// Nothing is learned: no code.
impl Learnable for Skip {
    fn deviations(&self) -> Option<ParameterErrors> {
        None
    }
}

impl Learnable for ParameterErrors {
    fn deviations(&self) -> Option<ParameterErrors> {
        Some(*self)
    }
}
