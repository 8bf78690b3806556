//! Every estimator at every rate behind one call that is never inlined, so that its instructions
//! can be counted; the same functions run on the host, so that outputs can be compared bit for bit.
//!
//! To add one, add a line to `estimators.rs`.
#![no_std]

mod estimators;
pub mod mailbox;
pub mod peers;
mod subject;

pub use estimators::{CLOCK, SUBJECTS};
pub use subject::{Measured, Run, Subject};
