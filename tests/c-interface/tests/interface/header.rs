//! The committed header is the one of this library, and exported headers exclude each other where they must.

use std::path::Path;
use std::process::Command;

use c_interface::{folder, missing};
use catalogue::estimators::{Kind, Setup};
use catalogue::parameters::{Parameters, PlantKind};
use estimator_core::Hertz;

#[test]
fn the_header_is_that_of_the_library() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../c/include/limpid.h");
    let header = limpid_dist::header().expect("cbindgen reads the library");
    if std::env::var_os("UPDATE_GOLDEN").is_some() {
        std::fs::write(&path, &header).expect("the header is writable");
    }
    let committed = std::fs::read_to_string(&path).expect("the header");
    assert!(
        committed == header,
        "c/include/limpid.h is old: cargo c-library header c/include/limpid.h writes it"
    );
}

/// What the compiler says of a file that includes the headers `pll` of two rates; nothing if it accepts them.
fn said(rates: [f64; 2], constant: Option<&str>) -> String {
    let folder = folder("two-headers");
    let kind = Kind::named("pll").expect("a row");
    for (file, rate, constant) in [("a.h", rates[0], None), ("b.h", rates[1], constant)] {
        let setup = Setup {
            rate: Hertz(rate),
            ..Setup::default()
        };
        let values = Parameters::default().values(kind, &setup, PlantKind::Friction);
        let header = kind.c(&setup, Hertz(84e6), &values, constant);
        std::fs::write(folder.join(file), header.expect("a header")).expect("target is writable");
    }
    let uses = |constant: &str, prefix: &str| format!("{prefix}_RATE_HZ * sizeof({constant})");
    let mut value = uses("limpid_pll_parameters", "LIMPID_PLL");
    if let Some(constant) = constant {
        value += &format!(" + {}", uses(constant, &constant.to_uppercase()));
    }
    let text = format!(
        "#include \"a.h\"\n#include \"b.h\"\nint main(void) {{ return (int)({value}); }}\n"
    );
    std::fs::write(folder.join("main.c"), text).expect("target is writable");
    let output = Command::new("gcc")
        .args([
            "-std=c99",
            "-Wall",
            "-Wextra",
            "-Werror",
            "-fsyntax-only",
            "-I",
        ])
        .arg(Path::new(env!("CARGO_MANIFEST_DIR")).join("../../c/include"))
        .arg(folder.join("main.c"))
        .output()
        .expect("the compiler starts");
    String::from_utf8_lossy(&output.stderr).into_owned()
}

#[test]
fn headers_of_two_encoders_need_two_names() {
    if missing("gcc") {
        return;
    }
    let refused = said([1000.0, 10_000.0], None);
    let text = "two headers define limpid_pll_parameters: export one of them with --constant NAME";
    assert!(refused.contains(text), "{refused}");
    assert_eq!(said([1000.0, 10_000.0], Some("wheel")), "");
    // One header twice.
    assert_eq!(said([1000.0, 1000.0], None), "");
}
