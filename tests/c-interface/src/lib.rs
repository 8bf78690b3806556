//! The estimators of the bench image in Rust, and the C files with their parameters.

mod files;
mod reference;
mod tools;

pub use files::{designs, parameters};
pub use reference::{CASES, Case, VALUES};
pub use tools::{CORTEX_M4F, Compiler, compiled, folder, missing, not_there};
