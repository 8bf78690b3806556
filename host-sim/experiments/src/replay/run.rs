//! Estimators over a recording that comes in sections.

use rayon::prelude::*;

use crate::compare::interval;
use catalogue::estimators::{Kind, Lack, Setup, State};
use catalogue::parameters::{Parameters, PlantKind};
use recordings::recording::Recording;
use scoring::evaluation::{Estimate, Evaluation, Heading, Row, Scoring};
use scoring::score::{Wanted, skipped};
use simulation::device::Device;
use simulation::trace::Trace;
use terminal::failure::Failure;

/// Largest number of rows in a section. A recording of fewer rows is scored as a whole.
const SECTION: usize = 1 << 17;

/// Rows of each section of a recording of `rows` rows: nearly equal sections.
#[must_use]
pub fn section_rows(rows: usize) -> usize {
    rows.div_ceil(rows.div_ceil(SECTION).max(1))
}

/// A run of several estimators over the sections of one recording.
pub struct Run {
    /// The rows of the latest section: the last [`SKIP_S`](scoring::score::SKIP_S) of the section before it, and its
    /// own.
    pub section: Recording,
    /// Number of rows of the section before it.
    pub before: usize,
    /// One estimate of the section per estimator, in the requested order.
    pub estimates: Vec<Estimate>,
    /// Estimators left out, each with the missing column.
    pub left_out: Vec<(&'static str, &'static str)>,
    /// One line per estimator whose parameters were tuned for another encoder or rate.
    pub mismatched_presets: Vec<String>,
    evaluation: Evaluation,
    scoring: Scoring,
    /// The state of each estimator, and its learned damping.
    states: Vec<(Option<State>, Learned)>,
    /// Number of rows of the sections so far, and of the recording.
    passed: usize,
    rows: usize,
}

/// Mean of the damping that an estimator learned, over the last tenth of the recording.
#[derive(Clone, Copy, Default)]
struct Learned {
    sum: f64,
    number: usize,
}

impl Run {
    /// Builds the estimators `kinds` for a recording called `name` of `rows` rows, with the columns
    /// and the rate of `columns`.
    ///
    /// # Errors
    /// [`Failure::Input`] if an estimator cannot be built.
    pub fn new(
        columns: &Trace,
        rows: usize,
        name: &str,
        kinds: &[&'static Kind],
        device: &Device,
        parameters: &Parameters,
    ) -> Result<Self, Failure> {
        let (able, unable): (Vec<_>, Vec<_>) =
            kinds.iter().partition(|kind| kind.lack(columns).is_none());
        let setup = Setup::of(device, columns.rate_hz);
        let evaluation = Evaluation::new(&able, parameters, &setup, PlantKind::Friction)?;
        let missing = |kind: &&'static Kind| match kind.lack(columns)? {
            Lack::Column(column) => Some((kind.name, column)),
            Lack::ConstantPeriod => None,
        };
        let heading = Heading {
            scenario: name.to_owned(),
            rate_hz: columns.rate_hz,
            plant: PlantKind::Friction,
            seed: 0,
        };
        let several = section_rows(rows) < rows;
        let estimate = |kind: &&'static Kind| Estimate {
            estimator: kind.name,
            velocity: Vec::new(),
            deviation: None,
            damping_ratio: None,
        };
        Ok(Self {
            section: Recording::default(),
            before: 0,
            estimates: able.iter().map(estimate).collect(),
            left_out: unable.iter().filter_map(missing).collect(),
            mismatched_presets: parameters.used_far_away(&able, &setup, PlantKind::Friction),
            scoring: Scoring::new(heading, interval(device), Wanted::ALL, several),
            states: able.iter().map(|_| (None, Learned::default())).collect(),
            evaluation,
            passed: 0,
            rows,
        })
    }

    /// Runs the estimators over the next rows and calls `done` after each.
    ///
    /// # Errors
    /// [`Failure::Input`] if the true velocity is not finite.
    pub fn add(&mut self, rows: Recording, done: &(dyn Fn() + Sync)) -> Result<(), Failure> {
        let before = skipped(rows.trace.rate_hz);
        // A row before the section is needed for the current that acts until its first tick.
        let kept = before.max(1).min(self.section.t.len());
        let number = rows.t.len();
        match self.passed {
            0 => self.section = rows,
            _ => {
                self.section.split_front(self.section.t.len() - kept);
                self.section.append(rows);
            }
        }
        self.before = kept;
        let trace = &self.section.trace;
        let tenth = self.rows - self.rows.div_ceil(10);
        let assumed = self.evaluation.assumed_damping();
        let passed = self.passed;
        let candidates = self.evaluation.candidates().par_iter();
        let runs = candidates.zip(&mut self.estimates).zip(&mut self.states);
        runs.for_each(|((candidate, estimate), (state, learned))| {
            let reports = candidate.estimator().resume(state, trace, kept);
            keep_last(&mut estimate.velocity, kept);
            estimate.velocity.extend(reports.velocity);
            if let Some(deviation) = reports.deviation {
                let all = estimate.deviation.get_or_insert_default();
                keep_last(all, kept);
                all.extend(deviation);
            }
            for ratio in reports
                .damping_ratio
                .iter()
                .flatten()
                .skip(tenth.saturating_sub(passed))
            {
                learned.sum += assumed * f64::from(*ratio);
                learned.number += 1;
            }
            done();
        });
        self.passed += number;
        if trace.true_omega.is_some() {
            self.scoring.add(&self.evaluation, trace, &self.estimates)?;
        }
        Ok(())
    }

    /// Time of the latest rows, s.
    #[must_use]
    pub fn t(&self) -> &[f64] {
        &self.section.t[self.before..]
    }

    /// Names and values of columns at the latest rows: the velocity of each estimator, rad/s, followed with
    /// `deviations` by its standard deviation, rad/s, as `NAME_sd` if the estimator reports one.
    #[must_use]
    pub fn columns(&self, deviations: bool) -> Vec<(String, &[f32])> {
        let mut columns = Vec::new();
        for estimate in &self.estimates {
            let name = estimate.estimator;
            columns.push((name.to_owned(), &estimate.velocity[self.before..]));
            if let Some(deviation) = estimate.deviation.as_ref().filter(|_| deviations) {
                columns.push((format!("{name}_sd"), &deviation[self.before..]));
            }
        }
        columns
    }

    /// The scores of the rows so far, empty without column `true_omega`.
    #[must_use]
    pub fn rows(&self) -> Vec<Row> {
        self.scoring.rows(&self.evaluation, |candidate| {
            let mut states = self.estimates.iter().zip(&self.states);
            let (_, (_, learned)) = states.find(|(e, _)| e.estimator == candidate.kind.name)?;
            (learned.number > 0).then(|| (learned.sum / learned.number as f64, None))
        })
    }
}

