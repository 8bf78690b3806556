//! Every estimator at every rate behind one call that is never inlined, so that its instructions
//! can be counted; the same functions run on the host, so that outputs can be compared bit for bit.
//!
//! An estimator of the catalogue is here by its row there. A peer has a module in `peers` and a line in
//! `estimators.rs`.
#![no_std]

mod estimators;
pub mod mailbox;
pub mod peers;
mod subject;

pub use estimators::{CLOCK, SUBJECTS};
pub use subject::{Measured, Run, Subject};
