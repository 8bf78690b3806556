//! Tests of `estimator-core`: named invariants over every estimator, and references written from
//! the definitions alone.
//!
//! | module | holds the core against |
//! |---|---|
//! | `invariants` | what must be true of any velocity estimator |
//! | `endurance` | long runs: covariance, counts beyond f32, bad currents, huge jumps |
//! | `foaw_definition` | the O(n²) definition of FOAW in exact fractions |
//! | `kalman_reference` | the textbook filter in f64, absolute positions, the current as a state |
//! | `observer` | the same of the observers, which read more than counts, and a motor that obeys their model |
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
mod motion;
mod observer;
mod reference;
mod regressions;
mod scene_images;
mod steady_gain;
