//! Tests of `estimator-core`: named invariants over every estimator, and references written from
//! the definitions alone.
//!
//! | module | holds the core against |
//! |---|---|
//! | `invariants` | what must be true of any velocity estimator |
//! | `ramps` | constant velocity and rest |
//! | `endurance` | long runs: covariance, bad currents, huge jumps |
//! | `distance` | counts beyond the exact range of f32, long ramps |
//! | `foaw_definition` | the O(n²) definition of FOAW in exact fractions |
//! | `robust_exact` | the definition of the optimal robust exact differentiator, and its largest error |
//! | `kalman_reference` | the textbook filter in f64, absolute positions, the current as a state |
//! | `bank` | the multiple-model bank by its definition in f64, and what it promises |
//! | `acceleration` | a constant acceleration |
//! | `m_over_t` | ramps and stamps, of which the M/T method knows the result |
//! | `observer` | invariants of the observers, which read more than counts; a motor that obeys their model; adaptation |
//! | `confidence` | the variances that estimators claim, against errors and theory |
//! | `calibration` | reported variances on a motor with the noise of the design |
//! | `handover` | two estimators that are exchanged while they run |
//! | `limits` | the range of each parameter |
//! | `steady_gain` | the plain recursion run until it stops changing |
//! | `regressions` | each defect known from public code, one test by name |
//! | `units` | counts, currents, scales and signals |
//!
//! What must not compile is in the package `refusals`, what the compiler makes of it for the board in
//! `acceptance`, and longer runs in `stress`.

#![allow(
    clippy::needless_range_loop,
    reason = "matrix code reads as its equations, with indices"
)]

mod acceleration;
mod bank;
mod calibration;
mod confidence;
mod distance;
mod endurance;
mod every;
mod foaw_definition;
mod handover;
mod invariants;
mod kalman_reference;
mod limits;
mod m_over_t;
mod motion;
mod observer;
mod ramps;
mod reference;
mod regressions;
mod robust_exact;
mod steady_gain;
mod units;

use estimator_core::Uncertainty;

/// Noise of an ordinary motor, for which tests design observers.
const UNSURE: Uncertainty = Uncertainty {
    torque_noise: 1e-5,
    disturbance: 3e-4,
    disturbance_time: 0.1,
    friction_share: 0.7,
    boundary_noise: 0.03,
};
