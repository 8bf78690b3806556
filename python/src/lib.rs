//! The module `limpid._limpid`: the crates of this workspace for Python.
//!
//! A function here reads arrays and keywords, calls the crate that has the algorithm, and returns arrays.
//! The package `limpid` in the folder beside has the documentation for users.

#![allow(
    clippy::needless_pass_by_value,
    clippy::too_many_arguments,
    reason = "arguments and keywords of Python come as owned values"
)]

mod background;
mod catalogue_lists;
mod columns;
mod command;
mod device;
mod error;
mod estimator;
mod integer;
mod log;
mod logs;
mod modulus;
mod replay;
mod scores;
mod simulate;
mod stream;

use pyo3::pymodule;

#[pymodule]
mod _limpid {
    use pyo3::prelude::*;

    #[pymodule_init]
    fn init(module: &Bound<'_, PyModule>) -> PyResult<()> {
        module.add("__version__", env!("CARGO_PKG_VERSION"))
    }

    #[pymodule_export]
    use super::catalogue_lists::{device, estimators, parameters, scenarios};
    #[pymodule_export]
    use super::columns::clock;
    #[pymodule_export]
    use super::command::command;
    #[pymodule_export]
    use super::estimator::Estimator;
    #[pymodule_export]
    use super::integer::checked_counts_per_rev;
    #[pymodule_export]
    use super::log::read_log;
    #[pymodule_export]
    use super::logs::{recommend, tune_logs, tune_scenarios, values_of_presets};
    #[pymodule_export]
    use super::replay::replay;
    #[pymodule_export]
    use super::scores::{score_fields, scores};
    #[pymodule_export]
    use super::simulate::{coarsen, decode, simulate};
}
