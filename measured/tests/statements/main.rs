//! What the pages say beside their tables holds for the files of `measured/`. A figure in a statement is
//! rounded as the page shows it, and the words of most statements are made from the file.

mod cost;
mod errors;
mod estimators;
mod feel;
mod numerics;
mod stops;

use std::fs;
use std::path::Path;

use measured::{Row, Table, digits};

fn rows(table: &Table) -> Vec<Row> {
    table.read().unwrap_or_else(|error| panic!("{error}"))
}

fn name(row: &Row) -> &str {
    row.text("estimator").expect("a name")
}

/// The number in a column; `None` where the table has a dash.
fn number(row: &Row, column: &str) -> Option<f64> {
    row.number(column).ok()
}

/// The number in a column of the row that begins with `wanted`.
fn of(rows: &[Row], wanted: &str, column: &str) -> f64 {
    let is = |row: &&Row| {
        let first = row.names().next().expect("a column");
        row.text(first) == Ok(wanted)
    };
    let found = rows.iter().find(is);
    let found = found.unwrap_or_else(|| panic!("no row {wanted}"));
    found
        .number(column)
        .unwrap_or_else(|error| panic!("{error}"))
}

/// Least and largest of some numbers.
fn span(numbers: impl IntoIterator<Item = f64>) -> [f64; 2] {
    let numbers: Vec<_> = numbers.into_iter().collect();
    assert!(!numbers.is_empty());
    let least = numbers.iter().copied().fold(f64::INFINITY, f64::min);
    let most = numbers.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    [least, most]
}

/// Least and largest number in a column, with so many digits, of the rows for which `is_one` holds.
fn range(rows: &[Row], column: &str, digits: usize, is_one: impl Fn(&Row) -> bool) -> [String; 2] {
    let found = rows.iter().filter(|row| is_one(row));
    span(found.filter_map(|row| number(row, column))).map(|it| digits::rounded(it, digits))
}

/// The least and the largest number, as a page has them.
fn between([least, most]: [impl std::fmt::Display; 2]) -> String {
    format!("{least} to {most}")
}

/// Numbers with one digit behind the point.
fn tenths<const N: usize>(numbers: [f64; N]) -> [String; N] {
    numbers.map(|number| format!("{number:.1}"))
}

/// Whole numbers.
fn whole<const N: usize>(numbers: [f64; N]) -> [String; N] {
    numbers.map(|number| format!("{:.0}", number.round()))
}

/// The words of a page of the repository, with one space between them.
fn words(page: &str) -> String {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    let text = fs::read_to_string(root.join(page)).expect(page);
    text.split_whitespace().collect::<Vec<_>>().join(" ")
}

/// The page has these statements. An edit of a statement is one of its test, too.
fn says(page: &str, statements: &[String]) {
    let words = words(page);
    let missing: Vec<_> = statements
        .iter()
        .filter(|statement| !words.contains(&***statement))
        .collect();
    assert!(missing.is_empty(), "{page} lacks {missing:#?}");
}
