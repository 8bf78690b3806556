//! A command-line program in a folder of its own.
#![allow(dead_code, reason = "not every test program uses everything")]

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::io::Write as _;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};

use tempfile::TempDir;

/// Arguments as one text, or as a list where one of them has a space.
pub(crate) trait Arguments {
    /// The arguments one by one.
    fn list(&self) -> Vec<&str>;
}

impl Arguments for str {
    fn list(&self) -> Vec<&str> {
        self.split_whitespace().collect()
    }
}

impl Arguments for String {
    fn list(&self) -> Vec<&str> {
        self.as_str().list()
    }
}

impl<S: AsRef<str>> Arguments for [S] {
    fn list(&self) -> Vec<&str> {
        self.iter().map(AsRef::as_ref).collect()
    }
}

impl<S: AsRef<str>, const N: usize> Arguments for [S; N] {
    fn list(&self) -> Vec<&str> {
        self.as_slice().list()
    }
}

impl<S: AsRef<str>> Arguments for Vec<S> {
    fn list(&self) -> Vec<&str> {
        self.as_slice().list()
    }
}

/// The project's `tests/data`, as seen from a [`Folder`].
///
/// The length of the path decides where a note is wrapped, so it must not depend on where the project lies.
pub(crate) const DATA: &str = "../data";

/// A folder in which a program runs, gone afterwards.
pub(crate) struct Folder {
    path: PathBuf,
    _around: TempDir,
    program: &'static str,
}

impl Folder {
    /// An empty folder, with [`DATA`] beside it.
    pub(crate) fn new(program: &'static str) -> Self {
        let around = tempfile::tempdir().unwrap();
        let path = around.path().join("here");
        fs::create_dir(&path).unwrap();
        let parents = Path::new(env!("CARGO_MANIFEST_DIR")).ancestors();
        let mut data = parents.map(|parent| parent.join("tests/data"));
        let data = data.find(|data| data.is_dir()).unwrap();
        link(&data, &path.join(DATA));
        Self {
            path,
            _around: around,
            program,
        }
    }

    pub(crate) fn path(&self) -> &Path {
        &self.path
    }

    pub(crate) fn write(&self, name: &str, text: impl AsRef<[u8]>) {
        fs::write(self.path().join(name), text).unwrap();
    }

    /// The text of a file.
    pub(crate) fn text(&self, name: &str) -> String {
        fs::read_to_string(self.path().join(name)).unwrap_or_else(|error| panic!("{name}: {error}"))
    }

    /// The names of all that is in the folder.
    pub(crate) fn names(&self) -> BTreeSet<String> {
        let name = |entry: std::io::Result<fs::DirEntry>| entry.unwrap().file_name();
        let names = fs::read_dir(self.path()).unwrap().map(name);
        names.map(|name| name.into_string().unwrap()).collect()
    }

    /// The program, ready to run. A test of outputs does not rewrite the project's tables.
    pub(crate) fn command(&self, arguments: &(impl Arguments + ?Sized)) -> Command {
        let mut command = Command::new(self.program);
        command
            .args(arguments.list())
            .env_remove("UPDATE_GOLDEN")
            .current_dir(self.path());
        command
    }

    /// Runs the program.
    pub(crate) fn run(&self, arguments: &(impl Arguments + ?Sized)) -> Output {
        self.command(arguments).output().unwrap()
    }

    /// Runs the program with something on its standard input.
    pub(crate) fn run_on(&self, arguments: &(impl Arguments + ?Sized), input: &[u8]) -> Output {
        let mut child = self
            .command(arguments)
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .unwrap();
        // One that refuses its arguments does not read.
        let _ = child.stdin.take().unwrap().write_all(input);
        child.wait_with_output().unwrap()
    }

    /// Standard output and error of a run that ends with `status`.
    pub(crate) fn ends(
        &self,
        status: i32,
        arguments: &(impl Arguments + ?Sized),
    ) -> (String, String) {
        texts(status, &self.run(arguments))
    }

    /// Standard output of a run that ended well.
    pub(crate) fn good(&self, arguments: &(impl Arguments + ?Sized)) -> String {
        self.ends(0, arguments).0
    }

    /// Standard output and error of a run that ended well.
    pub(crate) fn good_on(
        &self,
        arguments: &(impl Arguments + ?Sized),
        input: &[u8],
    ) -> (String, String) {
        texts(0, &self.run_on(arguments, input))
    }

    /// The one line of a run that was refused, which must leave every file as it was.
    pub(crate) fn refused(&self, arguments: &(impl Arguments + ?Sized)) -> String {
        self.refused_on(arguments, b"")
    }

    /// The same, with something on its standard input.
    pub(crate) fn refused_on(&self, arguments: &(impl Arguments + ?Sized), input: &[u8]) -> String {
        let arguments = arguments.list();
        let before = files(self.path());
        let (out, errors) = texts(2, &self.run_on(&arguments, input));
        assert!(out.is_empty(), "{arguments:?}: {out}");
        assert_eq!(errors.lines().count(), 1, "{arguments:?}: {errors}");
        assert!(errors.starts_with("error: "), "{arguments:?}: {errors}");
        assert!(files(self.path()) == before, "{arguments:?}");
        errors
    }
}

#[cfg(unix)]
fn link(folder: &Path, name: &Path) {
    std::os::unix::fs::symlink(folder, name).unwrap();
}

#[cfg(windows)]
fn link(folder: &Path, name: &Path) {
    std::os::windows::fs::symlink_dir(folder, name).unwrap();
}

/// Standard output and error of a run that must have ended with `status`.
fn texts(status: i32, output: &Output) -> (String, String) {
    let [out, errors] =
        [&output.stdout, &output.stderr].map(|text| String::from_utf8(text.clone()).unwrap());
    assert_eq!(output.status.code(), Some(status), "{errors}");
    (out, errors)
}

/// All files below a folder, with what is in those that are regular.
pub(crate) fn files(folder: &Path) -> BTreeMap<PathBuf, Vec<u8>> {
    let mut all = BTreeMap::new();
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        let kind = fs::symlink_metadata(&path).unwrap().file_type();
        if kind.is_dir() {
            all.extend(files(&path));
        } else {
            let is_readable = kind.is_file();
            let bytes = is_readable.then(|| fs::read(&path).unwrap());
            all.insert(path, bytes.unwrap_or_default());
        }
    }
    all
}
