//! Design at compile time: the errors, the functions that `core` lacks, and the Riccati equation.

pub mod const_math;
mod error;
pub(crate) mod matrix;
pub(crate) mod riccati;

pub use error::DesignError;
