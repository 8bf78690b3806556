//! Command line of the virtual board.

use std::process::ExitCode;

use terminal::failure::ended;

fn main() -> ExitCode {
    ended(virtual_board::cli::run(std::env::args_os()))
}
