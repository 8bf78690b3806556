//! Messages of the command-line parser.

use clap::error::ErrorKind;

use crate::failure::Failure;

/// Prints help and version on standard output. Other errors of the parser become one line that
/// refers to the help of `program`.
///
/// # Errors
/// [`Failure::Input`] with this line.
pub fn explain(error: &clap::Error, program: &str) -> Result<(), Failure> {
    if let ErrorKind::DisplayHelp | ErrorKind::DisplayVersion = error.kind() {
        return crate::output::print_bytes(error.render().to_string().as_bytes());
    }
    let text = error.render().to_string();
    let said: Vec<_> = text
        .lines()
        .map(str::trim)
        .take_while(|line| !line.starts_with("Usage:") && !line.starts_with("For more"))
        .filter(|line| !line.is_empty())
        .collect();
    let said = said.join(" ");
    let said = said.strip_prefix("error: ").unwrap_or(&said);
    Err(Failure::Input(format!("{said}; see {program} --help")))
}
