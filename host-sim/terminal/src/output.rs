//! Output files. A file is complete or absent, even if the program is interrupted.
//!
//! A regular file is written under a temporary name in its folder and then renamed. The target of a
//! symbolic link is replaced, and the link does not change. A file that is read-only stays. A device, a pipe
//! or a socket is opened and written directly. `-` is standard output.

mod folder;
mod partial;

use std::fs::{self, File, OpenOptions};
use std::io::{self, BufWriter, ErrorKind, Write};
use std::path::{Path, PathBuf};

use crate::failure::Failure;
use crate::wording::harmless_lines;
pub use folder::Folder;
use partial::Partial;

/// Longest chain of symbolic links that is followed, as in Linux.
const MOST_LINKS: usize = 40;

/// Whether `path` stands for standard output: `-`, a name of the system for it, or a link to such a
/// name.
#[must_use]
pub fn is_stdout(path: &Path) -> bool {
    let names = ["-", "/dev/stdout", "/dev/fd/1", "/proc/self/fd/1"];
    links(path).any(|path| names.iter().any(|name| path.as_os_str() == *name))
}

/// Whether two paths are one file or folder, or will be one when it is written: also through links,
/// or with other folders in the path. Devices and pipes are no files.
#[must_use]
pub fn is_same(a: &Path, b: &Path) -> bool {
    place(a).is_some_and(|place_a| place(b) == Some(place_a))
}

/// The only name of a file or folder, which may not exist; `None` for a device, a pipe or standard
/// output.
fn place(path: &Path) -> Option<PathBuf> {
    if is_stdout(path) {
        return None;
    }
    let path = link_target(path).ok()?;
    match fs::canonicalize(&path) {
        Ok(place) => {
            let kind = fs::metadata(&place).ok()?;
            (kind.is_file() || kind.is_dir()).then_some(place)
        }
        Err(_) => {
            let path = std::path::absolute(&path).ok()?;
            let folder = path
                .parent()
                .and_then(|folder| fs::canonicalize(folder).ok());
            Some(match (folder, path.file_name()) {
                (Some(folder), Some(name)) => folder.join(name),
                _ => path,
            })
        }
    }
}

/// Checks that the file `path` has a place, so that a long run does not find out at its end.
///
/// # Errors
/// [`Failure::Input`] if the name is that of a folder or of a read-only file, or lies in something that is no folder,
/// or in a folder in which no file can be created.
pub fn check_place(path: &Path) -> Result<(), Failure> {
    let name = path.display();
    if path.is_dir() || ends_as_folder(path) {
        return Err(Failure::Input(format!(
            "{name}: is a folder; choose the name of a file"
        )));
    }
    if is_written_in_place(path) {
        return Ok(());
    }
    if fs::metadata(path).is_ok_and(|old| is_protected(&old)) {
        return Err(unwritable(&name, &protected()));
    }
    let path = link_target(path).unwrap_or_else(|_| path.to_owned());
    in_folders(path.ancestors().skip(1), &name)
}

/// Whether a file is read-only. A new file in its place would need no permission.
fn is_protected(old: &fs::Metadata) -> bool {
    old.is_file() && old.permissions().readonly()
}

fn protected() -> io::Error {
    io::Error::new(ErrorKind::PermissionDenied, "the file is read-only")
}

/// Checks that the first of `above` that exists is a folder that takes files; `name` is the output in the
/// message.
fn in_folders<'a>(
    above: impl Iterator<Item = &'a Path>,
    name: &dyn std::fmt::Display,
) -> Result<(), Failure> {
    // The path above a name alone is empty, and stands for the folder that the program runs in.
    let mut above = above.map(|path| match path.as_os_str().is_empty() {
        true => Path::new("."),
        false => path,
    });
    let Some(above) = above.find(|path| path.exists()) else {
        return Ok(());
    };
    if !above.is_dir() {
        return Err(Failure::Input(format!(
            "{name}: {} is no folder; choose another path",
            above.display()
        )));
    }
    // Permissions do not tell: the file system may be read-only. The file has no name, so that an interrupt
    // leaves none.
    let created = tempfile::tempfile_in(above);
    created.map(drop).map_err(|error| unwritable(name, &error))
}

/// Refuses the output `output` of `option` if it is the file `input`, which messages call `called`.
///
/// # Errors
/// [`Failure::Input`] that names both.
pub fn refuse_input(
    option: &str,
    output: &Path,
    input: &Path,
    called: impl std::fmt::Display,
) -> Result<(), Failure> {
    match is_same(output, input) {
        false => Ok(()),
        true => Err(Failure::Input(format!(
            "{option} {}: would overwrite the input {called}; name another file",
            output.display()
        ))),
    }
}

/// The error of an output that is one file with that of the option `other`.
#[must_use]
pub fn one_file(option: &str, output: &Path, other: &str) -> Failure {
    Failure::Input(format!(
        "{option} {}: is the file of {other} too; name another one",
        output.display()
    ))
}

/// Whether `path` ends with a separator, after which the system takes no file.
fn ends_as_folder(path: &Path) -> bool {
    let last = path.as_os_str().as_encoded_bytes().last();
    last.is_some_and(|byte| std::path::is_separator(char::from(*byte)))
}

/// Writes `bytes` to `path`, creating its folder; see [`write_with`].
///
/// # Errors
/// [`Failure::Input`] that names the file.
pub fn write_whole(path: &Path, bytes: &[u8]) -> Result<(), Failure> {
    write_with(path, |out| out.write_all(bytes))
}

