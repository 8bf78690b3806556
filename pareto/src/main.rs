//! Run time against error; `cargo pareto`.

use std::process::ExitCode;

fn main() -> ExitCode {
    match pareto::cli::run(std::env::args_os()) {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => {
            eprintln!("error: {failure}");
            ExitCode::from(failure.status())
        }
    }
}
