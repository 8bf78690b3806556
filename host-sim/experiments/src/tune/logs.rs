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
use crate::reference::{Reference, remarks};
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
    /// The recordings, with a velocity that estimates are compared with.
    #[serde(skip)]
    tracks: Vec<Trace>,
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
            let (track, said) = track(&log.name, recording, rate_hz, &plan.device)?;
            plan.tracks.push(track);
            plan.notes.extend(said);
            plan.logs.push(log);
        }
        for kind in kinds {
            let lack = plan.tracks.iter().find_map(|track| kind.lack(track));
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

/// The columns of the recording with a velocity to compare with, and notes on rows that are no motion, and if
/// the velocity is not in the recording.
fn track(
    name: &str,
    mut recording: Recording,
    rate_hz: f64,
    device: &Device,
) -> Result<(Trace, Vec<String>), Failure> {
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
    let reference = match &trace.true_omega {
        Some(_) => None,
        None => match Reference::of(&recording, device.stages.large.counts_per_rev) {
            Err(why) => return refused(format!("no column true_omega, and no reference: {why}")),
            Ok(reference) => Some(reference),
        },
    };
    let counts_per_rev = device.stages.large.counts_per_rev;
    let said = remarks(&recording, reference.as_ref(), counts_per_rev);
    let mut notes: Vec<_> = (said.iter())
        .map(|line| format!("{name}: {line}"))
        .collect();
    if let Some(reference) = reference {
        notes.push(format!(
            "{name}: no column true_omega; errors are those against a smoother of the log itself, whose own \
             standard deviation is {} rad/s",
            number(Some(reference.rms_sd(rate_hz)))
        ));
        let rows = 0..recording.t.len();
        reference.to_trace(&mut recording.trace, rows);
    }
    Ok((recording.trace, notes))
}

/// RMS errors in the tuned and in the held-out half, rad/s; infinite if the estimator's design refuses
/// the values or an estimate is not finite.
fn errors(kind: &Kind, setup: &Setup, tracks: &[Trace], values: &Values) -> [f64; 2] {
    let Ok(estimator) = kind.build(setup, values) else {
        return [f64::INFINITY; 2];
    };
    let of_track = |track: &Trace| halves(&estimator.run(track), track);
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
fn halves(velocity: &[f32], track: &Trace) -> [(f64, f64); 2] {
    let rows = |s: f64| ((s * track.rate_hz).round() as usize).max(1);
    let [block, warm_up] = [BLOCK_S, WARM_UP_S].map(rows);
    let omega = track.true_omega.as_deref().unwrap_or_default();
    let is_scored = |k: &usize| {
        let is_known = track.known.as_ref().is_none_or(|known| known[*k]);
        is_known && k % block >= warm_up
    };
    let mut halves = [(0.0, 0.0); 2];
    for k in (0..velocity.len()).filter(is_scored) {
        let (squares, samples) = &mut halves[k / block % 2];
        *squares += (f64::from(velocity[k]) - omega[k]).powi(2);
        *samples += 1.0;
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
        let mut track = Trace {
            rate_hz: 10.0,
            true_omega: Some(omega),
            ..Trace::default()
        };
        assert_eq!(halves(&velocity, &track), [(18.0, 18.0), (36.0, 9.0)]);
        // The first of these is not scored anyway.
        let known = (0..30).map(|k| ![10, 11, 13, 29].contains(&k));
        track.known = Some(known.collect());
        assert_eq!(halves(&velocity, &track), [(17.0, 17.0), (28.0, 7.0)]);
    }
}
