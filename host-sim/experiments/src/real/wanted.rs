//! A coarse recording that a user asks for, from the file of a fine one.

use std::path::Path;

use recordings::arguments::{ColumnOptions, differing_counts};
use recordings::log::Log;
use recordings::recording::{Recording, SLOWEST_HZ, stated_counts_per_rev};
use simulation::device::Device;
use simulation::simulate::RATES_HZ;
use terminal::failure::Failure;

use super::coarsen::Coarse;
use super::fine::Fine;
use super::sources::{LIST, Source};

/// What is asked for.
#[derive(Clone, Debug)]
pub struct Wanted {
    /// Counts per revolution of the coarse encoder.
    pub counts_per_rev: u32,
    /// Counts per revolution of the fine encoder; `None` for those in the list beside the file.
    pub fine_counts_per_rev: Option<u32>,
    /// Rate of the ticks, Hz.
    pub rate_hz: f64,
    /// Position of the coarse encoder's boundaries, coarse counts.
    pub phase: f64,
    /// The part that is used, s from its start; `None` for all.
    pub seconds: Option<f64>,
    /// Columns of the fine recording.
    pub columns: ColumnOptions,
    /// The device, whose torque constant turns torques into currents.
    pub device: Device,
}

impl Wanted {
    /// The coarse recording of the fine one in the file `path`, which may be compressed by gzip.
    ///
    /// # Errors
    /// [`Failure::Input`] that names the option, or the file and what is wrong.
    pub fn of_file(&self, path: &Path) -> Result<Recording, Failure> {
        rate(self.rate_hz)?;
        phase(self.phase)?;
        let seconds = self.seconds.map_or(Ok(f64::INFINITY), seconds)?;
        let log = Log::open(path)?;
        let (fine_counts_per_rev, differing) = self.fine_counts(&log)?;
        let coarse = Coarse {
            fine_counts_per_rev,
            counts_per_rev: self.counts_per_rev,
            rate_hz: self.rate_hz,
            phase: self.phase,
        };
        let mut device = self.device.clone();
        device.stages.large.counts_per_rev = fine_counts_per_rev;
        let options = self.columns.options(&device)?;
        let options = options.with_counts_given("with --fine-counts-per-rev");
        let fine = Fine::read(&log, &options, seconds)?;
        let mut recording = coarse.recording(&fine, log.name())?;
        recording.notes.extend(differing);
        recording.notes.extend(fine.notes);
        recording.notes.extend(fine.unwrapped);
        Ok(recording)
    }

    /// Counts per revolution of the fine encoder: those of the option, of the list beside the file, or
    /// those that the text states; and a line if the text states others.
    fn fine_counts(&self, log: &Log) -> Result<(u32, Option<String>), Failure> {
        let stated = stated_counts_per_rev(&log.head()?, log.name())?;
        let (counts, source) = match self.fine_counts_per_rev {
            Some(given) => (Some(given), "the options"),
            None => match Source::of(log.path())? {
                Some(source) => (Some(source.counts_per_rev), LIST),
                None => (stated, ""),
            },
        };
        let counts = counts.ok_or_else(|| {
            Failure::Input(format!(
                "{}: its counts per revolution are not known; give --fine-counts-per-rev, or list the \
                 file in a recordings.toml beside it, or state them in its first line: # counts_per_rev = N",
                log.name()
            ))
        })?;
        let differing = stated.filter(|stated| *stated != counts);
        let line = differing.map(|stated| differing_counts(counts, source, stated));
        Ok((counts, line))
    }
}

/// A rate that a recording can have.
///
/// # Errors
/// [`Failure::Input`] that names the option.
pub fn rate(hz: f64) -> Result<f64, Failure> {
    in_range("--rate", hz, [SLOWEST_HZ, RATES_HZ.1], "Hz")
}

/// A phase.
///
/// # Errors
/// As [`rate`].
pub fn phase(counts: f64) -> Result<f64, Failure> {
    in_range("--phase", counts, [-1e6, 1e6], "counts")
}

/// A duration.
///
/// # Errors
/// As [`rate`].
pub fn seconds(s: f64) -> Result<f64, Failure> {
    in_range("--seconds", s, [0.2, 1e5], "s")
}

/// A value of an option between two bounds.
///
/// # Errors
/// As [`rate`].
pub fn in_range(
    option: &str,
    value: f64,
    [low, high]: [f64; 2],
    unit: &str,
) -> Result<f64, Failure> {
    match (low..=high).contains(&value) {
        true => Ok(value),
        false => Err(Failure::Input(format!(
            "{option} {value}: must be from {low} to {high} {unit}"
        ))),
    }
}
