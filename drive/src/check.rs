//! Lines of a report on a board.

use terminal::failure::Failure;

use crate::board::Board;

/// A line: what was checked, and what was found.
pub(crate) type Line = (&'static str, Result<String, String>);

/// Prints a line.
///
/// # Errors
/// [`Failure`] if standard output takes none.
pub(crate) fn show(board: &mut Board, (name, result): &Line) -> Result<(), Failure> {
    match result {
        Ok(text) => print(board, "pass", name, text),
        Err(text) => print(board, "FAIL", name, text),
    }
}

/// Prints why something was not checked.
///
/// # Errors
/// [`Failure`] if standard output takes none.
pub(crate) fn skip(board: &mut Board, name: &str, reason: &str) -> Result<(), Failure> {
    print(board, "skip", name, reason)
}

fn print(board: &mut Board, word: &str, name: &str, text: &str) -> Result<(), Failure> {
    board.print(&format!("{word}  {name:<22}{text}"))
}

/// Number of the lines that failed.
pub(crate) fn failed(lines: &[Line]) -> usize {
    lines.iter().filter(|(_, result)| result.is_err()).count()
}
