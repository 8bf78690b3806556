//! Velocity estimation from quadrature encoder counts: `no_std`, no allocation, no panics.
//!
//! The same code runs in a control interrupt, in a host simulation and in the replay of a
//! recording. It computes with integers and f32 `+ - * /` only, so all of them agree bit for bit.
//!
//! * An estimator is a set of immutable parameters. Its state is a separate value, made from the
//!   first sample, so no state is uninitialised and the first update has no jump.
//! * Positions are integers modulo 2^32 ([`Count`]). Floats hold differences only.
//! * Internal quantities are in counts and ticks; one tick is one control period T. Physical units
//!   are converted once, by [`Scale`].
//! * [`Confidence`] gives the variance of an estimate.
//! * [`VaryingPeriod`] takes samples at uneven times.
//! * Constructors are `const fn` and return a [`DesignError`] that names the parameter. [`preset!`]
//!   turns it into a build error.
//! * The traits [`VelocityEstimator`], [`VaryingPeriod`], [`AccelerationEstimator`] and
//!   [`Confidence`] may be implemented by any crate. The traits of an estimator's parts ([`Fit`], [`Input`],
//!   [`CurrentSource`], [`SlipSource`], [`Correction`], [`Adaptation`]) are sealed.
//!
//! The page of [`VelocityEstimator`] lists the estimators under its implementors. Each type documents its
//! recurrence, units, valid range and errors; the README says which one to take for which signals.
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
    reason = "a NaN must fail these comparisons"
)]

mod bank;
mod branch;
mod confidence;
mod design;
mod edge_clock;
mod estimator;
mod filters;
mod interval;
mod memory;
mod models;
mod observer;
mod sample;
mod sealed;
mod units;
mod wrapped;

pub use bank::{
    BankInput, DrivenBank, DrivenBankState, Followed, Imm, ImmAdaptive, ImmAdaptiveEdge, ImmEdge,
    ImmMotor, ImmMotorEdge, ImmPair, LearnedCurrent, LearnedCurrentState, ModelBank,
    ModelBankState, NoStamps, Stamped, Stamps,
};
pub use confidence::{Confidence, Variance};
pub use design::{DesignError, const_math};
pub use estimator::{AccelerationEstimator, Skip, VaryingPeriod, VelocityEstimator};
pub use filters::*;
pub use memory::Memory;
pub use models::{CoupledMotor, CurrentInput, Input, Model, MotorModel, NoInput};
pub use observer::{
    Adaptation, Adaptive, AdaptiveEdgeHeldObserver, AdaptiveEdgeObserver, AdaptiveHeldObserver,
    AdaptiveObserver, AdaptiveQuantisedObserver, AdaptiveState, AmplifierCurrent, Correction,
    CountObserver, CountUpdate, CoupledEncoder, Covariance, CurrentSource, EdgeObserver,
    EdgeUpdate, EdgeUpdateState, Fixed, Gain, HeldShaft, Narrow, NoCurrent, Observer,
    ObserverDesign, ObserverState, ParameterErrors, QuantisedObserver, QuantisedUpdate,
    QuantisedUpdateState, Range, SlipSource, Uncertainty, Wide,
};
pub use sample::{Edge, Sample, Signals};
pub use units::{
    Amps, ClockTicks, Count, Counts, CountsPerTick, CountsPerTickSquared, Hertz, Scale,
};
pub use wrapped::WrapError;

#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
