//! The measured tables of the host simulation, and the names in the documentation.
//!
//! `UPDATE_GOLDEN=1 cargo test --release --package host-sim --test documented` writes the tables.

mod constants;
mod distances;
mod evidence;
mod feel;
mod forces;
mod in_the_loop;
mod lists;
mod pages;
mod real_motion;
mod runs;

use measured::Table;
use measured::digits::{rounded, within_a_tenth};

/// A figure in a file. A page shows two or three of its digits, so it is hardly ever rounded twice to
/// another value.
fn cell(value: f64) -> String {
    rounded(value, 6)
}

/// Writes the table, or fails where a figure moved by more than a tenth.
fn check(table: &Table, more: &[&str], rows: &[Vec<String>]) {
    let checked = table.check(more, rows, |_, then, now| within_a_tenth(then, now));
    checked.unwrap_or_else(|error| panic!("{error}"));
}
