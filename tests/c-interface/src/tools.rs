//! Compilers and the library.

use std::path::{Path, PathBuf};
use std::process::Command;

/// A compiler and its arguments.
#[derive(Clone, Copy, Debug)]
pub struct Compiler {
    /// Name of the program.
    pub program: &'static str,
    /// Arguments before the files.
    pub arguments: &'static [&'static str],
}

/// The Arm toolchain for the board, with warnings as errors. What follows says whether it compiles or links.
pub const CORTEX_M4F: Compiler = Compiler {
    program: "arm-none-eabi-gcc",
    arguments: &[
        "-std=c99",
        "-O2",
        "-Wall",
        "-Wextra",
        "-Werror",
        "-mcpu=cortex-m4",
        "-mthumb",
        "-mfloat-abi=hard",
        "-mfpu=fpv4-sp-d16",
    ],
};

/// Whether a program is missing. A machine that must have all programs sets `REQUIRE_C_TOOLS`.
#[must_use]
pub fn missing(program: &str) -> bool {
    let runs = Command::new(program).arg("--version").output();
    not_there(runs.is_err(), program)
}

/// Says that something is missing, as [`missing`] says of a program, and returns whether it is.
#[must_use]
pub fn not_there(missing: bool, what: &str) -> bool {
    if missing {
        assert!(
            std::env::var_os("REQUIRE_C_TOOLS").is_none(),
            "no {what} on this machine"
        );
        eprintln!("no {what} on this machine: not tested");
    }
    missing
}

/// The folder of a test's files.
#[must_use]
pub fn folder(name: &str) -> PathBuf {
    let folder = root().join("target/tmp/c-interface").join(name);
    std::fs::create_dir_all(&folder).expect("target is writable");
    folder
}

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

/// Compiles a file of the folder `c` into `program`, with the headers in `headers`.
pub fn compiled(compiler: &Compiler, source: &str, headers: &Path, more: &[&str], program: &Path) {
    let here = Path::new(env!("CARGO_MANIFEST_DIR"));
    let output = Command::new(compiler.program)
        .args(compiler.arguments)
        .arg("-I")
        .arg(root().join("c/include"))
        .arg("-I")
        .arg(headers)
        .arg(here.join("c").join(source))
        .args(more)
        .arg("-o")
        .arg(program)
        .output()
        .expect("the compiler starts");
    let text = String::from_utf8_lossy(&output.stderr);
    assert!(
        output.status.success() && text.is_empty(),
        "{compiler:?}: {text}"
    );
}
