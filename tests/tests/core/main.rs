//! Tests of `estimator-core`: named invariants over every estimator, and references written from
//! the definitions alone.
//!
//! | module | holds the core against |
//! |---|---|
//! | `invariants` | what must be true of any velocity estimator |
//! | `endurance` | long runs: covariance, counts beyond f32, bad currents, huge jumps |
//! | `foaw_definition` | the O(n²) definition of FOAW in exact fractions |
//! | `kalman_reference` | the textbook filter in f64, absolute positions, the current as a state |
//! | `m_over_t` | a ramp, which the M/T method knows exactly |
//! | `observer` | invariants of the observers, which read more than counts; a motor that obeys their model; what they learn |
//! | `confidence` | the variances that estimators claim, against errors and theory |
//! | `handover` | two estimators that are exchanged while they run |
//! | `steady_gain` | the plain recursion run until it stops changing |
//! | `codegen` | what the compiler makes of it for the board |
//! | `scene_images` | what one scene of `haptic-control` costs on the board |
//! | `regressions` | each defect known from public code, one test by name |
//!
//! What must not compile is in the package `refusals`.

#![allow(
    clippy::needless_range_loop,
    reason = "matrix code reads as its equations, with indices"
)]

mod codegen;
mod confidence;
mod endurance;
mod every;
mod foaw_definition;
mod handover;
mod image;
mod invariants;
mod kalman_reference;
mod m_over_t;
mod motion;
mod observer;
mod reference;
mod regressions;
mod scene_images;
mod steady_gain;
