//! Static libraries.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use crate::translation::translation;
use terminal::failure::Failure;
use terminal::output::Folder;

/// A library for a family of processors.
#[derive(Clone, Copy, Debug)]
pub struct Build {
    /// Folder of the library.
    pub folder: &'static str,
    /// Target of the compiler; `None` for this computer.
    pub triple: Option<&'static str>,
    /// Processor whose instructions are used; `None` for the least one of the target.
    pub processor: Option<&'static str>,
    /// Folders of Arduino: the processor, and the float ABI if it has one.
    pub arduino: &'static [&'static str],
}

/// The library for computers, with the functions that design.
pub const COMPUTER: Build = Build {
    folder: "host",
    triple: None,
    processor: None,
    arduino: &[],
};

/// The libraries for boards.
///
/// The pinned toolchain has no targets for Cortex-M3 and for a Cortex-M4 without FPU. Those have the
/// instructions of Cortex-M3 on the target of Cortex-M0: the functions are compiled for Cortex-M3, the
/// compiler's own routines for Cortex-M0, which a Cortex-M3 executes.
pub const BOARDS: [Build; 4] = [
    Build {
        folder: "cortex-m0",
        triple: Some("thumbv6m-none-eabi"),
        processor: None,
        arduino: &["cortex-m0", "cortex-m0plus"],
    },
    Build {
        folder: "cortex-m3",
        triple: Some("thumbv6m-none-eabi"),
        processor: Some("cortex-m3"),
        arduino: &["cortex-m3", "cortex-m4"],
    },
    Build {
        folder: "cortex-m4f",
        triple: Some("thumbv7em-none-eabihf"),
        processor: None,
        arduino: &[
            "cortex-m4/fpv4-sp-d16-hard",
            "cortex-m7/fpv4-sp-d16-hard",
            "cortex-m7/fpv5-sp-d16-hard",
            "cortex-m7/fpv5-d16-hard",
        ],
    },
    Build {
        folder: "riscv32imc",
        triple: Some("riscv32imc-unknown-none-elf"),
        processor: None,
        arduino: &["esp32c3"],
    },
];

/// The repository.
fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

/// Builds the library as a kind of crate in a folder below `target`. Returns the folder of the compiler's output.
///
/// # Errors
/// One line if cargo fails; it names the command that installs a missing target.
fn rustc(
    folder: &str,
    kind: &str,
    triple: Option<&str>,
    flags: Option<&str>,
) -> Result<PathBuf, String> {
    let mut target = root().join("target/c-library").join(folder);
    let cargo = std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into());
    let mut command = Command::new(cargo);
    command
        .current_dir(root())
        .args(["rustc", "--quiet", "--profile", "c-library"])
        .args(["--package", "limpid-c", "--crate-type", kind])
        .arg("--target-dir")
        .arg(&target);
    if let Some(triple) = triple {
        command.args(["--target", triple]);
        target.push(triple);
    }
    if let Some(flags) = flags {
        command.env("RUSTFLAGS", flags);
    }
    let status = command
        .status()
        .map_err(|error| format!("cargo does not start: {error}"))?;
    if !status.success() {
        let hint = triple.map_or_else(String::new, |triple| {
            format!("; if the target is missing: rustup target add {triple}")
        });
        return Err(format!("no library for {folder}{hint}"));
    }
    Ok(target.join("c-library"))
}

/// Builds a library in a target directory below `target` and returns its path.
///
/// # Errors
/// One line if cargo fails; it names the command that installs a missing target.
pub fn build(one: &Build) -> Result<PathBuf, String> {
    let flags = one.processor.map(|name| format!("-Ctarget-cpu={name}"));
    let folder = rustc(one.folder, "staticlib", one.triple, flags.as_deref())?;
    Ok(folder.join("liblimpid.a"))
}

/// The text of `limpid.c`, the functions of [`header`](crate::header) for processors without a library.
///
/// # Errors
/// One line if cargo fails, or if the library has something that has no translation.
pub fn source() -> Result<String, String> {
    // The least instructions; relocations tell addresses of constants from numbers.
    let flags = "-Ctarget-cpu=mvp -Clink-arg=--emit-relocs";
    let folder = rustc(
        "source",
        "cdylib",
        Some("wasm32-unknown-unknown"),
        Some(flags),
    )?;
    let library = folder.join("limpid.wasm");
    let bytes = fs::read(&library).map_err(|error| format!("{}: {error}", library.display()))?;
    translation(&bytes, &crate::header()?)
}

/// Writes header, libraries and source into a folder: `include/limpid.h`, `FOLDER/liblimpid.a` and
/// `source/limpid.c`. Nothing is written unless
/// all of them are built.
///
/// # Errors
/// [`Failure::Input`] that names the file or the target.
pub fn libraries(into: &Path) -> Result<(), Failure> {
    let all = || [COMPUTER].into_iter().chain(BOARDS);
    let name = |one: &Build| format!("{}/liblimpid.a", one.folder);
    let [header, source] = ["include/limpid.h", "source/limpid.c"].map(str::to_owned);
    let names: Vec<_> = [header.clone(), source.clone()]
        .into_iter()
        .chain(all().map(|one| name(&one)))
        .collect();
    let mut files = place(into, &names)?;
    files.add(header, crate::header()?);
    files.add(source, self::source()?);
    for one in all() {
        files.add(name(&one), bytes(&one)?);
    }
    files.write()
}

/// The folder `into` without files yet. The libraries take minutes: what would be refused at their end is refused here.
pub(crate) fn place(into: &Path, names: &[String]) -> Result<Folder, Failure> {
    Folder::check("DIR", into)?;
    Folder::check_files("DIR", into, names.iter().map(String::as_str))?;
    Ok(Folder::new(into))
}

/// The bytes of a library, which is built first.
pub(crate) fn bytes(one: &Build) -> Result<Vec<u8>, String> {
    let library = build(one)?;
    fs::read(&library).map_err(|error| format!("{}: {error}", library.display()))
}
