//! A whole run as jobs that do not depend on each other, so that shards divide it.

use std::path::PathBuf;

use rayon::prelude::*;
use serde::{Deserialize, Serialize};
use shards::Experiment;
use terminal::failure::Failure;

use crate::designs;
use crate::findings::Findings;
use crate::parts::{self, Plan};
use crate::sensitivity::{self, Outcome};
use crate::signals::{self, Difference};
use crate::tested::{TestedEstimator, at};

/// All inputs of a run.
#[derive(Clone, Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Settings {
    /// Ticks per estimator and rate.
    pub ticks: u64,
    /// Control rates, Hz.
    pub rates_hz: Vec<f64>,
    /// Begin of the names of the estimators; `None` for all.
    pub estimator: Option<String>,
    /// Seed of the course.
    pub seed: u64,
    /// File of finished parts. It changes no row.
    #[serde(skip)]
    pub resume: Option<PathBuf>,
}

/// The unit that is run as a whole. An estimator is given by its index in [`Settings::tested`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Job {
    /// Seed and ticks of a part of the course.
    Course(usize, (u64, u64)),
    /// The signals of a device.
    Signals(usize),
    /// The parameters at the limits of their ranges, of one kind.
    Limits(&'static str),
}

/// Result of a job.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub enum Row {
    /// Findings on a part of the course.
    Course(Findings),
    /// Error by f32 on signals of a device.
    Signals(Difference),
    /// Results at the limits of the parameters.
    Limits(Outcome),
}

/// All results of a run.
#[derive(Clone, Debug, Default)]
pub struct Results {
    /// Findings on each estimator.
    pub findings: Vec<Findings>,
    /// Error of each estimator by f32 on signals of a device.
    pub differences: Vec<Difference>,
    /// Results of each kind at the limits of its parameters.
    pub limits: Vec<Outcome>,
}

impl Settings {
    /// The tested estimators, in the order of the tables.
    ///
    /// # Errors
    /// [`Failure::Input`] if no estimator has such a name.
    pub fn tested(&self) -> Result<Vec<TestedEstimator>, Failure> {
        let all = self.rates_hz.iter().flat_map(|rate| at(*rate));
        let (kept, others): (Vec<_>, Vec<_>) = all.partition(|tested| {
            let begin = self.estimator.as_deref().unwrap_or_default();
            tested.name.starts_with(begin)
        });
        match (&self.estimator, kept.is_empty()) {
            (Some(wanted), true) => {
                let same_rate = |one: &&TestedEstimator| one.rate_hz == self.rates_hz[0];
                let names = others.iter().filter(same_rate).map(|one| one.name.as_str());
                Err(Failure::Input(format!(
                    "--estimator {wanted}: no such estimator; there are {}",
                    names.collect::<Vec<_>>().join(", ")
                )))
            }
            _ => Ok(kept),
        }
    }

    /// The command line of these settings.
    #[must_use]
    pub fn command(&self) -> String {
        let rates = self.rates_hz.iter().map(|rate| format!(" --rate {rate}"));
        let estimator = self.estimator.as_ref();
        let estimator = estimator.map_or(String::new(), |name| match name.contains(' ') {
            true => format!(" --estimator '{name}'"),
            false => format!(" --estimator {name}"),
        });
        let (ticks, seed) = (self.ticks, self.seed);
        let rates: String = rates.collect();
        format!("cargo stress --ticks {ticks}{rates}{estimator} --seed {seed}")
    }

    /// Joins the rows of all jobs, in their order.
    ///
    /// # Errors
    /// As [`Self::tested`].
    pub fn results(&self, rows: Vec<Row>) -> Result<Results, Failure> {
        let mut results = Results::default();
        let mut whole: Vec<Option<Findings>> = Vec::new();
        for (job, row) in self.jobs()?.into_iter().zip(rows) {
            match (job, row) {
                (Job::Course(at, _), Row::Course(part)) => {
                    whole.resize(whole.len().max(at + 1), None);
                    match &mut whole[at] {
                        Some(whole) => whole.join(part),
                        none => *none = Some(part),
                    }
                }
                (_, Row::Signals(difference)) => results.differences.push(difference),
                (_, Row::Limits(outcome)) => results.limits.push(outcome),
                (job, row) => {
                    let said = format!("the row of {job:?} is {row:?}; run the shards again");
                    return Err(Failure::Input(said));
                }
            }
        }
        results.findings = whole.into_iter().flatten().collect();
        for (found, tested) in results.findings.iter_mut().zip(self.tested()?) {
            found.bounds = tested.bounds;
        }
        Ok(results)
    }
}

impl Experiment for Settings {
    const COMMAND: &'static str = "cargo stress";
    type Job = Job;
    type Row = Row;

    fn jobs(&self) -> Result<Vec<Job>, Failure> {
        let plan = Plan {
            seed: self.seed,
            ticks: self.ticks,
        };
        let tested = self.tested()?;
        let all = 0..tested.len();
        let courses = all
            .clone()
            .flat_map(|at| plan.parts().map(move |part| Job::Course(at, part)));
        // A window in the name of a tested estimator follows that of its kind.
        let begin = self.estimator.as_deref().unwrap_or_default();
        let is_tested = |kind: &str| {
            let mut kinds = tested.iter().filter_map(|one| one.name.split(' ').next());
            kind.starts_with(begin) || kinds.any(|tested| tested == kind)
        };
        let kinds = designs::kinds().into_iter().filter(|kind| is_tested(kind));
        let signals = all.map(Job::Signals);
        Ok(courses
            .chain(signals)
            .chain(kinds.map(Job::Limits))
            .collect())
    }

    fn rows(&self, jobs: &[Job], done: &(dyn Fn() + Sync)) -> Result<Vec<Row>, Failure> {
        let tested = self.tested()?;
        let courses = jobs.iter().filter_map(|job| match job {
            Job::Course(at, part) => Some((&tested[*at], *part)),
            _ => None,
        });
        let courses: Vec<_> = courses.collect();
        let courses = parts::run(&courses, self.resume.as_deref(), done)?;
        let mut rows: Vec<Row> = courses.into_iter().map(Row::Course).collect();

        let signals = jobs.iter().filter_map(|job| match job {
            Job::Signals(at) => Some(&tested[*at]),
            _ => None,
        });
        let signals: Vec<_> = signals.collect();
        for same_rate in signals.chunk_by(|a, b| a.rate_hz == b.rate_hz) {
            let scenarios = signals::at(same_rate[0].rate_hz, self.seed);
            let found = same_rate.par_iter().map(|one| {
                let found = signals::difference(one, &scenarios);
                done();
                Row::Signals(found)
            });
            rows.par_extend(found);
        }

        let kinds = jobs.iter().filter_map(|job| match job {
            Job::Limits(kind) => Some(*kind),
            _ => None,
        });
        let kinds: Vec<_> = kinds.collect();
        rows.par_extend(kinds.par_iter().map(|kind| {
            let outcome = sensitivity::outcome(kind);
            done();
            Row::Limits(outcome)
        }));
        Ok(rows)
    }
}
