//! Why a command ends early, and with which exit status.

use std::fmt;
use std::process::ExitCode;

use crate::output::note;

/// What ends a command early; the message is one line that says what to do.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Failure {
    /// A check did not hold: exit status 1.
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

/// The end of a program: what failed goes to standard error in one line.
#[must_use]
pub fn ended(done: Result<(), Failure>) -> ExitCode {
    match done {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => {
            note(format_args!("error: {failure}"));
            ExitCode::from(failure.status())
        }
    }
}

impl fmt::Display for Failure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (Self::Check(message) | Self::Input(message)) = self;
        // Whatever a library said, it stays one line.
        for (i, line) in message
            .lines()
            .map(str::trim)
            .filter(|l| !l.is_empty())
            .enumerate()
        {
            f.write_str(if i == 0 { "" } else { " " })?;
            f.write_str(line)?;
        }
        Ok(())
    }
}

impl std::error::Error for Failure {}

/// Errors of the device, the scenarios and the plots are all about input.
impl From<String> for Failure {
    fn from(message: String) -> Self {
        Self::Input(message)
    }
}
