//! Dual-stage haptic control as one pure step: counts in, currents out, `no_std`.
//!
//! A [`Scene`] computes the torque that the handle should feel. Its types state its needs, see
//! [`Need`]; a [`Controller`] contains the scene and only the parts that the scene needs. A
//! [`Switchboard`] contains all scenes of the catalogue ([`scenes!`]), one of which is active. The
//! large motor renders the torque through the coupler, by a velocity loop designed at compile time
//! ([`RstDesign`]); the small motor adds the torque that the large motor is too slow for.
//! [`Monitor`] and [`Safety`] decide when the motors stop.
//!
//! The crate uses f32 `+ - * /` and integers only, so its results are the same bits on every
//! machine. It does not panic.
#![no_std]
#![allow(
    clippy::neg_cmp_op_on_partial_ord,
    reason = "a NaN has to fail these comparisons"
)]

mod ammeters;
mod balance;
mod compensation;
mod controller;
mod coulomb;
mod design_error;
mod device;
mod fingerprint;
mod grid;
mod index;
mod limits;
mod margins;
mod monitor;
mod need;
mod numeric;
mod rig;
mod rst;
mod rst_design;
mod safety;
mod scene;
mod stage;
mod stop;
mod supply;
mod switchboard;
mod tick;
mod tuning;
mod units;
mod windings;

pub use ammeters::{Ammeters, AmmetersState, Flow};
pub use balance::{Balance, BalanceState};
pub use compensation::{Compensated, Compensation, CompensationState};
pub use controller::{Controller, ControllerState};
pub use design_error::DesignError;
pub use device::{DualStage, Motor};
pub use fingerprint::Fingerprint;
pub use grid::Grid;
pub use index::{Index, IndexState};
pub use limits::{CurrentLimits, CurrentScale, Currents};
pub use margins::Margins;
pub use monitor::{Monitor, MonitorState};
pub use need::{Need, Senses, Wanted};
pub use rig::{AccelerationScale, AngleScale, Rig};
pub use rst::{Rst, RstState};
pub use rst_design::{LEAST_MODULUS, LoopPoles, RstDesign};
pub use safety::{Findings, Mode, Order, Request, Safety, SafetyState};
pub use scene::*;
pub use stage::{
    ContinuousStage, ContinuousState, CoupledParts, Driven, TransientStage, TransientState,
};
pub use stop::Stop;
pub use supply::{Supply, SupplyFinding, SupplyState};
pub use switchboard::{Switchboard, SwitchboardState};
pub use tick::Action;
pub use tuning::{Bounds, Parameter, Quantity, Refusal, Tunable};
pub use units::{NewtonMetres, RadPerS, RadPerS2, Radians, Volts};
pub use windings::{Windings, WindingsState};

#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
