//! `cargo c-library` as somebody types it.

use std::fs;
use std::process::{Command, Output};

fn ran(arguments: &[&str], folder: &std::path::Path) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_limpid-dist"));
    command.current_dir(folder).args(arguments);
    command.output().expect("the program starts")
}

/// The line on standard error of a run that is refused.
fn refused(arguments: &[&str], folder: &std::path::Path) -> String {
    let output = ran(arguments, folder);
    let line = String::from_utf8(output.stderr).expect("text");
    assert_eq!(output.status.code(), Some(2), "{arguments:?}: {line}");
    assert!(output.stdout.is_empty(), "{arguments:?}");
    assert!(
        line.starts_with("error: ") && line.lines().count() == 1,
        "{arguments:?}: {line}"
    );
    line
}

#[test]
fn invalid_arguments_are_refused_in_one_line() {
    let folder = tempfile::tempdir().expect("a folder");
    fs::write(folder.path().join("file"), "mine").expect("written");
    for (arguments, said) in [
        (
            &[][..],
            "a command is missing; give one of header, libraries, arduino; see cargo c-library --help",
        ),
        (
            &["heade"],
            "tip: a similar subcommand exists: 'header'; see cargo c-library --help",
        ),
        (&["header"], "<FILE.h>; see cargo c-library --help"),
        (
            &["header", "."],
            ".: is a folder; choose the name of a file",
        ),
        (
            &["header", "file/limpid.h"],
            "file is no folder; choose another path",
        ),
        (
            &["libraries", "file"],
            "file is no folder; choose another path",
        ),
        (&["arduino", "-"], "name a folder"),
    ] {
        let line = refused(arguments, folder.path());
        assert!(line.contains(said), "{arguments:?}: {line}");
    }
    assert_eq!(fs::read_dir(folder.path()).expect("there").count(), 1);
}

#[test]
fn header_goes_to_a_file_or_to_standard_output() {
    let folder = tempfile::tempdir().expect("a folder");
    let header = limpid_dist::header().expect("a header");
    assert_eq!(
        String::from_utf8(ran(&["header", "-"], folder.path()).stdout).expect("text"),
        header
    );
    let output = ran(&["header", "new/limpid.h"], folder.path());
    assert_eq!(
        String::from_utf8(output.stdout).expect("text"),
        "new/limpid.h\n"
    );
    let written = fs::read_to_string(folder.path().join("new/limpid.h")).expect("written");
    assert_eq!(written, header);
}

#[cfg(target_os = "linux")]
#[test]
fn full_standard_output_is_an_error_and_no_panic() {
    let full = fs::File::options()
        .write(true)
        .open("/dev/full")
        .expect("a device");
    let folder = tempfile::tempdir().expect("a folder");
    let mut command = Command::new(env!("CARGO_BIN_EXE_limpid-dist"));
    command
        .current_dir(folder.path())
        .args(["header", "limpid.h"])
        .stdout(full);
    let output = command.output().expect("the program starts");
    let line = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(2), "{line}");
    assert!(line.starts_with("error: standard output: "), "{line}");
}

/// Said before the libraries are built, which takes minutes.
#[test]
fn file_that_no_run_wrote_is_not_replaced() {
    for (command, name) in [
        ("arduino", "library.properties"),
        ("arduino", "src/cortex-m4/liblimpid.a"),
        ("libraries", "include/limpid.h"),
        ("libraries", "host/liblimpid.a"),
    ] {
        let folder = tempfile::tempdir().expect("a folder");
        let file = folder.path().join("mine").join(name);
        fs::create_dir_all(file.parent().expect("a folder")).expect("made");
        fs::write(&file, "mine").expect("written");
        let line = refused(&[command, "mine"], folder.path());
        let said = format!(
            "mine/{name} was not written by an earlier run, or was changed since; choose another"
        );
        assert!(line.contains(&said), "{line}");
        assert_eq!(fs::read_to_string(&file).expect("there"), "mine");
    }
}
