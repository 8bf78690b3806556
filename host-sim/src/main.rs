//! Command line of the host simulation.

use std::process::ExitCode;

fn main() -> ExitCode {
    match host_sim::cli::run(std::env::args_os()) {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => {
            eprintln!("error: {failure}");
            ExitCode::from(failure.status())
        }
    }
}
