//! The estimators of `estimator-core` for C and C++.
//!
//! `include/limpid.h` documents the interface for its users. Every row of the catalogue has
//!
//! * `limpid_NAME_t`, its parameters: a constant that `host-sim export --c` writes, or the result of
//!   `limpid_NAME_design` on a computer;
//! * `limpid_NAME_state_t`, its state, which the caller owns;
//! * `limpid_NAME_start` and `limpid_NAME_update`, and functions for what else it reports.
//!
//! `build.rs` writes these functions from the catalogue. It sets `board` for targets without an operating system.
//! Sizes and alignments are those of this machine and asserted for every target. A function reads its arguments
//! through references: the caller passes pointers that are aligned, valid and not null, and states that have been
//! started.
#![cfg_attr(board, no_std)]
#![deny(unsafe_code)]
#![allow(
    non_camel_case_types,
    reason = "these are the names of types in limpid.h"
)]
#![allow(
    improper_ctypes_definitions,
    reason = "C has storage of the size and alignment of the Rust types and does not read them"
)]

mod sample;

use core::mem::MaybeUninit;

use estimator_core as c;
use estimator_core::{AccelerationEstimator, Confidence, VaryingPeriod, VelocityEstimator};

pub use sample::limpid_sample_t;

include!(concat!(env!("OUT_DIR"), "/types.rs"));

#[cfg(not(board))]
mod design;

#[cfg(not(board))]
pub use design::limpid_setup_t;

pub use functions::*;

/// The functions, by their names in C.
#[allow(
    unsafe_code,
    reason = "a name in C is an unsafe attribute, because another function could have the same; all names \
              begin with that of the library, and no body is unsafe"
)]
mod functions {
    use super::*;

    include!(concat!(env!("OUT_DIR"), "/functions.rs"));

    #[cfg(not(board))]
    include!(concat!(env!("OUT_DIR"), "/designs.rs"));
}

/// Text of the generated files, for the generator of `limpid.h`: C declares the types as storage.
pub mod source {
    /// The sample.
    pub const SAMPLE: &str = include_str!("sample.rs");
    /// The setup of a design.
    pub const DESIGN: &str = include_str!("design.rs");
    /// Types as C declares them.
    pub const STORAGE: &str = include_str!(concat!(env!("OUT_DIR"), "/storage.rs"));
    /// Functions for every target.
    pub const FUNCTIONS: &str = include_str!(concat!(env!("OUT_DIR"), "/functions.rs"));
    /// Functions that design estimators, for computers.
    pub const DESIGNS: &str = include_str!(concat!(env!("OUT_DIR"), "/designs.rs"));
    /// Names of the estimators between `limpid_` and a suffix.
    pub const NAMES: &[&str] = &include!(concat!(env!("OUT_DIR"), "/names.rs"));
}

// No function of this library panics: a test looks for the symbols. The linker wants a handler
// nevertheless if it links code of another panicking library.
#[cfg(board)]
#[panic_handler]
fn panic(_: &core::panic::PanicInfo<'_>) -> ! {
    loop {}
}
