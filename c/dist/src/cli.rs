//! The command line.

use std::ffi::OsString;
use std::path::{Path, PathBuf};

use clap::{Parser, Subcommand};
use terminal::failure::Failure;
use terminal::output::{check_place, is_stdout, print_bytes, write_whole};
use terminal::parse::parsed;
use terminal::wording::WIDTH;

/// Write the header and the libraries for C, C++ and Arduino.
///
/// A folder is written as a whole or not at all. The next run replaces it; a file that no run wrote, or that was
/// changed since, is never replaced.
#[derive(Debug, Parser)]
#[command(
    name = "cargo c-library",
    bin_name = "cargo c-library",
    version,
    max_term_width = WIDTH,
    after_help = "Examples:\n  cargo c-library libraries\n  cargo c-library arduino ~/Arduino/libraries/Limpid"
)]
struct Arguments {
    #[command(subcommand)]
    what: What,
}

#[derive(Debug, Subcommand)]
enum What {
    /// Write limpid.h
    Header {
        /// File to write; - is standard output
        #[arg(value_name = "FILE.h")]
        file: PathBuf,
    },
    /// Write include/limpid.h, a static library per processor (host, cortex-m0, cortex-m3, cortex-m4f,
    /// riscv32imc), and source/limpid.c for other processors
    Libraries {
        /// Folder to write
        #[arg(value_name = "DIR", default_value = "target/limpid-c")]
        folder: PathBuf,
    },
    /// Write the library folder for Arduino, ready to zip
    Arduino {
        /// Folder to write
        #[arg(value_name = "DIR", default_value = "target/Limpid")]
        folder: PathBuf,
    },
}

/// Runs the command line `arguments`, the program's name first.
///
/// # Errors
/// A [`Failure`] with its exit status.
pub fn run(arguments: impl IntoIterator<Item = OsString>) -> Result<(), Failure> {
    let arguments = match parsed::<Arguments>(arguments) {
        Ok(arguments) => arguments,
        Err(error) => return terminal::explain(&error, "cargo c-library"),
    };
    match &arguments.what {
        What::Header { file } if is_stdout(file) => print_bytes(crate::header()?.as_bytes()),
        What::Header { file } => {
            check_place(file)?;
            write_whole(file, crate::header()?.as_bytes())?;
            print_path(file)
        }
        What::Libraries { folder } => {
            crate::libraries(folder)?;
            print_path(folder)
        }
        What::Arduino { folder } => {
            crate::arduino(folder)?;
            print_path(folder)
        }
    }
}

/// Prints what was written.
fn print_path(path: &Path) -> Result<(), Failure> {
    print_bytes(format!("{}\n", path.display()).as_bytes())
}
