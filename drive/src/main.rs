//! Command line of the host link.

use std::process::ExitCode;

use terminal::failure::ended;

fn main() -> ExitCode {
    ended(drive::cli::run(std::env::args_os()))
}
