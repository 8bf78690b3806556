//! Temporary files and folders of an output that is being written.

use std::collections::BTreeSet;
use std::fs::{self, File};
use std::io::{self, ErrorKind};
use std::path::{Path, PathBuf};
use std::sync::{Mutex, MutexGuard, Once, PoisonError};

/// Temporary files and folders that an interrupt removes.
static PARTIAL: Mutex<BTreeSet<PathBuf>> = Mutex::new(BTreeSet::new());

/// Exit status after an interrupt: 128 and the number of SIGINT, as a shell reports it.
const INTERRUPTED: i32 = 130;

/// A temporary file or folder. It is removed when the value is dropped or the program is
/// interrupted.
pub(super) struct Partial(PathBuf);

impl Partial {
    /// A new temporary file in the folder of `path`.
    pub(super) fn file(path: &Path) -> io::Result<(Self, File)> {
        Self::new(path, |path| File::create_new(path))
    }

    /// A new temporary folder in the folder of `path`.
    pub(super) fn folder(path: &Path) -> io::Result<Self> {
        Self::new(path, |path| fs::create_dir(path)).map(|(partial, ())| partial)
    }

    /// Path of the temporary file or folder.
    pub(super) fn path(&self) -> &Path {
        &self.0
    }

    /// Renames the temporary file to its final path.
    pub(super) fn rename_to(self, path: &Path) -> io::Result<()> {
        uninterrupted(|| fs::rename(&self.0, path))
    }

    fn new<T>(path: &Path, create: impl Fn(&Path) -> io::Result<T>) -> io::Result<(Self, T)> {
        static HANDLER: Once = Once::new();
        // If signals cannot be handled, an interrupt leaves the temporary file behind.
        HANDLER.call_once(|| drop(ctrlc::set_handler(interrupted)));
        let mut partial = partial();
        for number in 0_u32.. {
            let name = name(path, number);
            match create(&name) {
                Err(error) if error.kind() == ErrorKind::AlreadyExists && number < 1000 => {}
                Err(error) => return Err(error),
                Ok(created) => {
                    partial.insert(name.clone());
                    return Ok((Self(name), created));
                }
            }
        }
        Err(ErrorKind::AlreadyExists.into())
    }
}

impl Drop for Partial {
    fn drop(&mut self) {
        let mut partial = partial();
        remove(&self.0);
        partial.remove(&self.0);
    }
}

/// Runs `work`. An interrupt ends the program only after `work` has ended.
pub(super) fn uninterrupted<T>(work: impl FnOnce() -> T) -> T {
    let _held = partial();
    work()
}

fn partial() -> MutexGuard<'static, BTreeSet<PathBuf>> {
    PARTIAL.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Removes the temporary files and ends the process. The lock is held until the process has ended,
/// so that no other thread creates a temporary file.
fn interrupted() {
    let partial = partial();
    partial.iter().for_each(|path| remove(path));
    std::process::exit(INTERRUPTED);
}

/// Removes a path. The error is ignored, because the path is absent after a rename.
fn remove(path: &Path) {
    if fs::remove_file(path).is_err() {
        let _ = fs::remove_dir_all(path);
    }
}

fn name(path: &Path, number: u32) -> PathBuf {
    let mut name = path.as_os_str().to_owned();
    name.push(format!(".partial-{}", std::process::id()));
    if number > 0 {
        name.push(format!("-{number}"));
    }
    name.into()
}
