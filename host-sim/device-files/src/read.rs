//! Text of an input file, and errors in it.

use std::path::Path;

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

/// The parser's error in one line, with the line's number and its key.
pub(crate) fn one_line(text: &str, error: &toml::de::Error) -> String {
    let what = error
        .message()
        .trim()
        .replace('\n', ", ")
        .replace("expected f64", "expected a number")
        .replace("expected u32", "expected a whole number from 0");
    let Some(span) = error.span() else {
        return what;
    };
    let before = &text.as_bytes()[..span.start.min(text.len())];
    let number = 1 + before.iter().filter(|&&byte| byte == b'\n').count();
    let line = text.lines().nth(number - 1).unwrap_or("");
    let key = line.split(['=', '#']).next().unwrap_or("").trim();
    if key.is_empty() {
        return format!("line {number}: {what}");
    }
    format!("line {number}, {key}: {what}")
}
