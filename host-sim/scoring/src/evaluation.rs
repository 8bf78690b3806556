//! Evaluation of estimators on one trace.

mod sectioned;

use std::collections::BTreeMap;

use serde::Serialize;

use crate::score::{HapticInterval, Score, Wanted};
use catalogue::estimators::{DIFFERENCE, Estimator, Kind, Setup};
use catalogue::parameters::{Parameters, PlantKind};
use simulation::trace::Trace;
use terminal::failure::Failure;

pub use sectioned::Scoring;

/// The scores of one estimator on one trace. It is an object of the JSON output and a row of the
/// CSV.
#[derive(Clone, Debug, Serialize)]
pub struct Row {
    /// Name of the scenario, or file name of the recording.
    pub scenario: String,
    /// Control rate, Hz.
    pub rate_hz: f64,
    /// Whether the plant has friction. A real motor has.
    pub plant: PlantKind,
    /// Seed; 0 for a recording.
    pub seed: u64,
    /// Name of the estimator.
    pub estimator: &'static str,
    /// Scores of the estimator.
    #[serde(flatten)]
    pub score: Score,
    /// Parameters of the estimator.
    pub parameters: BTreeMap<&'static str, f64>,
}

/// Start of a run that the score of the learned damping ignores, s.
pub const LEARNING_S: f64 = 3.0;

/// The fields that all rows of one trace have in common.
#[derive(Clone, Debug)]
pub struct Heading {
    /// See [`Row::scenario`].
    pub scenario: String,
    /// See [`Row::rate_hz`].
    pub rate_hz: f64,
    /// See [`Row::plant`].
    pub plant: PlantKind,
    /// See [`Row::seed`].
    pub seed: u64,
}

/// An estimator that is built for one device and one control rate.
pub struct Candidate {
    /// Kind of the estimator.
    pub kind: &'static Kind,
    /// Values of its parameters.
    pub values: Vec<f64>,
    estimator: Estimator,
}

/// The velocities of an estimator over a trace, rad/s.
#[derive(Clone, Debug)]
pub struct Estimate {
    /// Name of the estimator.
    pub estimator: &'static str,
    /// One velocity per tick.
    pub velocity: Vec<f32>,
    /// Standard deviation of each velocity, rad/s; `None` if the estimator does not report it.
    pub deviation: Option<Vec<f32>>,
    /// Ratio of the coupler's learned damping to the assumed one at each tick; `None` if the estimator does
    /// not learn it, or if the ratio is not known.
    pub damping_ratio: Option<Vec<f32>>,
}

impl Candidate {
    fn new(
        kind: &'static Kind,
        parameters: &Parameters,
        setup: &Setup,
        plant: PlantKind,
    ) -> Result<Self, Failure> {
        let values = parameters.values(kind, setup, plant);
        let estimator = kind.build(setup, &values)?;
        Ok(Self {
            kind,
            values,
            estimator,
        })
    }

    /// The estimate over `trace`; `None` if the trace lacks a signal or a constant period that the
    /// estimator needs.
    #[must_use]
    pub fn estimate(&self, trace: &Trace) -> Option<Estimate> {
        self.kind.lack(trace).is_none().then(|| {
            let reports = self.estimator.resume(&mut None, trace, 0);
            Estimate {
                estimator: self.kind.name,
                velocity: reports.velocity,
                deviation: reports.deviation,
                damping_ratio: reports.damping_ratio,
            }
        })
    }

    /// The estimator.
    #[must_use]
    pub fn estimator(&self) -> &Estimator {
        &self.estimator
    }

    fn named_values(&self) -> BTreeMap<&'static str, f64> {
        let names = self.kind.parameters.iter().map(|p| p.name);
        names.zip(self.values.iter().copied()).collect()
    }
}

/// Estimators built for one rate and plant, with the finite difference as reference of the scores.
pub struct Evaluation {
    candidates: Vec<Candidate>,
    difference: Candidate,
    assumed_damping: f64,
}

