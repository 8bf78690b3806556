//! Recordings of real devices with a known velocity: coarsened to the resolution of a cheap encoder,
//! run through the estimators, and scored.
//!
//! A fine encoder gives the position to a fraction of a coarse count, and its velocity, smoothed
//! afterwards in both directions of time, is the truth. [`coarsen`] computes from it what a coarse
//! encoder on the same shaft would have reported.

pub mod cases;
pub mod coarsen;
pub mod fine;
pub mod peers;
pub mod pool;
pub mod rest;
pub mod run;
pub mod sources;
pub mod table;
pub mod wanted;
