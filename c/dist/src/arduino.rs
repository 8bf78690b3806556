//! The library folder for Arduino.

use std::fs;
use std::path::{Path, PathBuf};

use catalogue::estimators::{Kind, Setup};
use estimator_core::Hertz;
use terminal::failure::Failure;

use crate::libraries::{BOARDS, bytes, place, source};

/// The processors of Arduino that have no library. Arduino compiles every source for every processor.
const WITHOUT_LIBRARY: &str = "#ifdef __XTENSA__";

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

/// Writes the folder, ready to zip: sources, header, a library per processor, the source for others, examples. Nothing is written unless all
/// of them are built.
///
/// # Errors
/// [`Failure::Input`] that names the file or the target.
pub fn arduino(into: &Path) -> Result<(), Failure> {
    let mut texts = Vec::new();
    read_folder(&sources(), "", &mut texts)?;
    texts.push(("src/limpid.h".to_owned(), crate::header()?));
    texts.push(("src/LimpidMilliseconds.h".to_owned(), milliseconds()?));
    let source_name = "src/limpid.c".to_owned();
    let name = |folder: &str| format!("src/{folder}/liblimpid.a");
    let libraries = BOARDS.iter().flat_map(|one| one.arduino);
    let names = texts.iter().map(|(name, _)| name.clone());
    let names = names.chain(libraries.map(|folder| name(folder)));
    let names: Vec<_> = names.chain([source_name.clone()]).collect();
    let mut files = place(into, &names)?;
    for (name, text) in texts {
        files.add(name, text);
    }
    files.add(
        source_name,
        format!("{WITHOUT_LIBRARY}\n{}#endif\n", source()?),
    );
    for one in &BOARDS {
        let library = bytes(one)?;
        for folder in one.arduino {
            files.add(name(folder), library.clone());
        }
    }
    files.write()
}

/// Adds the texts in a folder to `texts`, with the version in the place of its name. A name is that of the file behind
/// `above`.
fn read_folder(from: &Path, above: &str, texts: &mut Vec<(String, String)>) -> Result<(), String> {
    let problem = |error: std::io::Error| format!("{}: {error}", from.display());
    for entry in fs::read_dir(from).map_err(problem)? {
        let path = entry.map_err(problem)?.path();
        let file = path.file_name().unwrap_or_default().to_string_lossy();
        let name = format!("{above}{file}");
        if path.is_dir() {
            read_folder(&path, &format!("{name}/"), texts)?;
            continue;
        }
        let text =
            fs::read_to_string(&path).map_err(|error| format!("{}: {error}", path.display()))?;
        texts.push((
            name,
            text.replace("VERSION_OF_LIMPID", env!("CARGO_PKG_VERSION")),
        ));
    }
    Ok(())
}