/// Removes all but the last `number` values.
fn keep_last(values: &mut Vec<f32>, number: usize) {
    values.drain(..values.len().saturating_sub(number));
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::compare::{Case, trace};
    use simulation::scenario::ScenarioName;

    #[test]
    fn sections_have_the_velocities_of_the_whole_recording() {
        let device = Device::default();
        let kinds: Vec<_> = Kind::all().iter().collect();
        let case = Case {
            scenario: ScenarioName::Track,
            rate_hz: 1000.0,
            plant: PlantKind::Friction,
            seed: 3,
            seconds: 2.0,
            keep: false,
        };
        let trace = trace(&case, &device, &kinds).unwrap();
        let rows = trace.len();
        let columns = Trace {
            rate_hz: trace.rate_hz,
            ..trace.clone()
        };
        let mut recording = Recording {
            t: (0..rows).map(|k| k as f64 * 1e-3).collect(),
            trace: Trace {
                true_damping: None,
                ..trace
            },
            ..Recording::default()
        };
        let recorded = recording.trace.clone();
        let parameters = Parameters::default();
        let run = || Run::new(&columns, rows, "r", &kinds, &device, &parameters).unwrap();
        let mut whole = run();
        whole.add(recording.clone(), &|| ()).unwrap();
        let names = |run: &Run, deviations| -> Vec<_> {
            let columns = run.columns(deviations).into_iter();
            columns.map(|(name, _)| name).collect()
        };
        let all = names(&whole, true);
        assert!(all.contains(&"imm_sd".to_owned()) && !all.contains(&"pll_sd".to_owned()));
        let estimators: Vec<_> = kinds.iter().map(|kind| kind.name.to_owned()).collect();
        assert_eq!(names(&whole, false), estimators);
        let mut sections = run();
        let mut joined = vec![Vec::new(); all.len()];
        let mut t = Vec::new();
        for number in [700, 130, 1000, rows] {
            sections.add(recording.split_front(number), &|| ()).unwrap();
            t.extend_from_slice(sections.t());
            for (all, (_, part)) in joined.iter_mut().zip(sections.columns(true)) {
                all.extend_from_slice(part);
            }
        }
        assert_eq!(t, whole.t());
        for (joined, (name, whole)) in joined.iter().zip(whole.columns(true)) {
            assert_eq!(joined, whole, "{name}");
        }
        let damping = |run: &Run| -> Vec<_> {
            let rows = run.rows().into_iter();
            rows.map(|row| row.score.learned_damping_nms_per_rad)
                .collect()
        };
        assert_eq!(damping(&sections), damping(&whole));
        let mut learning = 0;
        for (candidate, found) in whole.evaluation.candidates().iter().zip(damping(&whole)) {
            let learned = candidate.estimator().damping_ratio(&recorded);
            let last = learned.map(|ratios| {
                let last = ratios[1800..].iter().map(|ratio| f64::from(*ratio));
                device.stages.damping * last.sum::<f64>() / 200.0
            });
            let near = |(a, b): (f64, f64)| (a / b - 1.0).abs() < 1e-9;
            assert_eq!(last.is_some(), found.is_some());
            assert!(last.zip(found).is_none_or(near), "{last:?} {found:?}");
            learning += usize::from(found.is_some());
        }
        assert!(learning > 0);
    }
}
