//! Writes `limpid.h`: `limpid-header FILE`; `-` is standard output.

use std::process::ExitCode;

fn main() -> ExitCode {
    let Some(path) = std::env::args_os().nth(1) else {
        eprintln!(
            "limpid-header: name the file to write, for example c/include/limpid.h; - is standard output"
        );
        return ExitCode::from(2);
    };
    let done = limpid_header::header().and_then(|text| {
        if path == "-" {
            print!("{text}");
            return Ok(());
        }
        std::fs::write(&path, text).map_err(|error| format!("{}: {error}", path.display()))
    });
    match done {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("limpid-header: {error}");
            ExitCode::from(2)
        }
    }
}
