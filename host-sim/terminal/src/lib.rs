//! Messages, exit statuses and output files of the command-line programs. An output file is written
//! completely or not at all.
//!
//! The crates of the simulation print and write files only through this crate.

pub mod checksum;
mod explain;
pub mod failure;
pub mod output;
pub mod parse;
pub mod wording;

pub use explain::explain;
