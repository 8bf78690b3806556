//! The recording of a session.

use std::path::PathBuf;

use drivers::link::{Hello, Message};
use recordings::record::{choose, csv, report};
use recordings::telemetry::Telemetry;
use terminal::failure::Failure;
use terminal::output::{check_place, note, write_whole};

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
    /// [`Failure::Input`] if there are fewer than two frames, or the file cannot be written;
    /// [`Failure::Check`] after a start of the firmware, as the other runs are lost.
    pub(crate) fn write(self) -> Result<(), Failure> {
        let name = self.out.display();
        let runs = self.telemetry.runs();
        if runs.is_empty() {
            return Err(Failure::Input(format!(
                "{name}: not written: no telemetry frame came; record for longer"
            )));
        }
        let run = choose(&runs, None)
            .map_err(|error| Failure::Input(format!("{name}: not written: {error}")))?;
        write_whole(&self.out, csv(run, self.rate_hz, |_| None).as_bytes())?;
        for line in report(&self.telemetry, &runs, run, "") {
            note(format_args!("{name}: {line}"));
        }
        match runs.len() {
            1 => Ok(()),
            starts => Err(Failure::Check(format!(
                "{name}: the firmware started {starts} times, and only the longest run is in the file; find the \
                 cause of the reset, then record again"
            ))),
        }
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
