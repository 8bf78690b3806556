//! The pages show what the files of `measured/` contain, and the lists agree.

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};

use measured::tables::{ALL, WITHOUT_PAGE};

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..")
}

fn entries(folder: &Path) -> impl Iterator<Item = PathBuf> {
    let entries = fs::read_dir(folder).expect("a folder");
    entries.map(|entry| entry.expect("an entry").path())
}

/// The pages: README.md and all of docs.
fn pages() -> Vec<PathBuf> {
    let mut pages = vec![root().join("README.md")];
    let mut folders = vec![root().join("docs")];
    while let Some(folder) = folders.pop() {
        for path in entries(&folder) {
            if path.is_dir() {
                folders.push(path);
            } else if path.extension().is_some_and(|extension| extension == "md") {
                pages.push(path);
            }
        }
    }
    pages
}

/// Page and name of every measured block.
fn blocks() -> Vec<(String, String)> {
    let mut blocks = Vec::new();
    for path in pages() {
        let text = fs::read_to_string(&path).expect("a page");
        let page = path.strip_prefix(root()).expect("a page of the repository");
        for rest in text.split("<!-- measured: ").skip(1) {
            let (name, _) = rest.split_once(" -->").expect("the end of the comment");
            blocks.push((page.display().to_string(), name.to_owned()));
        }
    }
    blocks.sort();
    blocks
}

#[test]
fn every_block_shows_its_file() {
    let wrong: Vec<_> = ALL
        .iter()
        .filter_map(|table| table.check_page().err())
        .collect();
    assert!(wrong.is_empty(), "{wrong:#?}");
}

#[test]
fn every_block_is_that_of_one_table() {
    let mut tables: Vec<_> = ALL
        .iter()
        .map(|table| (table.page.to_owned(), table.name.to_owned()))
        .collect();
    tables.sort();
    assert_eq!(blocks(), tables);
}

#[test]
fn every_file_is_that_of_a_table() {
    let paths = entries(Path::new(env!("CARGO_MANIFEST_DIR")));
    let csv = paths.filter(|path| path.extension().is_some_and(|extension| extension == "csv"));
    let files: BTreeSet<_> = csv
        .map(|path| path.file_stem().expect("a name").display().to_string())
        .collect();
    let tables = ALL.iter().map(|table| table.name).chain(WITHOUT_PAGE);
    assert_eq!(files, tables.map(str::to_owned).collect());
}

#[test]
fn every_command_is_a_line_of_the_script() {
    let script = fs::read_to_string(root().join(".ci/measure")).expect(".ci/measure");
    let lines: BTreeSet<_> = script.lines().collect();
    for table in ALL {
        assert!(
            lines.contains(table.command),
            "{}: {}",
            table.name,
            table.command
        );
    }
}
