//! Frames of the image as the CSV that `host-sim replay` reads.

use recordings::record::{choose, csv};

use crate::run::Outcome;

impl Outcome {
    /// The telemetry as converted by `host-sim record`, with the plant's velocity as `true_omega`.
    ///
    /// # Errors
    /// One line if the firmware sent fewer than two frames.
    pub fn csv(&self) -> Result<String, String> {
        let runs = self.telemetry.runs();
        let run = choose(&runs, None).map_err(|failure| failure.to_string())?;
        let rate_hz = run.rate_hz().unwrap_or_else(|| self.rate_hz());
        let true_omega = |frame: &_| self.tick(frame).map(|tick| tick.large.omega);
        Ok(csv(run, rate_hz, true_omega))
    }
}
