//! The command line of the host simulation.
//!
//! The crates of this folder implement the commands. From the lowest layer to the highest they are
//! `spelling`, `terminal`, `device-files`, `simulation`, `recordings`, `catalogue`, `scoring`, `experiments`
//! and `report`. A crate imports only crates of lower layers.

pub mod cli;