impl Evaluation {
    /// Builds the estimators `kinds` with `parameters`.
    ///
    /// # Errors
    /// [`Failure::Input`] that names the estimator and the parameter.
    pub fn new(
        kinds: &[&'static Kind],
        parameters: &Parameters,
        setup: &Setup,
        plant: PlantKind,
    ) -> Result<Self, Failure> {
        let new = |kind| Candidate::new(kind, parameters, setup, plant);
        Ok(Self {
            candidates: kinds
                .iter()
                .map(|&kind| new(kind))
                .collect::<Result<_, _>>()?,
            difference: new(Kind::named(DIFFERENCE)?)?,
            assumed_damping: setup.stages.damping,
        })
    }

    /// The estimators.
    #[must_use]
    pub fn candidates(&self) -> &[Candidate] {
        &self.candidates
    }

    /// The estimates over `trace`, without those of estimators that need a signal it lacks.
    #[must_use]
    pub fn estimates(&self, trace: &Trace) -> Vec<Estimate> {
        self.candidates
            .iter()
            .filter_map(|c| c.estimate(trace))
            .collect()
    }

    /// Scores the `estimates` of `trace` against its true velocity; empty if the true velocity is
    /// unknown.
    ///
    /// # Errors
    /// [`Failure::Input`] if the true velocity is not finite.
    pub fn rows(
        &self,
        heading: &Heading,
        trace: &Trace,
        estimates: &[Estimate],
        interval: HapticInterval,
        wanted: Wanted,
    ) -> Result<Vec<Row>, Failure> {
        if trace.true_omega.is_none() {
            return Ok(Vec::new());
        }
        let mut scoring = Scoring::new(heading.clone(), interval, wanted, false);
        scoring.add(self, trace, estimates)?;
        let learned = |candidate: &Candidate| {
            let learned = self.learned_damping(candidate, trace, estimates)?;
            Some((last_tenth(&learned), damping_error(&learned, trace)))
        };
        Ok(scoring.rows(self, |candidate| {
            wanted.learned.then(|| learned(candidate)).flatten()
        }))
    }

    /// The coupler's damping that the estimators assume, N.m.s/rad.
    #[must_use]
    pub fn assumed_damping(&self) -> f64 {
        self.assumed_damping
    }

    /// Damping b that `candidate` has learned by each tick of `trace`, N.m.s/rad; `None` if the
    /// estimator does not learn it. The estimator runs over the trace unless its estimate is among the
    /// `estimates` and has the ratio.
    #[must_use]
    pub fn learned_damping(
        &self,
        candidate: &Candidate,
        trace: &Trace,
        estimates: &[Estimate],
    ) -> Option<Vec<f64>> {
        let mut estimates = estimates.iter();
        let known = estimates.find(|estimate| estimate.estimator == candidate.kind.name);
        let run;
        let ratios = match known.and_then(|estimate| estimate.damping_ratio.as_ref()) {
            Some(ratios) => ratios,
            None => {
                run = candidate.estimator.damping_ratio(trace)?;
                &run
            }
        };
        let assumed = self.assumed_damping;
        Some(ratios.iter().map(|&b| assumed * f64::from(b)).collect())
    }
}

fn last_tenth(values: &[f64]) -> f64 {
    let last = &values[values.len() - values.len().div_ceil(10)..];
    last.iter().sum::<f64>() / last.len() as f64
}

/// RMS error of the learned damping, % of the true damping; `None` if the true damping is unknown
/// or the run is not longer than [`LEARNING_S`].
fn damping_error(learned: &[f64], trace: &Trace) -> Option<f64> {
    let truth = trace.true_damping.as_ref()?;
    let skip = (LEARNING_S * trace.rate_hz) as usize;
    let errors: Vec<_> = learned
        .iter()
        .zip(truth)
        .skip(skip)
        .map(|(learned, truth)| (learned / truth - 1.0).powi(2))
        .collect();
    let mean = errors.iter().sum::<f64>() / errors.len() as f64;
    (!errors.is_empty()).then(|| 100.0 * mean.sqrt())
}

#[cfg(test)]
mod tests;
