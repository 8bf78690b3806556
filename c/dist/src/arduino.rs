//! The library folder for Arduino.

use std::fs;
use std::path::{Path, PathBuf};

use catalogue::estimators::{Kind, Setup};
use estimator_core::Hertz;

use crate::libraries::{BOARDS, build, copy, write};

/// Files that are not generated.
fn sources() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../arduino")
}

/// `LimpidMilliseconds.h`: parameters of `imm` for a period of a millisecond. They depend on nothing else.
///
/// # Errors
/// One line if the design fails.
pub fn milliseconds() -> Result<String, String> {
    let kind = Kind::named("imm").map_err(|failure| failure.to_string())?;
    let setup = Setup {
        rate: Hertz(1000.0),
        ..Setup::default()
    };
    // The edge clock is not read.
    kind.c(&setup, Hertz(1e6), &Vec::new(), None)
        .map_err(|failure| failure.to_string())
}

/// Writes the folder, ready to zip: sources, header, a library per processor, examples.
///
/// # Errors
/// One line that names the file or the target.
pub fn arduino(into: &Path) -> Result<(), String> {
    copy_folder(&sources(), into)?;
    write(&into.join("src/limpid.h"), crate::header()?.as_bytes())?;
    write(
        &into.join("src/LimpidMilliseconds.h"),
        milliseconds()?.as_bytes(),
    )?;
    for one in &BOARDS {
        let library = build(one)?;
        for folder in one.arduino {
            copy(&library, &into.join("src").join(folder).join("liblimpid.a"))?;
        }
    }
    Ok(())
}

/// Copies a folder of texts, with the version in the place of its name.
fn copy_folder(from: &Path, to: &Path) -> Result<(), String> {
    let problem = |error: std::io::Error| format!("{}: {error}", from.display());
    for entry in fs::read_dir(from).map_err(problem)? {
        let path = entry.map_err(problem)?.path();
        let copied = to.join(path.file_name().unwrap_or_default());
        if path.is_dir() {
            copy_folder(&path, &copied)?;
            continue;
        }
        let text =
            fs::read_to_string(&path).map_err(|error| format!("{}: {error}", path.display()))?;
        let text = text.replace("VERSION_OF_LIMPID", env!("CARGO_PKG_VERSION"));
        write(&copied, text.as_bytes())?;
    }
    Ok(())
}
