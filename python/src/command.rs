//! The command line of the host simulation.

use std::ffi::OsString;

use pyo3::prelude::*;
use terminal::failure::status;

/// Runs a command line, whose first word is the name of the program, and returns its exit status.
#[pyfunction]
pub(crate) fn command(py: Python<'_>, arguments: Vec<OsString>) -> u8 {
    py.detach(|| status(host_sim::cli::run(arguments)))
}
