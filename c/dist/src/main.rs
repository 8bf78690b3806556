//! `cargo c-library`: writes what users of C and C++ take.

use std::process::ExitCode;

use terminal::failure::ended;

fn main() -> ExitCode {
    ended(limpid_dist::cli::run(std::env::args_os()))
}
