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
    fn file_that_no_run_wrote_is_not_replaced() {
        let outside = tempfile::tempdir().unwrap();
        let path = outside.path().join("out");
        fs::create_dir(&path).unwrap();
        let text = |name: &str| fs::read_to_string(path.join(name)).ok();
        let check = || {
            Folder::check_files("--out", &path, ["index.html", "a.csv"])
                .map_err(|error| error.to_string())
        };
        let refused = |files: &[(&str, &str)], named: &str| {
            let said = write(&path, files).unwrap_err().to_string();
            let line =
                format!("{named} was not written by an earlier run, or was changed since; choose ");
            assert!(said.contains(&line), "{said}");
            let early = check().unwrap_err();
            assert!(
                early.starts_with("--out ") && early.contains(&line),
                "{early}"
            );
        };
        // Of the user; nothing else is left in the folder.
        fs::write(path.join("index.html"), "mine").unwrap();
        refused(&[("a.csv", "1"), ("index.html", "1")], "index.html");
        assert_eq!(text("index.html").as_deref(), Some("mine"));
        assert_eq!(fs::read_dir(&path).unwrap().count(), 1);
        // Moved away, and then changed after a run.
        fs::rename(path.join("index.html"), path.join("mine.html")).unwrap();
        assert_eq!(check(), Ok(()));
        write(&path, &[("a.csv", "1"), ("index.html", "1")]).unwrap();
        assert_eq!(check(), Ok(()));
        fs::write(path.join("a.csv"), "changed").unwrap();
        refused(&[("a.csv", "2"), ("index.html", "2")], "a.csv");
        assert_eq!(
            (text("a.csv"), text("index.html")),
            (Some("changed".into()), Some("1".into()))
        );
        // The same bytes lose nothing.
        write(&path, &[("a.csv", "changed"), ("index.html", "2")]).unwrap();
        assert_eq!(text("mine.html").as_deref(), Some("mine"));
    }

    #[test]
    fn interrupted_run_is_replaced() {
        // It had listed its files beside those of the run before, and moved one of them.
        let outside = tempfile::tempdir().unwrap();
        let path = outside.path().join("out");
        write(&path, &[("a", "1"), ("b", "1")]).unwrap();
        let listed = fs::read_to_string(path.join(MANIFEST)).unwrap();
        let more = format!("{listed}{:016x} a\n{:016x} b\n", sum(b"2"), sum(b"2"));
        fs::write(path.join(MANIFEST), more).unwrap();
        fs::write(path.join("a"), "2").unwrap();
        write(&path, &[("a", "3"), ("b", "3")]).unwrap();
        assert_eq!(fs::read(path.join("b")).unwrap(), b"3");
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
