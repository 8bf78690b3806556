//! `cargo c-library`: writes what users of C and C++ take.

use std::path::PathBuf;
use std::process::ExitCode;

use clap::{Parser, Subcommand};

/// Write the header and the libraries for C, C++ and Arduino.
#[derive(Debug, Parser)]
#[command(name = "c-library", version)]
struct Options {
    #[command(subcommand)]
    what: What,
}

#[derive(Debug, Subcommand)]
enum What {
    /// Write limpid.h
    Header {
        /// File to write
        #[arg(value_name = "FILE.h")]
        file: PathBuf,
    },
    /// Write include/limpid.h and a static library per processor: host, cortex-m0, cortex-m3,
    /// cortex-m4f, riscv32imc
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

fn main() -> ExitCode {
    let options = Options::parse();
    let (done, written) = match &options.what {
        What::Header { file } => (
            limpid_dist::header().and_then(|text| limpid_dist::write(file, text.as_bytes())),
            file,
        ),
        What::Libraries { folder } => (limpid_dist::libraries(folder), folder),
        What::Arduino { folder } => (limpid_dist::arduino(folder), folder),
    };
    match done {
        Ok(()) => {
            println!("{}", written.display());
            ExitCode::SUCCESS
        }
        Err(error) => {
            eprintln!("error: {error}");
            ExitCode::from(2)
        }
    }
}
