//! Command line of the virtual board.

use std::process::ExitCode;

fn main() -> ExitCode {
    match virtual_board::cli::run(std::env::args_os()) {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => {
            eprintln!("error: {failure}");
            ExitCode::from(failure.status())
        }
    }
}
