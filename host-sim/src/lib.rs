//! The command line of the host simulation.
//!
//! The work is done by the crates below this folder, lowest first: `terminal`, `simulation`,
//! `recordings`, `catalogue`, `scoring`, `experiments`, `report`. Each uses only crates before it.

pub mod cli;
