//! `estimator-core` with f64 in place of every f32, generated from its source at build time.
//!
//! The same parameters, the same recurrences, the same integers: what the two differ by is the
//! rounding of f32 and nothing else. Items are named and documented as there.

#![allow(
    missing_docs,
    clippy::all,
    clippy::pedantic,
    reason = "generated: documented and linted where it comes from"
)]

include!(concat!(env!("OUT_DIR"), "/lib.rs"));
