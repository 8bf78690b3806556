//! Search of the parameters on recordings.
//!
//! Blocks of [`BLOCK_S`] of each recording alternate: on the first, the third and so on the search
//! minimises the RMS error, on the others the result is compared with the parameters as they were. An
//! estimator runs over the whole recording. The first [`WARM_UP_S`] of each block are not scored, so
//! that no error of a block is due to the motion of the block before it.

use std::collections::BTreeMap;

use device_files::six_digits;
use rayon::prelude::*;
use serde::{Deserialize, Serialize};
use shards::Experiment;

use super::search::{best_values, ends_of_ranges};
use crate::rates::check_same;
use crate::reference::{Reference, interruptions};
use crate::table::number;
use catalogue::estimators::{Kind, Lack, Setup, Values};
use catalogue::parameters::{Parameters, PlantKind, Preset, Presets};
use recordings::recording::Recording;
use simulation::device::Device;
use simulation::trace::Trace;
use terminal::failure::Failure;

/// Duration of a block, s.
const BLOCK_S: f64 = 1.0;

/// Duration at the start of each block that is not scored, s.
const WARM_UP_S: f64 = 0.1;

/// Shortest recording, in blocks.
const FEWEST_BLOCKS: f64 = 4.0;

/// All inputs of the searches on recordings. A job is the search of one estimator.
///
/// The recordings themselves are not serialised: a plan that was read back has the jobs and the results
/// of the run, and no rows can be computed from it.
#[derive(Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct LogPlan {
    logs: Vec<LogFile>,
    rate_hz: f64,
    device: Device,
    searches: Vec<LogSearch>,
    notes: Vec<String>,
    #[serde(skip)]
    tracks: Vec<Track>,
}

/// A recording as messages and shards know it.
#[derive(Clone, Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct LogFile {
    /// Name of the recording.
    pub name: String,
    /// Checksum of its file, in hexadecimal digits; empty for a recording that has no file.
    pub sum: String,
}

/// The search of one estimator on the recordings.
#[derive(Clone, Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct LogSearch {
    /// Name of the estimator.
    pub estimator: String,
    /// Values of its parameters before the search.
    before: Values,
}

/// Result of tuning one estimator on recordings. The errors are RMS errors, rad/s, in the tuned and in
/// the held-out half.
#[derive(Clone, Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct LogTuned {
    /// Values of the parameters by name.
    pub values: BTreeMap<String, f64>,
    /// Errors with the parameters as they were.
    #[serde(with = "shards::exact::two")]
    pub before: [f64; 2],
    /// Errors with the parameters that the search found.
    #[serde(with = "shards::exact::two")]
    pub found: [f64; 2],
    /// Whether the parameters are kept as they were, because the found ones are not better in the
    /// held-out half.
    pub kept: bool,
    /// One line for each parameter at a limit of its range, or if the parameters are kept.
    pub notes: Vec<String>,
}

/// A recording and the velocity that estimates are compared with, rad/s.
#[derive(Debug)]
struct Track {
    trace: Trace,
    omega: Vec<f64>,
}

