//! Designs that are refused: status, text, and storage that is not written.

use std::collections::BTreeSet;
use std::process::Command;

use c_interface::{Compiler, compiled, folder, missing};
use estimator_core::DesignError;
use limpid_dist::{COMPUTER, build};

const C99: Compiler = Compiler {
    program: "gcc",
    arguments: &[
        "-std=c99",
        "-O1",
        "-Wall",
        "-Wextra",
        "-Werror",
        "-pedantic",
    ],
};

/// Errors that no design in C has: `limpid.h` has no such estimator, or the range of a parameter leaves
/// them out.
const IMPOSSIBLE: [&str; 6] = [
    "BOUND",
    "SETTLE",
    "FADE",
    "DISTURBANCE_TIME",
    "FRICTION_SHARE",
    "BOUNDARY_NOISE",
];

/// No parameters are known for which a steady gain converges and is not stable.
const UNKNOWN: [&str; 1] = ["NOT_STABLE"];

#[test]
fn refused_design_has_the_status_of_its_error_and_writes_nothing() {
    if missing(C99.program) {
        return;
    }
    let library = build(&COMPUTER).expect("the library");
    let folder = folder("refused");
    let program = folder.join("refused");
    let library = library.to_str().expect("a path in UTF-8");
    let libraries = [library, "-lpthread", "-ldl", "-lm"];
    compiled(&C99, "refused.c", &folder, &libraries, &program);
    let output = Command::new(program).output().expect("the program starts");
    assert!(output.status.success(), "{output:?}");
    let text = String::from_utf8(output.stdout).expect("text");
    let mut refused = BTreeSet::new();
    for line in text.lines() {
        let mut words = line.splitn(5, ' ');
        let mut word = || words.next().expect("five words");
        let (constant, has, unchanged, status, said) = (word(), word(), word(), word(), word());
        assert_eq!(has, "1", "{line}");
        let expected = match constant.strip_prefix("LIMPID_ERROR_") {
            None => "no error",
            Some("RANGE") => {
                assert_eq!(status, "1", "{line}");
                "a parameter is outside of its range or not whole; see the type of the values"
            }
            Some(name) => {
                let known = DesignError::NAMES.iter().position(|known| *known == name);
                refused.insert(name);
                DesignError::ALL[known.expect("an error")].message()
            }
        };
        assert_eq!(said, expected, "{line}");
        let is_written = if constant == "LIMPID_OK" { "0" } else { "1" };
        assert_eq!(unchanged, is_written, "{line}");
    }
    let left_out = IMPOSSIBLE.iter().chain(&UNKNOWN).copied();
    let all: BTreeSet<_> = DesignError::NAMES.iter().copied().collect();
    assert_eq!(
        refused.into_iter().chain(left_out).collect::<BTreeSet<_>>(),
        all
    );
}
