//! Files that are either whole or not there.

use std::fs;
use std::io::Write as _;
use std::path::{Path, PathBuf};

use crate::failure::Failure;

/// Writes `bytes` to `path`, creating its folder: to a file beside it first, then renamed, so
/// that an interrupted run leaves no half file and an old file survives a failure.
///
/// # Errors
/// [`Failure::Input`] that names the file.
pub fn write_whole(path: &Path, bytes: &[u8]) -> Result<(), Failure> {
    let failed = |error: std::io::Error| {
        Failure::Input(format!(
            "{}: cannot write: {error}; choose another place",
            path.display()
        ))
    };
    if let Some(folder) = path
        .parent()
        .filter(|folder| !folder.as_os_str().is_empty())
    {
        fs::create_dir_all(folder).map_err(failed)?;
    }
    let partial = partial_path(path);
    let result = fs::File::create(&partial)
        .and_then(|mut file| file.write_all(bytes))
        .and_then(|()| fs::rename(&partial, path));
    if result.is_err() {
        // Best effort: the error that matters is the first one.
        let _ = fs::remove_file(&partial);
    }
    result.map_err(failed)
}

/// Writes `bytes` to standard output; a reader that has gone away is not an error.
///
/// # Errors
/// [`Failure::Input`] on any other failure.
pub fn print_bytes(bytes: &[u8]) -> Result<(), Failure> {
    let mut out = std::io::stdout().lock();
    match out.write_all(bytes).and_then(|()| out.flush()) {
        Err(error) if error.kind() != std::io::ErrorKind::BrokenPipe => {
            Err(Failure::Input(format!("standard output: {error}")))
        }
        _ => Ok(()),
    }
}

/// Writes a line to standard error; that nobody reads it is no reason to stop.
pub fn note(line: impl std::fmt::Display) {
    let _ = writeln!(std::io::stderr(), "{line}");
}

fn partial_path(path: &Path) -> PathBuf {
    let mut name = path.as_os_str().to_owned();
    name.push(format!(".partial-{}", std::process::id()));
    name.into()
}

#[cfg(test)]
mod tests {
    use super::write_whole;

    #[test]
    fn a_failed_write_leaves_nothing() {
        let folder = std::env::temp_dir().join(format!("limpid-output-{}", std::process::id()));
        let file = folder.join("deep/er/file.txt");
        write_whole(&file, b"whole").unwrap();
        assert_eq!(std::fs::read(&file).unwrap(), b"whole");
        // A folder of that name cannot be replaced by a file.
        let error = write_whole(&folder.join("deep"), b"x").unwrap_err();
        assert!(error.to_string().contains("deep: cannot write"), "{error}");
        let left: Vec<_> = std::fs::read_dir(&folder).unwrap().collect();
        assert_eq!(left.len(), 1);
        std::fs::remove_dir_all(folder).unwrap();
    }
}