impl LogPlan {
    /// The searches of those of the estimators `kinds`, which must have parameters, that run on all
    /// recordings. They begin with the parameters `before`.
    ///
    /// # Errors
    /// [`Failure::Input`] if a recording is too short, has another rate than the first or has neither a
    /// true velocity nor enough motion to estimate one, or if no estimator has the columns that it needs.
    pub fn new(
        recordings: Vec<(LogFile, Recording)>,
        device: Device,
        kinds: &[&'static Kind],
        before: &Parameters,
    ) -> Result<Self, Failure> {
        let rates = recordings
            .iter()
            .map(|(log, r)| (log.name.as_str(), r.trace.rate_hz));
        check_same(rates)?;
        let rate_hz = recordings.first().map_or(0.0, |(_, r)| r.trace.rate_hz);
        let setup = Setup::of(&device, rate_hz);
        let mut plan = Self {
            logs: Vec::new(),
            rate_hz,
            device,
            searches: Vec::new(),
            notes: Vec::new(),
            tracks: Vec::new(),
        };
        for (log, recording) in recordings {
            let interrupted = interruptions(&recording);
            (plan.notes).extend(interrupted.map(|line| format!("{}: {line}", log.name)));
            let (track, said) = track(&log.name, recording, rate_hz, &plan.device)?;
            plan.tracks.push(track);
            plan.notes.extend(said);
            plan.logs.push(log);
        }
        for kind in kinds {
            let lack = plan.tracks.iter().find_map(|track| kind.lack(&track.trace));
            let why = match lack {
                None => {
                    plan.searches.push(LogSearch {
                        estimator: kind.name.to_owned(),
                        before: before.values(kind, &setup, PlantKind::Friction),
                    });
                    continue;
                }
                Some(Lack::Column(_)) => "it needs other columns",
                Some(Lack::ConstantPeriod) => "it assumes a constant period",
            };
            plan.notes.push(format!("{}: left out, {why}", kind.name));
        }
        match plan.searches.is_empty() {
            false => Ok(plan),
            true => Err(Failure::Input(format!(
                "{}: no estimator to tune has the columns that it needs; see host-sim estimators",
                plan.logs.first().map_or("", |log| &log.name)
            ))),
        }
    }

    /// Adds what the reader of the recordings said, before all other notes.
    #[must_use]
    pub fn with_notes(mut self, mut notes: Vec<String>) -> Self {
        notes.append(&mut self.notes);
        self.notes = notes;
        self
    }

    /// The recordings.
    #[must_use]
    pub fn logs(&self) -> &[LogFile] {
        &self.logs
    }

    /// The presets of all searches, also of those whose parameters are kept, and all notes.
    #[must_use]
    pub fn presets(&self, tuned: &[LogTuned]) -> (Presets, Vec<String>) {
        let named = self.searches.iter().zip(tuned);
        let named = named.map(|(search, tuned)| (search.estimator.clone(), tuned.values.clone()));
        let preset = Preset {
            rate_hz: self.rate_hz,
            plant: PlantKind::Friction,
            counts_per_rev: Some(self.device.stages.large.counts_per_rev),
            estimators: named.collect(),
        };
        let presets = Presets {
            preset: vec![preset],
            ..Presets::default()
        };
        let found = tuned.iter().flat_map(|tuned| &tuned.notes);
        (presets, self.notes.iter().chain(found).cloned().collect())
    }

    /// As [`Experiment::rows`]; `look` is called before each evaluation, and may unwind to stop the search.
    ///
    /// # Errors
    /// As [`Experiment::rows`].
    pub fn rows_with_look(
        &self,
        jobs: &[LogSearch],
        done: &(dyn Fn() + Sync),
        look: &(dyn Fn() + Sync),
    ) -> Result<Vec<LogTuned>, Failure> {
        let rows = jobs.iter().map(|search| {
            let tuned = self.search(search, look);
            done();
            tuned
        });
        rows.collect()
    }

    fn search(&self, search: &LogSearch, look: &(dyn Fn() + Sync)) -> Result<LogTuned, Failure> {
        let kind = Kind::named(&search.estimator)?;
        let setup = Setup::of(&self.device, self.rate_hz);
        let old = search.before.clone();
        let errors = |values: &Values| errors(kind, &setup, &self.tracks, values);
        let new = best_values(kind, &setup, |values, _| {
            look();
            errors(values)[0]
        });
        let [before, found] = [&old, &new].map(errors);
        let kept = found[1] >= before[1];
        let notes = match kept {
            false => ends_of_ranges(kind, &setup, &new),
            true if old != new => vec![format!(
                "{}: the parameters are kept; the ones found are not better in the held-out half",
                kind.name
            )],
            true => Vec::new(),
        };
        let names = kind.parameters.iter().map(|p| p.name.to_owned());
        Ok(LogTuned {
            values: names.zip(if kept { old } else { new }).collect(),
            before,
            found,
            kept,
            notes,
        })
    }
}

impl Experiment for LogPlan {
    const COMMAND: &'static str = "host-sim tune on recordings";
    type Job = LogSearch;
    type Row = LogTuned;

