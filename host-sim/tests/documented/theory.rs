//! The lists of estimators' theory pages, in docs/theory.md and docs/SUMMARY.md, made from the pages.
//!
//! `UPDATE_GOLDEN=1 cargo test --release --package host-sim --test documented theory` writes them.
//! The page of an estimator has a table with the heading row [`HEAD`].

use std::fs;
use std::path::{Path, PathBuf};

use catalogue::estimators::Kind;

/// Heading row of the table of an estimator's page, and of the list of all of them.
const HEAD: &str = "| estimator | example | g | RMS | delay | operations | state, bytes |";

/// The page of an estimator.
struct Page {
    /// Name of the file.
    file: String,
    /// Title.
    title: String,
    /// Rows of its table.
    rows: Vec<String>,
    /// Place of its first estimator in the catalogue; the number of estimators for none.
    place: usize,
}

fn docs(file: &str) -> PathBuf {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs");
    root.join(file)
}

/// The pages of estimators: those of the catalogue in its order, then the others by name.
fn pages() -> Vec<Page> {
    let files = fs::read_dir(docs("theory")).expect("docs/theory");
    let files = files.map(|file| file.expect("a page").path());
    let mut pages: Vec<_> = files.filter_map(|path| page(&path)).collect();
    pages.sort_by(|a, b| (a.place, &a.file).cmp(&(b.place, &b.file)));
    pages
}

fn page(path: &Path) -> Option<Page> {
    let text = fs::read_to_string(path).expect("a page");
    let rows: Vec<_> = text.lines().skip_while(|line| *line != HEAD).collect();
    if rows.is_empty() {
        return None;
    }
    let file = path.file_name()?.to_string_lossy().into_owned();
    let table = rows.iter().skip(2).take_while(|row| row.starts_with('|'));
    let title = text.lines().find_map(|line| line.strip_prefix("# "));
    let place = {
        // The words may stand on two lines.
        let text = text.replace('\n', " ");
        let (_, named) = text.split_once("**command line**").unwrap_or_default();
        let (named, _) = named.split_once("**reads**").unwrap_or_default();
        let is_named = |kind: &Kind| named.contains(&format!("`{}`", kind.name));
        Kind::all().iter().position(is_named)
    };
    Some(Page {
        title: title
            .unwrap_or_else(|| panic!("{file} has no title"))
            .to_owned(),
        rows: table.map(|row| listed(row, &file)).collect(),
        place: place.unwrap_or(Kind::all().len()),
        file,
    })
}

/// A row of a page as it stands in docs/theory.md: with a link to the page, and the links of its cells
/// from there.
fn listed(row: &str, file: &str) -> String {
    let cells = row.trim_start_matches("| ");
    let (name, rest) = cells.split_once(" | ").expect("a row of several cells");
    let rest = rest
        .replace("](", "](theory/")
        .replace("](theory/../", "](");
    format!("| [{name}](theory/{file}) | {rest}")
}

/// Writes the lines between two marks of a page of docs/, or compares them.
fn check(file: &str, begin: &str, end: &str, lines: &str) {
    let path = docs(file);
    let text = fs::read_to_string(&path).expect(file);
    let (before, rest) = text.split_once(begin).expect("the beginning of the list");
    let (written, after) = rest.split_once(end).expect("the end of the list");
    if std::env::var_os("UPDATE_GOLDEN").is_some_and(|value| value == "1") {
        fs::write(&path, format!("{before}{begin}{lines}{end}{after}"))
            .expect("docs can be written");
    } else {
        assert_eq!(
            written, lines,
            "docs/{file} differs from the pages: UPDATE_GOLDEN=1 writes the list anew"
        );
    }
}

#[test]
fn every_page_of_an_estimator_is_in_the_overview() {
    let rows: Vec<_> = pages().into_iter().flat_map(|page| page.rows).collect();
    assert!(rows.len() >= Kind::all().len() / 2, "{rows:#?}");
    let columns = HEAD.matches('|').count() - 1;
    let table = format!(
        "\n\n{HEAD}\n{}|\n{}\n\n",
        "|---".repeat(columns),
        rows.join("\n")
    );
    check(
        "theory.md",
        "<!-- estimators: written by the test documented -->",
        "<!-- end of estimators -->",
        &table,
    );
}

#[test]
fn every_page_of_an_estimator_is_in_the_contents() {
    let line = |page: &Page| format!("  - [{}](theory/{})\n", page.title, page.file);
    let lines: String = pages().iter().map(line).collect();
    check(
        "SUMMARY.md",
        "- [Estimators]()\n",
        "- [Gains at compile time]",
        &lines,
    );
}

#[test]
fn every_estimator_is_on_a_page_with_its_figures() {
    let pages = pages();
    for kind in Kind::all() {
        let names = format!("`{}`", kind.name);
        let is_there = pages.iter().any(|page| {
            let text = fs::read_to_string(docs("theory").join(&page.file)).expect("a page");
            text.contains(&names) && !page.rows.is_empty()
        });
        assert!(is_there, "no page with figures names {}", kind.name);
    }
}
