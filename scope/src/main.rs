//! Command line of the live page.

use std::process::ExitCode;

use terminal::failure::ended;

fn main() -> ExitCode {
    ended(scope::cli::run(std::env::args_os()))
}
