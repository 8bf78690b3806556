//! The recordings of a folder, and the runs that are made of them.

use std::path::Path;

use recordings::log::Log;
use recordings::recording::{ReadOptions, Recording};
use simulation::device::Device;
use terminal::failure::Failure;

use super::coarsen::Coarse;
use super::fine::Fine;
use super::run::Settings;
use super::sources::{self, Role, Source};
use crate::parallel::in_order;

/// Largest relative difference of a coarse recording's rate from an asked one.
const SAME_RATE: f64 = 1e-3;

/// A recording as it was read.
#[derive(Clone, Debug)]
enum Data {
    Fine(Fine),
    Coarse(Box<Recording>),
}

/// The recordings of a folder.
#[derive(Clone, Debug)]
pub struct Recordings(Vec<(Source, Data)>);

impl Recordings {
    /// Reads the first `seconds` of the recordings that the list of `folder` names. The torque constant of
    /// `device` turns torques into currents.
    ///
    /// # Errors
    /// [`Failure::Input`] that names the first file, in order, that cannot be read, and what is wrong.
    pub fn read(folder: &Path, device: &Device, seconds: f64) -> Result<Self, Failure> {
        let listed = sources::read(folder)?;
        let read = |source: &Source| Ok((source.clone(), data(folder, source, device, seconds)?));
        in_order(&listed, read).map(Self)
    }

    /// The recordings that were read, in the order of the list.
    pub fn sources(&self) -> impl Iterator<Item = &Source> {
        self.0.iter().map(|(source, _)| source)
    }

    /// What is said about the recordings, one line each. What several have in common is said once.
    #[must_use]
    pub fn notes(&self) -> Vec<String> {
        let mut notes: Vec<(&String, &str, usize)> = Vec::new();
        for (source, data) in &self.0 {
            let of_file: Vec<_> = match data {
                Data::Fine(fine) => fine.notes.iter().chain(&fine.unwrapped).collect(),
                Data::Coarse(recording) => recording.notes.iter().collect(),
            };
            for note in of_file {
                match notes.iter_mut().find(|(known, ..)| *known == note) {
                    Some((.., others)) => *others += 1,
                    None => notes.push((note, &source.file, 0)),
                }
            }
        }
        let line = |(note, file, others): (&String, &str, usize)| match others {
            0 => format!("{file}: {note}"),
            others => format!("{file} and {others} more: {note}"),
        };
        notes.into_iter().map(line).collect()
    }

    /// The runs of `settings`, by rate, resolution, recording and phase; those of coarse recordings,
    /// at their own resolution and rate, are the last ones of that rate. What a fine recording does
    /// not resolve is left out.
    #[must_use]
    pub fn cases(&self, settings: &Settings) -> Vec<Case> {
        let mut cases = Vec::new();
        let all = || self.0.iter().enumerate();
        for &rate_hz in &settings.rates_hz {
            let case = |recording: usize, counts_per_rev, phase| {
                let source = &self.0[recording].0;
                Case {
                    recording,
                    name: source.name().to_owned(),
                    role: source.role,
                    counts_per_rev,
                    rate_hz,
                    phase,
                }
            };
            for &counts_per_rev in &settings.counts_per_rev {
                for (i, (source, data)) in all() {
                    let Data::Fine(fine) = data else { continue };
                    let phases = settings.phases.iter();
                    let of = phases.map(|&phase| case(i, counts_per_rev, Some(phase)));
                    let resolved = |case: &Case| coarse(case, source).is_resolved_by(fine);
                    cases.extend(of.filter(resolved));
                }
            }
            for (i, (source, data)) in all() {
                if let Data::Coarse(recording) = data
                    && (recording.trace.rate_hz / rate_hz - 1.0).abs() < SAME_RATE
                {
                    cases.push(case(i, source.counts_per_rev, None));
                }
            }
        }
        cases
    }

    /// The recording of one case, in the columns of `replay`.
    ///
    /// # Errors
    /// As [`Coarse::recording`].
    pub fn recording(&self, case: &Case) -> Result<Recording, Failure> {
        let (source, data) = &self.0[case.recording];
        match data {
            Data::Fine(fine) => coarse(case, source).recording(fine, &source.file),
            Data::Coarse(recording) => Ok((**recording).clone()),
        }
    }

    /// The recording of one case at another rate, which may be above that of the rows of a fine
    /// recording; a coarse recording keeps its own.
    ///
    /// # Errors
    /// As [`Coarse::along`].
    pub(crate) fn recording_at(&self, case: &Case, rate_hz: f64) -> Result<Recording, Failure> {
        let (source, data) = &self.0[case.recording];
        let coarse = Coarse {
            rate_hz,
            ..coarse(case, source)
        };
        match data {
            Data::Fine(fine) => coarse.along(fine, &source.file),
            Data::Coarse(recording) => Ok((**recording).clone()),
        }
    }
}

/// One run: a recording at a resolution, a rate and a phase.
#[derive(Clone, Debug, PartialEq)]
pub struct Case {
    /// Index of the recording.
    recording: usize,
    /// Its name.
    pub name: String,
    /// Its role.
    pub role: Role,
    /// Resolution of the encoder that the estimators read, counts per revolution.
    pub counts_per_rev: u32,
    /// Rate, Hz.
    pub rate_hz: f64,
    /// Phase of the coarse encoder, counts; `None` for a coarse recording.
    pub phase: Option<f64>,
}

impl Case {
    /// What estimators are designed for: `device` with the encoder of this case.
    #[must_use]
    pub fn device(&self, device: &Device) -> Device {
        let mut device = device.clone();
        device.stages.large.counts_per_rev = self.counts_per_rev;
        device
    }
}

/// The first `seconds` of the recording `source` of `folder`.
fn data(folder: &Path, source: &Source, device: &Device, seconds: f64) -> Result<Data, Failure> {
    let log = Log::open(&folder.join(&source.file))?;
    let mut device = device.clone();
    device.stages.large.counts_per_rev = source.counts_per_rev;
    let options = ReadOptions::of(&device).of_list(sources::LIST);
    let (data, has_truth) = match source.kind {
        sources::Kind::Fine => {
            let fine = Fine::read(&log, &options, seconds)?;
            let has_truth = fine.omega.is_some();
            (Data::Fine(fine), has_truth)
        }
        sources::Kind::Coarse => {
            let mut recording =
                Recording::parse_first(log.reader()?, log.name(), &options, seconds)?;
            recording.check_times(log.name())?;
            let unwrapped = recording.unwrap_counts(&options);
            recording.notes.extend(unwrapped);
            let has_truth = recording.trace.true_omega.is_some();
            (Data::Coarse(Box::new(recording)), has_truth)
        }
    };
    has_truth.then_some(data).ok_or_else(|| {
        Failure::Input(format!(
            "{}: line 1: no column with the true velocity; add it, or remove the file from {}",
            log.name(),
            sources::LIST
        ))
    })
}

/// The coarse encoder of a run.
fn coarse(case: &Case, source: &Source) -> Coarse {
    Coarse {
        fine_counts_per_rev: source.counts_per_rev,
        counts_per_rev: case.counts_per_rev,
        rate_hz: case.rate_hz,
        phase: case.phase.unwrap_or_default(),
    }
}
