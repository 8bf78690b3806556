//! A command-line program in a folder of its own: for the tests that give arguments as one text.
#![allow(dead_code, reason = "not every test program uses everything")]

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

/// A folder of its own for each test, gone afterwards, in which a program runs.
pub(crate) struct Folder {
    /// The folder.
    pub(crate) path: PathBuf,
    program: &'static str,
}

impl Folder {
    /// A folder for `test`, which is unique in the test program.
    pub(crate) fn new(test: &str, program: &'static str) -> Self {
        let name = Path::new(program).file_name().unwrap().to_str().unwrap();
        let path = std::env::temp_dir().join(format!("{name}-{test}-{}", std::process::id()));
        fs::create_dir_all(&path).unwrap();
        Self { path, program }
    }

    /// Runs the program. A test of outputs does not rewrite the project's tables.
    pub(crate) fn run(&self, arguments: &str) -> Output {
        Command::new(self.program)
            .args(arguments.split_whitespace())
            .env_remove("UPDATE_GOLDEN")
            .current_dir(&self.path)
            .output()
            .unwrap()
    }

    /// Standard output and error of a run that ends with `status`.
    pub(crate) fn ends(&self, status: i32, arguments: &str) -> (String, String) {
        let output = self.run(arguments);
        let errors = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(status), "{arguments}: {errors}");
        (String::from_utf8(output.stdout).unwrap(), errors)
    }

    /// Standard output of a run without a failure.
    pub(crate) fn good(&self, arguments: &str) -> String {
        self.ends(0, arguments).0
    }

    /// The one line of a run that was refused, which must leave every file as it was.
    pub(crate) fn refused(&self, arguments: &str) -> String {
        let before = files(&self.path);
        let (out, errors) = self.ends(2, arguments);
        assert!(out.is_empty(), "{arguments}: {out}");
        assert_eq!(errors.lines().count(), 1, "{arguments}: {errors}");
        assert!(files(&self.path) == before, "{arguments}");
        errors
    }

    /// The text of a file.
    pub(crate) fn text(&self, name: &str) -> String {
        fs::read_to_string(self.path.join(name)).unwrap_or_else(|error| panic!("{name}: {error}"))
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        let _ = fs::remove_dir_all(&self.path);
    }
}

/// All files below a folder.
pub(crate) fn files(folder: &Path) -> BTreeMap<PathBuf, Vec<u8>> {
    let mut all = BTreeMap::new();
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            all.extend(files(&path));
        } else {
            all.insert(path.clone(), fs::read(path).unwrap());
        }
    }
    all
}
