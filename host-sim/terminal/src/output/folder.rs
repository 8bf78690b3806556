//! Folders whose files belong to one run.

use std::collections::{BTreeMap, BTreeSet};
use std::fs::{self, File, OpenOptions};
use std::io::{self, ErrorKind, Read as _, Seek as _, Write as _};
use std::path::{Path, PathBuf};

use super::partial::{Partial, uninterrupted};
use super::{cannot_write, in_folders, is_stdout};
use crate::checksum::sum;
use crate::failure::Failure;

/// Name of the manifest, which lists the files of the latest run. The next run removes them.
const MANIFEST: &str = ".host-sim-files";

/// First line of [`MANIFEST`].
const HEADING: &str = "# Files of one run: the next run in this folder replaces or removes them";

/// The files of one run for one folder. They appear together, and the files of an earlier run are
/// removed. Files that this program did not write and files that were changed afterwards are kept: a run that
/// would replace one of them is refused. A file is of an earlier run if the manifest lists its name and the
/// checksum of its bytes.
#[derive(Debug)]
pub struct Folder {
    path: PathBuf,
    files: BTreeMap<String, Vec<u8>>,
}

impl Folder {
    /// An empty list of files for the folder `path`. [`Folder::write`] creates the folder.
    #[must_use]
    pub fn new(path: &Path) -> Self {
        Self {
            path: path.to_owned(),
            files: BTreeMap::new(),
        }
    }

    /// Checks that the folder `path` has a place, so that a long run does not find out at its end: it is not
    /// standard output, and is not, and does not lie in, something that is no folder, or a folder in which no
    /// file can be created.
    ///
    /// # Errors
    /// [`Failure::Input`] that names `option`.
    pub fn check(option: &str, path: &Path) -> Result<(), Failure> {
        let name = path.display();
        if is_stdout(path) {
            return Err(Failure::Input(format!(
                "{option} {name}: writes a folder, which cannot go to standard output; name a folder"
            )));
        }
        // Without a slash at the end, with which a file does not exist.
        let path: PathBuf = path.components().collect();
        in_folders(path.ancestors(), &format_args!("{option} {name}"))
    }

    /// Checks that none of `names` in the folder `path` is a file that [`Folder::write`] would refuse to replace.
    ///
    /// # Errors
    /// [`Failure::Input`] that names `option` and the file.
    pub fn check_files<'a>(
        option: &str,
        path: &Path,
        names: impl IntoIterator<Item = &'a str>,
    ) -> Result<(), Failure> {
        let old = earlier(path);
        let mut places = names.into_iter().map(|name| (name, path.join(name)));
        match places.find(|(name, place)| !is_replaceable(place, name, &old, None)) {
            None => Ok(()),
            Some((_, place)) => Err(Failure::Input(format!(
                "{option} {}: {}",
                path.display(),
                not_ours(&place)
            ))),
        }
    }

    /// Adds a file. `name` may contain subfolders.
    pub fn add(&mut self, name: impl Into<String>, bytes: impl Into<Vec<u8>>) {
        self.files.insert(name.into(), bytes.into());
    }

    /// Path of the file `name`.
    #[must_use]
    pub fn file(&self, name: &str) -> PathBuf {
        self.path.join(name)
    }

    /// Writes all files to a temporary folder and then moves them to the folder. If a file cannot
    /// be written, or would replace one that is not of an earlier run, the folder does not change.
    ///
    /// # Errors
    /// [`Failure::Input`] that names the file.
    pub fn write(self) -> Result<(), Failure> {
        let created = !self.path.exists();
        let written = self.replace();
        if created && written.is_err() {
            // Succeeds only if it is empty.
            let _ = fs::remove_dir(&self.path);
        }
        written
    }

    fn replace(&self) -> Result<(), Failure> {
        let failed = |name: &str| {
            let path = self.file(name);
            move |error: io::Error| cannot_write(&path, &error)
        };
        let old = earlier(&self.path);
        let mut files = self.files.iter();
        if let Some((name, _)) =
            files.find(|(name, bytes)| !is_replaceable(&self.file(name), name, &old, Some(bytes)))
        {
            return Err(Failure::Input(not_ours(&self.file(name))));
        }
        fs::create_dir_all(&self.path).map_err(failed(""))?;
        let aside = Partial::folder(&self.file("report")).map_err(failed(""))?;
        for (name, bytes) in &self.files {
            let path = aside.path().join(name);
            let folder = path.parent().map_or(Ok(()), fs::create_dir_all);
            let written = folder.and_then(|()| fs::write(&path, bytes));
            written.map_err(failed(name))?;
            let place = self.file(name);
            if place.is_dir() {
                return Err(failed(name)(ErrorKind::IsADirectory.into()));
            }
            let folder = place.parent().map_or(Ok(()), fs::create_dir_all);
            folder.map_err(failed(name))?;
        }
        uninterrupted(|| {
            let (mut file, old) = read(&self.file(MANIFEST)).map_err(failed(MANIFEST))?;
            let new = self
                .files
                .iter()
                .map(|(name, bytes)| (name.clone(), sum(bytes)));
            let new: BTreeSet<_> = new.collect();
            // The manifest has the files of both runs until all files are moved.
            let both = &old | &new;
            list(&mut file, &both).map_err(failed(MANIFEST))?;
            for (name, sum) in old
                .iter()
                .filter(|(name, _)| !self.files.contains_key(name))
            {
                self.remove(name, *sum);
            }
            for name in self.files.keys() {
                let path = aside.path().join(name);
                fs::rename(path, self.file(name)).map_err(failed(name))?;
            }
            list(&mut file, &new).map_err(failed(MANIFEST))
        })
    }

    /// Removes the file `name` of an earlier run if it is unchanged, and then its folder if the
    /// folder is empty.
    fn remove(&self, name: &str, written: u64) {
        let path = self.file(name);
        if fs::read(&path).is_ok_and(|bytes| sum(&bytes) == written) {
            let _ = fs::remove_file(&path);
        }
        if let Some(folder) = path.parent().filter(|folder| *folder != self.path) {
            let _ = fs::remove_dir(folder);
        }
    }
}

