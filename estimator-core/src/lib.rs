//! Velocity estimation from quadrature encoder counts: `no_std`, no allocation, no panics.
//!
//! The same code runs in a control interrupt, in the host simulation and in the replay of a
//! recording. Arithmetic is integers and f32 `+ - * /` only, so all of them agree bit for bit.
//!
//! * An estimator is a set of immutable parameters; its state is apart and begins with a sample,
//!   so there is no state that was never initialised and no jump at the first tick.
//! * Positions are integers modulo 2^32 ([`Count`]); floats see differences only.
//! * Inside, everything is in counts and ticks. Physical units enter once, through [`Scale`].
//! * An estimator may say how far off its velocity may be: [`Confidence`].
//! * Parameters come from `const fn` that return a [`DesignError`]; [`preset!`] turns that into a
//!   build error.
//!
//! | estimator | type | state | reads |
//! |---|---|---|---|
//! | finite difference (eq. 4) | [`FiniteDifference`] | 1 count | counts |
//! | first-order low-pass over another | [`LowPass`] | 1 float | as the other |
//! | FOAW, end-fit or best-fit (eqs. 5 to 8) | [`Foaw`] | a ring of counts | counts |
//! | Kalman, full covariance | [`Kalman`] | x, P | counts; current with [`Model::motor`] |
//! | Kalman, preset gain table | [`TableKalman`] | x, 1 index | the same |
//! | Kalman, preset steady gain | [`SteadyKalman`] | x | the same |
//! | alpha-beta-gamma filter with fading memory | [`AlphaBetaGamma`] | 3 floats | counts |
//! | critically damped tracking loop | [`Pll`] | 2 floats | counts |
//! | M/T from edge time stamps | [`MOverT`] | 1 edge | counts, edges |
//! | observer with friction and slip | [`Observer`] | 4 floats | counts; as built: current, small count, edges |
//! | the same, hearing counts inside their cell | [`SoftObserver`] | 9 floats | the same |
//! | the same, learning its parameters | [`AdaptiveObserver`] | 23 floats | the same |
//! | two, exchanged while they run | [`Handover`] | as the one in charge | as both |
//! | none | [`Skip`] | none | nothing |
//!
//! ```
//! use estimator_core::{Count, EndFit, Foaw, Hertz, Sample, Scale, VelocityEstimator, preset};
//!
//! const FOAW: Foaw<15, EndFit> = preset!(Foaw::new(15, 1)); // checked at compile time
//! const SCALE: Scale = preset!(Scale::new(4096, Hertz(1000.0)));
//!
//! let mut state = FOAW.start(&Sample::new(Count(0)));
//! let mut omega = 0.0;
//! for counts in [3, 7, 10, 14, 17, 21u32] {
//!     omega = FOAW.update(&mut state, &Sample::new(Count(counts))).rad_per_s(&SCALE);
//! }
//! assert!((omega - 3.5 * 1.533_981).abs() < 1e-5); // 3.5 counts a tick
//! assert_eq!(state.window(), 6);
//! ```
#![no_std]
#![allow(
    clippy::needless_range_loop,
    reason = "matrix code reads as its equations, with indices"
)]
#![allow(
    clippy::neg_cmp_op_on_partial_ord,
    reason = "a NaN has to fail these comparisons"
)]

mod alpha_beta_gamma;
mod branch;
mod confidence;
pub mod const_math;
mod coupled_motor;
mod design_error;
mod device;
mod edge_clock;
mod estimator;
mod finite_difference;
mod foaw;
mod handover;
mod held_motor;
mod kalman;
mod late_current;
mod low_pass;
mod m_over_t;
mod model;
mod observer;
mod pll;
mod riccati;
mod sample;
mod steady_kalman;
mod table_kalman;
mod triple_integrator;
mod units;

pub use alpha_beta_gamma::{AlphaBetaGamma, AlphaBetaGammaState};
pub use confidence::{Confidence, Variance};
pub use coupled_motor::CoupledMotor;
pub use design_error::DesignError;
pub use device::Device;
pub use estimator::{AccelerationEstimator, Skip, VelocityEstimator};
pub use finite_difference::FiniteDifference;
pub use foaw::{BestFit, EndFit, Fit, Foaw, FoawState};
pub use handover::{Handover, HandoverState, Side};
pub use held_motor::CurrentInput;
pub use kalman::{Kalman, KalmanMotor, KalmanState, KalmanTriple};
pub use late_current::{LateCurrent, LateCurrentState};
pub use low_pass::{LowPass, LowPassState};
pub use m_over_t::{MOverT, MOverTState};
pub use model::{Input, Model};
pub use observer::{
    AdaptiveEdgeObserver, AdaptiveObserver, AdaptiveSoftObserver, AmplifierCurrent, Bell, Cells,
    Correction, CountObserver, CurrentSource, Deviations, EdgeObserver, Edges, EdgesState, Fixed,
    Gain, HeldHandle, Learned, LearnedState, Learning, NoCurrent, Observer, ObserverState,
    SlipSource, SmallEncoder, SoftCells, SoftCellsState, SoftObserver, Uncertainty,
};
pub use pll::{Pll, PllState};
pub use sample::{Edge, Sample, Signals};
pub use steady_kalman::{SteadyKalman, SteadyKalmanMotor, SteadyKalmanState, SteadyKalmanTriple};
pub use table_kalman::{TableKalman, TableKalmanMotor, TableKalmanState, TableKalmanTriple};
pub use triple_integrator::NoInput;
pub use units::{
    Amps, ClockTicks, Count, Counts, CountsPerTick, CountsPerTickSquared, Hertz, Scale,
};

/// The README's example, compiled.
#[cfg(doctest)]
#[doc = include_str!("../../README.md")]
struct Readme;
