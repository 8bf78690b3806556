//! Frames of the image as the CSV that `host-sim replay` reads.

use std::path::Path;

use recordings::record::{choose, csv, write_longest};
use recordings::telemetry::Run;
use terminal::failure::Failure;

use crate::run::Outcome;

impl Outcome {
    /// The telemetry as converted by `host-sim record`, with the plant's velocity as `true_omega`.
    ///
    /// # Errors
    /// One line if the firmware sent fewer than two frames.
    pub fn csv(&self) -> Result<String, String> {
        let runs = self.telemetry.runs();
        let run = choose(&runs, None).map_err(|failure| failure.to_string())?;
        Ok(self.csv_of(run))
    }

    /// Writes the recording to the file `out`, and tells what it lacks, as `cargo drive record` does.
    ///
    /// # Errors
    /// Those of [`write_longest`].
    pub(crate) fn record(&self, out: &Path) -> Result<(), Failure> {
        write_longest(&self.telemetry, out, |run| self.csv_of(run))
    }

    fn csv_of(&self, run: &Run) -> String {
        let rate_hz = run.rate_hz().unwrap_or_else(|| self.rate_hz());
        csv(run, rate_hz, |frame| {
            self.tick(frame).map(|tick| tick.large.omega)
        })
    }
}
