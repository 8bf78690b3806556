//! Scores of a trace that comes in sections.

use super::{Candidate, Estimate, Evaluation, Heading, Row};
use crate::score::{HapticInterval, Score, Sections, Truth, Wanted};
use simulation::trace::Trace;
use terminal::failure::Failure;

/// Scores of the estimates of one trace, which can come in sections. Every section but the first
/// begins with the last [`SKIP_S`](crate::score::SKIP_S) of the one before it.
pub struct Scoring {
    heading: Heading,
    interval: HapticInterval,
    wanted: Wanted,
    /// Whether there is more than one section.
    several: bool,
    /// Name and scores of each estimate.
    estimates: Vec<(&'static str, Sections)>,
    reference: Sections,
}

impl Scoring {
    /// Scores of no section yet. `several` states whether there will be more than one.
    #[must_use]
    pub fn new(heading: Heading, interval: HapticInterval, wanted: Wanted, several: bool) -> Self {
        Self {
            heading,
            interval,
            wanted,
            several,
            estimates: Vec::new(),
            reference: Sections::default(),
        }
    }

    /// Adds a section, which must have the true velocity, with the estimates by `evaluation`.
    ///
    /// # Errors
    /// [`Failure::Input`] if the true velocity is not finite.
    pub fn add(
        &mut self,
        evaluation: &Evaluation,
        trace: &Trace,
        estimates: &[Estimate],
    ) -> Result<(), Failure> {
        let omega = trace.true_omega.as_deref().unwrap_or_default();
        let known = trace.known.as_deref();
        let truth = Truth::where_known(omega, known, trace.rate_hz, self.interval, self.wanted)
            .map_err(|error| Failure::Input(format!("{}: {error}", self.heading.scenario)))?;
        if self.estimates.is_empty() {
            let named = |estimate: &Estimate| (estimate.estimator, Sections::default());
            self.estimates = estimates.iter().map(named).collect();
        }
        let difference = &evaluation.difference;
        let several = self.several;
        let mut compared = false;
        for (estimate, (_, sections)) in estimates.iter().zip(&mut self.estimates) {
            let score = truth.score(&estimate.velocity);
            if estimate.estimator == difference.kind.name {
                compared = true;
                self.reference
                    .add(&truth, &estimate.velocity, score, several);
            }
            let deviation = estimate.deviation.as_ref().filter(|_| self.wanted.within);
            let within = |sd: &Vec<f32>| truth.within_2_sigma(&estimate.velocity, sd);
            let score = Score {
                within_2_sigma: deviation.and_then(within),
                ..score
            };
            sections.add(&truth, &estimate.velocity, score, several);
        }
        if !compared {
            let velocity = difference.estimator.run(trace);
            let score = truth.score(&velocity);
            self.reference.add(&truth, &velocity, score, several);
        }
        Ok(())
    }

    /// One row per estimate. `learned` gives the damping that an estimator learned, N.m.s/rad, and its
    /// error, %.
    #[must_use]
    pub fn rows(
        &self,
        evaluation: &Evaluation,
        learned: impl Fn(&Candidate) -> Option<(f64, Option<f64>)>,
    ) -> Vec<Row> {
        let reference = self.reference.score();
        let row = |(name, sections): &(&'static str, Sections)| {
            let mut candidates = evaluation.candidates.iter();
            let candidate = candidates.find(|c| c.kind.name == *name);
            let learned = candidate.and_then(&learned);
            Row {
                scenario: self.heading.scenario.clone(),
                rate_hz: self.heading.rate_hz,
                plant: self.heading.plant,
                seed: self.heading.seed,
                estimator: name,
                score: Score {
                    learned_damping_nms_per_rad: learned.map(|(damping, _)| damping),
                    learned_damping_pct: learned.and_then(|(_, error)| error),
                    ..sections.score().relative_to(&reference)
                },
                parameters: candidate.map(Candidate::named_values).unwrap_or_default(),
            }
        };
        self.estimates.iter().map(row).collect()
    }
}