    fn jobs(&self) -> Result<Vec<LogSearch>, Failure> {
        Ok(self.searches.clone())
    }

    fn rows(&self, jobs: &[LogSearch], done: &(dyn Fn() + Sync)) -> Result<Vec<LogTuned>, Failure> {
        self.rows_with_look(jobs, done, &|| ())
    }
}

/// The recording's track, with a note if the velocity is not in the recording.
fn track(
    name: &str,
    recording: Recording,
    rate_hz: f64,
    device: &Device,
) -> Result<(Track, Option<String>), Failure> {
    let trace = &recording.trace;
    let refused = |why: String| Err(Failure::Input(format!("{name}: {why}")));
    let seconds = trace.len() as f64 / trace.rate_hz;
    if seconds < FEWEST_BLOCKS * BLOCK_S {
        return refused(format!(
            "{} s are too short; tuning needs {} s, of which every second one is held out",
            six_digits(seconds),
            FEWEST_BLOCKS * BLOCK_S
        ));
    }
    let (omega, note) = match &trace.true_omega {
        Some(omega) => (omega.clone(), None),
        None => match Reference::of(&recording, device.stages.large.counts_per_rev) {
            Err(why) => return refused(format!("no column true_omega, and no reference: {why}")),
            Ok(reference) => {
                let sd = reference.rms_sd(rate_hz);
                let note = format!(
                    "{name}: no column true_omega; errors are those against a smoother of the log itself, \
                     whose own standard deviation is {} rad/s",
                    number(Some(sd))
                );
                (reference.omega, Some(note))
            }
        },
    };
    let trace = recording.trace;
    Ok((Track { trace, omega }, note))
}

/// RMS errors in the tuned and in the held-out half, rad/s; infinite if the estimator's design refuses
/// the values or an estimate is not finite.
fn errors(kind: &Kind, setup: &Setup, tracks: &[Track], values: &Values) -> [f64; 2] {
    let Ok(estimator) = kind.build(setup, values) else {
        return [f64::INFINITY; 2];
    };
    let of_track = |track: &Track| {
        let velocity = estimator.run(&track.trace);
        halves(&velocity, &track.omega, setup.rate.0)
    };
    let sums: Vec<_> = tracks.par_iter().map(of_track).collect();
    [0, 1].map(|half| {
        let squares: f64 = sums.iter().map(|sums| sums[half].0).sum();
        let samples: f64 = sums.iter().map(|sums| sums[half].1).sum();
        match (squares / samples).sqrt() {
            rms if rms.is_finite() => rms,
            _ => f64::INFINITY,
        }
    })
}

/// Sum of the squared errors and number of the scored samples of each half.
fn halves(velocity: &[f32], omega: &[f64], rate_hz: f64) -> [(f64, f64); 2] {
    let [block, warm_up] = [BLOCK_S, WARM_UP_S].map(|s| ((s * rate_hz).round() as usize).max(1));
    let mut halves = [(0.0, 0.0); 2];
    let blocks = velocity.chunks(block).zip(omega.chunks(block));
    for (number, (velocity, omega)) in blocks.enumerate() {
        let (squares, samples) = &mut halves[number % 2];
        for (velocity, omega) in velocity.iter().zip(omega).skip(warm_up) {
            *squares += (f64::from(*velocity) - omega).powi(2);
            *samples += 1.0;
        }
    }
    halves
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn samples_of_alternate_seconds_are_in_the_halves() {
        // Ten samples a second, of which the first is not scored.
        let velocity: Vec<f32> = (0..30)
            .map(|k| if k % 10 == 0 { 9.0 } else { 1.0 })
            .collect();
        let omega: Vec<_> = (0..30)
            .map(|k| if k / 10 == 1 { 3.0 } else { 0.0 })
            .collect();
        assert_eq!(halves(&velocity, &omega, 10.0), [(18.0, 18.0), (36.0, 9.0)]);
    }
}
