//! Lines of a report on a board.

use terminal::failure::Failure;
use terminal::output::print_bytes;

/// A line: what was checked, and what was found.
pub(crate) type Line = (&'static str, Result<String, String>);

/// Prints a line.
///
/// # Errors
/// [`Failure`] if standard output takes none.
pub(crate) fn show((name, result): &Line) -> Result<(), Failure> {
    match result {
        Ok(text) => print("pass", name, text),
        Err(text) => print("FAIL", name, text),
    }
}

/// Prints why something was not checked.
///
/// # Errors
/// [`Failure`] if standard output takes none.
pub(crate) fn skip(name: &str, reason: &str) -> Result<(), Failure> {
    print("skip", name, reason)
}

fn print(word: &str, name: &str, text: &str) -> Result<(), Failure> {
    print_bytes(format!("{word}  {name:<22}{text}\n").as_bytes())
}

/// Number of the lines that failed.
pub(crate) fn failed(lines: &[Line]) -> usize {
    lines.iter().filter(|(_, result)| result.is_err()).count()
}