/// Files of runs: their names and the checksums of their bytes.
type Listed = BTreeSet<(String, u64)>;

/// The files of earlier runs in the folder `path`; none without a manifest.
fn earlier(path: &Path) -> Listed {
    let listed = File::open(path.join(MANIFEST)).and_then(|mut file| {
        // Waits for a run that replaces the files at this moment.
        let _ = file.lock_shared();
        listed(&mut file)
    });
    listed.unwrap_or_default()
}

/// Whether a run may write the file `name` at `path`: there is none, or it is one of the files `old` of earlier
/// runs, or it has these bytes already.
fn is_replaceable(path: &Path, name: &str, old: &Listed, bytes: Option<&[u8]>) -> bool {
    match fs::metadata(path) {
        Err(error) => error.kind() == ErrorKind::NotFound,
        // Said elsewhere.
        Ok(found) if found.is_dir() => true,
        Ok(found) if !found.is_file() => false,
        Ok(_) => fs::read(path).is_ok_and(|there| {
            bytes == Some(&there[..]) || old.contains(&(name.to_owned(), sum(&there)))
        }),
    }
}

/// Message about a file that no run may replace.
fn not_ours(path: &Path) -> String {
    format!(
        "{} was not written by an earlier run, or was changed since; choose another folder, or move this file away",
        path.display()
    )
}

/// The manifest, locked against another process until it is closed, and the files in it.
fn read(path: &Path) -> io::Result<(File, Listed)> {
    let mut options = OpenOptions::new();
    let mut file = options
        .read(true)
        .write(true)
        .create(true)
        .truncate(false)
        .open(path)?;
    // Some file systems have no locks.
    let _ = file.lock();
    let files = listed(&mut file)?;
    Ok((file, files))
}

/// The files in a manifest.
fn listed(file: &mut File) -> io::Result<Listed> {
    let mut text = String::new();
    file.read_to_string(&mut text)?;
    let files = text.lines().filter_map(|line| {
        let (sum, name) = line.split_once(' ')?;
        // This program does not write outside the folder, so such a name is not from it.
        let inside = Path::new(name)
            .components()
            .all(|part| matches!(part, std::path::Component::Normal(_)));
        let sum = u64::from_str_radix(sum, 16).ok()?;
        inside.then(|| (name.to_owned(), sum))
    });
    Ok(files.collect())
}

/// Writes the manifest.
fn list(file: &mut File, files: &Listed) -> io::Result<()> {
    let mut text = format!("{HEADING}\n");
    for (name, sum) in files {
        text += &format!("{sum:016x} {name}\n");
    }
    file.rewind()?;
    file.set_len(0)?;
    file.write_all(text.as_bytes())
}

#[cfg(test)]
mod tests;
