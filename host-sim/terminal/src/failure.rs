//! Failure of a command, with its exit status.

use std::fmt;
use std::process::ExitCode;

use crate::output::note;
use crate::wording::harmless;

/// Failure of a command. The message is one line with a remedy.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Failure {
    /// A check failed: exit status 1.
    Check(String),
    /// The input cannot be used, or the output cannot be written: exit status 2.
    Input(String),
}

impl Failure {
    /// Exit status of the process.
    #[must_use]
    pub fn status(&self) -> u8 {
        match self {
            Self::Check(_) => 1,
            Self::Input(_) => 2,
        }
    }
}

/// The exit status of a program that ends with `done`. A failure is printed on standard error in one
/// line.
#[must_use]
pub fn status(done: Result<(), Failure>) -> u8 {
    match done {
        Ok(()) => 0,
        Err(failure) => {
            note(format_args!("error: {failure}"));
            failure.status()
        }
    }
}

/// [`status`] as the exit code of `main`.
#[must_use]
pub fn ended(done: Result<(), Failure>) -> ExitCode {
    ExitCode::from(status(done))
}

impl fmt::Display for Failure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (Self::Check(message) | Self::Input(message)) = self;
        // Messages of libraries may have several lines.
        for (i, line) in message
            .lines()
            .map(str::trim)
            .filter(|l| !l.is_empty())
            .enumerate()
        {
            f.write_str(if i == 0 { "" } else { " " })?;
            f.write_str(&harmless(line))?;
        }
        Ok(())
    }
}

impl std::error::Error for Failure {}

/// A text is an error of the input.
impl From<String> for Failure {
    fn from(message: String) -> Self {
        Self::Input(message)
    }
}

#[cfg(test)]
mod tests {
    use super::Failure;

    #[test]
    fn message_is_one_line_without_control_characters() {
        let failure = Failure::Input("a\u{1b}[31mb.toml: \u{9b}0m\n \n  no\tkey".to_owned());
        assert_eq!(failure.to_string(), r"a\u{1b}[31mb.toml: \u{9b}0m no\tkey");
    }
}
