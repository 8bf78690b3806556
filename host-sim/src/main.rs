//! Command line of the host simulation.

use std::process::ExitCode;

use terminal::failure::ended;

fn main() -> ExitCode {
    ended(host_sim::cli::run(std::env::args_os()))
}
