//! Folders whose files belong to one run.

use std::collections::BTreeMap;
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
const HEADING: &str = "# Files of one run of host-sim: the next run in this folder removes them";

/// The files of one run for one folder. They appear together, and the files of an earlier run are
/// removed. Files that this program did not write and files that were changed afterwards are kept.
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
    /// be written, the folder does not change.
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
            let new: BTreeMap<_, _> = new.collect();
            // The manifest names the files of both runs until all files are moved.
            let mut both = old.clone();
            both.extend(new.clone());
            list(&mut file, &both).map_err(failed(MANIFEST))?;
            for (name, sum) in old.iter().filter(|(name, _)| !new.contains_key(*name)) {
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

/// The manifest, locked against another process until it is closed, and the files in it.
fn read(path: &Path) -> io::Result<(File, BTreeMap<String, u64>)> {
    let mut options = OpenOptions::new();
    let mut file = options
        .read(true)
        .write(true)
        .create(true)
        .truncate(false)
        .open(path)?;
    // Some file systems have no locks.
    let _ = file.lock();
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
    let files = files.collect();
    Ok((file, files))
}

/// Writes the manifest.
fn list(file: &mut File, files: &BTreeMap<String, u64>) -> io::Result<()> {
    let mut text = format!("{HEADING}\n");
    for (name, sum) in files {
        text += &format!("{sum:016x} {name}\n");
    }
    file.rewind()?;
    file.set_len(0)?;
    file.write_all(text.as_bytes())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn write(path: &Path, files: &[(&str, &str)]) -> Result<(), Failure> {
        let mut folder = Folder::new(path);
        for (name, text) in files {
            folder.add(*name, *text);
        }
        folder.write()
    }

    #[test]
    fn files_of_an_earlier_run_are_removed_and_others_are_kept() {
        let outside = tempfile::tempdir().unwrap();
        let path = outside.path().join("out");
        let old = [
            ("index.html", "1"),
            ("figures/01.svg", "1"),
            ("a.csv", "1"),
            ("b.csv", "1"),
        ];
        write(&path, &old).unwrap();
        fs::write(path.join("notes.txt"), "mine").unwrap();
        fs::write(path.join("b.csv"), "changed").unwrap();
        write(&path, &[("index.html", "2"), ("more/01.svg", "2")]).unwrap();
        let text = |name: &str| fs::read_to_string(path.join(name)).ok();
        assert_eq!(text("index.html").as_deref(), Some("2"));
        assert_eq!(text("more/01.svg").as_deref(), Some("2"));
        assert_eq!(text("notes.txt").as_deref(), Some("mine"));
        assert_eq!(text("b.csv").as_deref(), Some("changed"));
        assert_eq!(
            (text("a.csv"), path.join("figures").exists()),
            (None, false)
        );
        let left = fs::read_dir(&path).unwrap().count();
        assert_eq!(
            left, 5,
            "index.html, more, notes.txt, b.csv and the manifest"
        );
    }

    #[test]
    fn failed_run_keeps_the_old_report() {
        let outside = tempfile::tempdir().unwrap();
        let path = outside.path().join("out");
        write(&path, &[("index.html", "1"), ("z.csv", "1")]).unwrap();
        fs::create_dir(path.join("scores.csv")).unwrap();
        let error = write(&path, &[("index.html", "2"), ("scores.csv", "2")]).unwrap_err();
        assert!(
            error.to_string().contains("scores.csv: cannot write"),
            "{error}"
        );
        let text = |name: &str| fs::read_to_string(path.join(name)).unwrap();
        assert_eq!(
            (text("index.html"), text("z.csv")),
            ("1".into(), "1".into())
        );
        assert_eq!(fs::read_dir(&path).unwrap().count(), 4);
        let file = outside.path().join("file");
        fs::write(&file, "a file").unwrap();
        assert!(write(&file.join("deep"), &[("a", "1")]).is_err());
    }

    #[test]
    fn folder_without_a_place_is_refused() {
        let outside = tempfile::tempdir().unwrap();
        let file = outside.path().join("a.csv");
        fs::write(&file, "a file").unwrap();
        let said = |path: &Path| Folder::check("--out", path).map_err(|error| error.to_string());
        assert_eq!(said(outside.path()), Ok(()));
        assert_eq!(said(&outside.path().join("new/er")), Ok(()));
        assert_eq!(said(Path::new("new")), Ok(()));
        for path in [file.clone(), file.join(""), file.join("deep/er")] {
            let error = said(&path).unwrap_err();
            assert!(error.contains("a.csv is no folder"), "{error}");
        }
        assert!(said(Path::new("-")).unwrap_err().contains("name a folder"));
        assert_eq!(fs::read_dir(outside.path()).unwrap().count(), 1);
        // Nobody, not even root, creates a file there.
        #[cfg(target_os = "linux")]
        for path in ["/sys", "/sys/new/er"] {
            let error = said(Path::new(path)).unwrap_err();
            let begin = format!("--out {path}: cannot write: ");
            assert!(error.starts_with(&begin), "{error}");
        }
    }

    #[test]
    fn manifest_with_a_path_outside_the_folder_removes_nothing() {
        let outside = tempfile::tempdir().unwrap();
        let path = outside.path().join("out");
        let inside = path.join("in");
        fs::create_dir_all(&inside).unwrap();
        fs::write(path.join("precious"), "x").unwrap();
        let line = format!("{:016x} ../precious\n", sum(b"x"));
        fs::write(inside.join(MANIFEST), line).unwrap();
        write(&inside, &[("a", "1")]).unwrap();
        assert!(path.join("precious").exists());
    }
}
