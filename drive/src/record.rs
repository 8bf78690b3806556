//! The recording of a session.

use std::path::PathBuf;

use drivers::link::{Hello, Message};
use recordings::record::{csv, write_longest};
use recordings::telemetry::{Run, Telemetry};
use terminal::failure::Failure;
use terminal::output::check_place;

/// Telemetry that becomes a file at the end of a session.
pub(crate) struct Recorder {
    telemetry: Telemetry,
    rate_hz: f64,
    out: PathBuf,
}

impl Recorder {
    /// A recorder of an image for the file `out`.
    pub(crate) fn new(hello: &Hello, out: PathBuf) -> Self {
        let mut telemetry = Telemetry::default();
        telemetry.add(Message::Hello(*hello));
        Self {
            telemetry,
            rate_hz: f64::from(hello.rate),
            out,
        }
    }

    /// Checks that the file has a place.
    ///
    /// # Errors
    /// As [`check_place`].
    pub(crate) fn check(&self) -> Result<(), Failure> {
        check_place(&self.out)
    }

    /// Takes a message.
    pub(crate) fn take(&mut self, message: Message) {
        self.telemetry.add(message);
    }

    /// Writes the file, the longest run if the firmware started again.
    ///
    /// # Errors
    /// Those of [`write_longest`].
    pub(crate) fn write(self) -> Result<(), Failure> {
        let text = |run: &Run| csv(run, self.rate_hz, |_| None);
        write_longest(&self.telemetry, &self.out, text)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn older_file_stays_if_no_frame_came() {
        let hello = Hello {
            rate: 10_000,
            ..Hello::default()
        };
        let folder = tempfile::tempdir().unwrap();
        let out = folder.path().join("no-frame.csv");
        std::fs::write(&out, "old").unwrap();
        let failed = Recorder::new(&hello, out.clone()).write();
        let left = std::fs::read_to_string(&out).unwrap();
        assert!(
            failed
                .unwrap_err()
                .to_string()
                .contains("no telemetry frame came")
        );
        assert_eq!(left, "old");
    }
}
