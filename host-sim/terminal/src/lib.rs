//! What the command-line programs share: messages for people, exit statuses, output files that are
//! written whole or not at all.
//!
//! No crate of the simulation prints or writes a file except through this crate.

mod explain;
pub mod failure;
pub mod output;
pub mod wording;

pub use explain::explain;
