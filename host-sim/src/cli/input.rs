//! Input files, one of which can be standard input.

use std::io::Read as _;
use std::path::Path;

use terminal::failure::Failure;

/// Name of standard input in messages, and as a recording.
const STDIN: &str = "standard input";

/// Whether `path` stands for standard input.
pub(super) fn is_stdin(path: &Path) -> bool {
    path.as_os_str() == "-"
}

/// Name of the file `path` in messages.
pub(super) fn called(path: &Path) -> String {
    match is_stdin(path) {
        true => STDIN.to_owned(),
        false => path.display().to_string(),
    }
}

/// Name of the recording in the file `path`: the file's name.
pub(super) fn short_name(path: &Path) -> String {
    match is_stdin(path) {
        true => STDIN.to_owned(),
        false => experiments::replay::name(path),
    }
}

/// Reads a file, or standard input if `path` is -.
///
/// # Errors
/// [`Failure::Input`] that names the file.
pub(super) fn read(path: &Path) -> Result<Vec<u8>, Failure> {
    let read = match is_stdin(path) {
        false => std::fs::read(path),
        true => {
            let mut bytes = Vec::new();
            let read = std::io::stdin().lock().read_to_end(&mut bytes);
            read.map(|_| bytes)
        }
    };
    read.map_err(|error| Failure::Input(format!("{}: cannot read: {error}", called(path))))
}
