//! `limpid.c`, the library as one file for processors that the Rust toolchain has no target for. Its bits on a
//! Cortex-M4F are tested beside those of the library, in `board`.

use std::path::{Path, PathBuf};
use std::process::Command;

use c_interface::{Compiler, compiled, folder, missing, not_there};
use limpid_dist::source;
use object::{Object, ObjectSymbol};
use pareto::traces::RATES_HZ;

use super::host::{compare, program_of};

/// This machine with addresses of 32 bits, and what finds undefined behaviour.
const SANITIZED_32: Compiler = Compiler {
    program: "gcc",
    arguments: &[
        "-m32",
        "-msse2",
        "-mfpmath=sse",
        "-std=gnu99",
        "-O1",
        "-g",
        "-Wall",
        "-Wextra",
        "-Werror",
        "-fsanitize=address,undefined",
        "-fno-sanitize-recover=all",
        "-DWITHOUT_DESIGN",
    ],
};

/// An Xtensa without FPU. The compilers of ESP32 are of the same family, and are not among Debian's packages.
const XTENSA: Compiler = Compiler {
    program: "xtensa-lx106-elf-gcc",
    arguments: &[
        "-std=gnu17",
        "-Os",
        "-ffreestanding",
        "-Wall",
        "-Wextra",
        "-Werror",
    ],
};

/// Writes `limpid.c` to a folder and returns its path.
fn written(folder: &Path) -> PathBuf {
    let file = folder.join("limpid.c");
    std::fs::write(&file, source().expect("limpid.c")).expect("target is writable");
    file
}

/// Whether this machine has no libraries for 32 bits.
fn missing_32_bits() -> bool {
    let output = Command::new(SANITIZED_32.program)
        .args(["-m32", "-print-file-name=libasan.so"])
        .output();
    // A name without a folder is that of a file that is not there.
    let is_there = output.is_ok_and(|output| output.stdout.contains(&b'/'));
    not_there(!is_there, "gcc -m32 -fsanitize=address (gcc-multilib)")
}

#[test]
fn source_has_the_bits_of_rust_and_sanitizers_find_nothing() {
    if missing_32_bits() {
        return;
    }
    let file = written(&folder("source-32"));
    let file = file.to_str().expect("a path in UTF-8");
    for rate_hz in RATES_HZ {
        let program = program_of(&SANITIZED_32, "source-32", rate_hz, &[file]);
        compare(&program, rate_hz, false);
    }
}

#[test]
fn source_for_xtensa_calls_arithmetic_of_the_compiler_alone() {
    if missing(XTENSA.program) {
        return;
    }
    let folder = folder("xtensa");
    let source = written(&folder);
    let object = folder.join("limpid.o");
    let source = source.to_str().expect("a path in UTF-8");
    compiled(&XTENSA, source, &folder, &["-c"], &object);
    let bytes = std::fs::read(object).expect("just compiled");
    let file = object::File::parse(&*bytes).expect("an object");
    let names = |undefined: bool| {
        let symbols = file.symbols();
        let symbols = symbols.filter(|symbol| symbol.is_undefined() == undefined);
        let names = symbols.map(|symbol| symbol.name().expect("UTF-8").to_owned());
        names.filter(|name| !name.is_empty()).collect::<Vec<_>>()
    };
    let defined = names(false);
    for name in limpid::source::NAMES {
        for what in ["start", "update"] {
            let function = format!("limpid_{name}_{what}");
            assert!(defined.contains(&function), "no {function}");
        }
    }
    // Of f32 and of integers: a routine of double would end with df3 or df2.
    let is_arithmetic = |name: &&String| {
        let ends = ["sf3", "sf2", "si3", "di3", "sfsi", "sisf", "disf"];
        name.starts_with("__") && ends.iter().any(|end| name.ends_with(end))
    };
    let foreign = names(true);
    let foreign: Vec<_> = (foreign.iter())
        .filter(|name| !is_arithmetic(name) && *name != "memcpy")
        .collect();
    assert!(foreign.is_empty(), "calls {foreign:?}");
}