/// Writes what `content` produces to `path`, creating its folder.
///
/// A regular file appears completely or not at all. After a failure or an interrupt an old file is
/// unchanged. A replaced file keeps its permissions.
///
/// # Errors
/// [`Failure::Input`] that names the file.
pub fn write_with(
    path: &Path,
    content: impl FnOnce(&mut dyn Write) -> io::Result<()>,
) -> Result<(), Failure> {
    if is_stdout(path) {
        return print_with(content);
    }
    write_file(path, content).map_err(|error| cannot_write(path, &error))
}

/// Writes `bytes` to standard output. A pipe whose reader has closed it is not an error.
///
/// # Errors
/// [`Failure::Input`] on any other failure.
pub fn print_bytes(bytes: &[u8]) -> Result<(), Failure> {
    print_with(|out| out.write_all(bytes))
}

/// Writes `bytes` to standard output. `false` if it is a pipe whose reader has closed it, so that nobody reads
/// what comes next.
///
/// # Errors
/// [`Failure::Input`] on any other failure.
pub fn print_to_reader(bytes: &[u8]) -> Result<bool, Failure> {
    let written = in_place(io::stdout().lock(), |out| out.write_all(bytes));
    written.map_err(|error| no_output(&error))
}

/// Writes a text for a person to standard output, with control characters of names and texts escaped; see
/// [`print_bytes`].
///
/// # Errors
/// [`Failure::Input`] on any failure but that of a pipe whose reader has closed it.
pub fn print_text(text: &str) -> Result<(), Failure> {
    print_bytes(harmless_lines(text).as_bytes())
}

/// Writes lines to standard error, with control characters of names and texts escaped. A closed standard error
/// does not end the command.
pub fn note(lines: impl std::fmt::Display) {
    let _ = writeln!(io::stderr(), "{}", harmless_lines(&lines.to_string()));
}

fn print_with(content: impl FnOnce(&mut dyn Write) -> io::Result<()>) -> Result<(), Failure> {
    let written = in_place(io::stdout().lock(), content);
    written.map(drop).map_err(|error| no_output(&error))
}

fn no_output(error: &io::Error) -> Failure {
    Failure::Input(format!("standard output: {error}"))
}

fn cannot_write(path: &Path, error: &io::Error) -> Failure {
    unwritable(&path.display(), error)
}

fn unwritable(name: &dyn std::fmt::Display, error: &io::Error) -> Failure {
    Failure::Input(format!(
        "{name}: cannot write: {error}; choose another path"
    ))
}

/// Whether `path` is written as it is and not replaced: a device, a pipe, or an inherited descriptor.
fn is_written_in_place(path: &Path) -> bool {
    let inherited = ["/dev/fd/", "/dev/std", "/proc/"];
    let is_inherited = |path: PathBuf| {
        let path = path.to_string_lossy();
        inherited.iter().any(|start| path.starts_with(start))
    };
    links(path).any(is_inherited) || fs::metadata(path).is_ok_and(|old| !old.is_file())
}

fn write_file(
    path: &Path,
    content: impl FnOnce(&mut dyn Write) -> io::Result<()>,
) -> io::Result<()> {
    let old = fs::metadata(path).ok();
    if old.as_ref().is_some_and(fs::Metadata::is_dir) || ends_as_folder(path) {
        return Err(ErrorKind::IsADirectory.into());
    }
    if is_written_in_place(path) {
        return in_place(OpenOptions::new().append(true).open(path)?, content).map(drop);
    }
    if old.as_ref().is_some_and(is_protected) {
        return Err(protected());
    }
    let path = link_target(path)?;
    if let Some(folder) = path
        .parent()
        .filter(|folder| !folder.as_os_str().is_empty())
    {
        fs::create_dir_all(folder)?;
    }
    let (partial, file) = Partial::file(&path)?;
    let mut file = BufWriter::new(file);
    content(&mut file)?;
    let file: File = file.into_inner()?;
    if let Some(old) = old {
        file.set_permissions(old.permissions())?;
    }
    drop(file);
    partial.rename_to(&path)
}

/// Writes through a buffer. A pipe whose reader has closed it is not an error: then the result is `false`.
fn in_place(
    out: impl Write,
    content: impl FnOnce(&mut dyn Write) -> io::Result<()>,
) -> io::Result<bool> {
    let mut out = BufWriter::new(out);
    match content(&mut out).and_then(|()| out.flush()) {
        Err(error) if error.kind() == ErrorKind::BrokenPipe => Ok(false),
        result => result.map(|()| true),
    }
}

/// `path` and the targets of its chain of symbolic links.
fn links(path: &Path) -> impl Iterator<Item = PathBuf> {
    let next = |path: &PathBuf| {
        let target = fs::read_link(path).ok()?;
        // A relative target is relative to the folder of its link.
        Some(path.parent().unwrap_or(Path::new("")).join(target))
    };
    std::iter::successors(Some(path.to_owned()), next).take(MOST_LINKS + 1)
}

/// The last target of the symbolic links from `path`, which may not exist.
fn link_target(path: &Path) -> io::Result<PathBuf> {
    let last = links(path).last().unwrap_or_default();
    match fs::read_link(&last) {
        Ok(_) => Err(io::Error::other("too many symbolic links")),
        Err(_) => Ok(last),
    }
}

#[cfg(test)]
mod tests;
