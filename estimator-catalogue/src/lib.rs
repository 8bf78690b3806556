//! The catalogue of estimators: one row per estimator.
//!
//! The macro [`estimators!`] passes all rows to another macro. The command line, the report, the
//! bench image, the code probe, the stress test, the fuzz targets and the tables of the
//! documentation expand these rows or iterate over [`ROWS`], so that a new row is in all of them.
//!
//! ```
//! use estimator_catalogue::ROWS;
//!
//! let low_pass = ROWS.iter().find(|row| row.name == "low-pass").unwrap();
//! assert_eq!(low_pass.parameters[0].name, "cutoff_hz");
//! assert_eq!(low_pass.parameters[0].unit, "Hz");
//! ```
#![no_std]

mod parameter;
mod row;
mod rows;
mod scaling;
mod varying;

pub use parameter::{Parameter, Search, WINDOW_LIMIT};
pub use row::{CType, Colour, Dash, Goal, Reports, Row, Settling, Variant};
pub use rows::{ROWS, design};
pub use scaling::{Powers, Scaling};
pub use varying::{AssumesConstantPeriod, UpdateOver, VarianceOver, Varying};

#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
