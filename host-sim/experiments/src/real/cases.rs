//! The recordings of a folder, and the runs that are made of them.

use std::path::Path;

use rayon::prelude::*;

use recordings::log::Log;
use recordings::recording::Recording;
use terminal::failure::Failure;

use super::coarsen::Coarse;
use super::fine::Fine;
use super::run::Settings;
use super::sources::{self, Role, Source};

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
    /// Reads the first `seconds` of the recordings that the list of `folder` names.
    ///
    /// # Errors
    /// [`Failure::Input`] that names the file and what is wrong.
    pub fn read(folder: &Path, seconds: f64) -> Result<Self, Failure> {
        let listed = sources::read(folder)?;
        let read = |source: Source| Ok((source.clone(), data(folder, &source, seconds)?));
        let all: Result<Vec<_>, Failure> = listed.into_par_iter().map(read).collect();
        all.map(Self)
    }

    /// The recordings that were read, in the order of the list.
    pub fn sources(&self) -> impl Iterator<Item = &Source> {
        self.0.iter().map(|(source, _)| source)
    }

    /// What is said about the counts of fine recordings, one line each.
    pub fn notes(&self) -> impl Iterator<Item = String> {
        self.0.iter().flat_map(|(source, data)| {
            let notes = match data {
                Data::Fine(fine) => fine.notes.as_slice(),
                Data::Coarse(_) => &[],
            };
            notes.iter().map(|note| format!("{}: {note}", source.file))
        })
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
                    let resolved =
                        |case: &Case| coarse(case, source, settings).is_resolved_by(fine);
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
    pub fn recording(&self, case: &Case, settings: &Settings) -> Result<Recording, Failure> {
        let (source, data) = &self.0[case.recording];
        match data {
            Data::Fine(fine) => coarse(case, source, settings).recording(fine, &source.file),
            Data::Coarse(recording) => Ok((**recording).clone()),
        }
    }

    /// The recording of one case at another rate, which may be above that of the rows of a fine
    /// recording; a coarse recording keeps its own.
    ///
    /// # Errors
    /// As [`Coarse::along`].
    pub fn recording_at(
        &self,
        case: &Case,
        settings: &Settings,
        rate_hz: f64,
    ) -> Result<Recording, Failure> {
        let (source, data) = &self.0[case.recording];
        let coarse = Coarse {
            rate_hz,
            ..coarse(case, source, settings)
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

/// The first `seconds` of the recording `source` of `folder`.
fn data(folder: &Path, source: &Source, seconds: f64) -> Result<Data, Failure> {
    let path = folder.join(&source.file);
    let name = path.display().to_string();
    let missing = || {
        Failure::Input(format!(
            "{name}: line 1: no column with the true velocity; add it, or remove the file from {}",
            sources::LIST
        ))
    };
    match source.kind {
        sources::Kind::Fine => {
            let mut fine = Fine::read(&path, seconds)?;
            let remedy = format!("in {}", sources::LIST);
            fine.unwrap_counts(source.counts_per_rev, &remedy);
            fine.omega
                .is_some()
                .then_some(Data::Fine(fine))
                .ok_or_else(missing)
        }
        sources::Kind::Coarse => {
            let mut recording = Recording::parse(Log::open(&path)?.reader()?, &name)?;
            if recording.trace.true_omega.is_none() {
                return Err(missing());
            }
            shorten(&mut recording, seconds);
            Ok(Data::Coarse(Box::new(recording)))
        }
    }
}

/// Keeps the first `seconds`.
fn shorten(recording: &mut Recording, seconds: f64) {
    let start = recording.t[0];
    let rows = recording.t.partition_point(|t| t - start <= seconds);
    let trace = &mut recording.trace;
    recording.t.truncate(rows);
    trace.counts_large.truncate(rows);
    let columns = [
        &mut trace.current,
        &mut recording.current_small,
        &mut trace.true_omega,
    ];
    columns
        .into_iter()
        .flatten()
        .for_each(|column| column.truncate(rows));
    trace
        .counts_small
        .iter_mut()
        .for_each(|column| column.truncate(rows));
    trace
        .edges
        .iter_mut()
        .for_each(|column| column.truncate(rows));
}

/// The coarse encoder of a run.
fn coarse(case: &Case, source: &Source, settings: &Settings) -> Coarse {
    Coarse {
        fine_counts_per_rev: source.counts_per_rev,
        counts_per_rev: case.counts_per_rev,
        rate_hz: case.rate_hz,
        phase: case.phase.unwrap_or_default(),
        torque_constant: settings.device.stages.large.torque_constant,
    }
}
