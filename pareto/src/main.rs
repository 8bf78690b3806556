//! Run time against error; `cargo pareto`.

use std::process::ExitCode;

use terminal::failure::ended;

fn main() -> ExitCode {
    ended(pareto::cli::run(std::env::args_os()))
}
