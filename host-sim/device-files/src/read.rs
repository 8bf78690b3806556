//! Text of an input file, and errors in it.

use std::path::Path;

use toml::de::{DeTable, DeValue};

/// The text of a regular file.
///
/// # Errors
/// One line that names the path, if it is not a readable file of UTF-8 text.
pub fn text(path: &Path) -> Result<String, String> {
    let named = |what: &dyn std::fmt::Display| format!("{}: {what}", path.display());
    let unread = |error| named(&format_args!("cannot read: {error}"));
    let metadata = std::fs::metadata(path).map_err(unread)?;
    if !metadata.is_file() {
        return Err(named(&"not a regular file; give a TOML file"));
    }
    std::fs::read_to_string(path).map_err(unread)
}

/// A step on the way to a value of a TOML text.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Step<'a> {
    /// To the value of a key.
    Key(&'a str),
    /// To an entry of an array, from 0.
    Entry(usize),
}

/// `error` with the number of the line that has the value at `path`; without it where the text has no such
/// value, as where the value is a default.
pub(crate) fn at_line(text: &str, path: &[Step], error: &str) -> String {
    match line_of(text, path) {
        Some(number) => format!("line {number}, {error}"),
        None => error.to_owned(),
    }
}

/// The line of `text`, from 1, with the value at `path`.
fn line_of(text: &str, path: &[Step]) -> Option<usize> {
    let table = DeTable::parse(text).ok()?;
    let (Step::Key(first), rest) = path.split_first()? else {
        return None;
    };
    let mut value = table.get_ref().get(*first)?;
    for step in rest {
        value = match (value.get_ref(), step) {
            (DeValue::Array(entries), Step::Entry(entry)) => entries.get(*entry)?,
            (DeValue::Table(table), Step::Key(key)) => table.get(*key)?,
            _ => return None,
        };
    }
    Some(line_at(text, value.span().start))
}

/// The number of the line, from 1, of a byte of `text`.
fn line_at(text: &str, byte: usize) -> usize {
    let before = &text.as_bytes()[..byte.min(text.len())];
    1 + before.iter().filter(|&&byte| byte == b'\n').count()
}

/// The parser's error in one line, with the line's number and its key.
pub(crate) fn one_line(text: &str, error: &toml::de::Error) -> String {
    let what = error
        .message()
        .trim()
        .replace('\n', ", ")
        .replace("expected f64", "expected a number")
        .replace(
            "expected u32",
            "expected a whole number from 0, without a decimal point",
        );
    let Some(span) = error.span() else {
        return what;
    };
    let number = line_at(text, span.start);
    let line = text.lines().nth(number - 1).unwrap_or("");
    let key = line.split(['=', '#']).next().unwrap_or("").trim();
    if key.is_empty() {
        return format!("line {number}: {what}");
    }
    let has_no_value = line
        .split_once('=')
        .is_some_and(|(_, value)| value.split('#').next().unwrap_or("").trim().is_empty());
    let what = match key.starts_with("[[") && what.starts_with("invalid type: map") {
        true => "not a list of sections; write its name between single brackets".to_owned(),
        false if has_no_value => "no value; write one after '=', or remove the line".to_owned(),
        false => what,
    };
    format!("line {number}, {key}: {what}")
}
