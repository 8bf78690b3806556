//! The searches of one command: every combination of rate, plant and estimator.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};
use shards::Experiment;

use super::{Tuned, TuningSet, tune};
use catalogue::constant_error::ConstantError;
use catalogue::estimators::Kind;
use catalogue::parameters::{PlantKind, Preset, Presets};
use simulation::device::Device;
use simulation::scenario::ScenarioName;
use simulation::simulate;
use terminal::failure::Failure;

/// All inputs of the searches on simulated motion. A job is the search of one estimator at one rate
/// on one plant: a finer grid of a search depends on the grid before it.
#[derive(Clone, Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Plan {
    /// Estimators by what they are tuned on.
    pub groups: Vec<Group>,
    /// Control rates, Hz.
    pub rates_hz: Vec<f64>,
    /// Plants.
    pub plants: Vec<PlantKind>,
    /// The device.
    pub device: Device,
}

/// Estimators that are tuned on the same traces.
#[derive(Clone, Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Group {
    /// Estimators, by name. All have parameters.
    pub estimators: Vec<String>,
    /// Scenarios, by name.
    pub scenarios: Vec<String>,
    /// Number of tuning seeds.
    pub seeds: u64,
    /// Duration of each run, s.
    pub seconds: f64,
    /// Whether the cost is averaged over wrong constants too.
    pub perturbed: bool,
}

/// One search.
#[derive(Clone, Copy, Debug)]
pub struct Search {
    rate_hz: f64,
    plant: PlantKind,
    /// Index of the group.
    group: usize,
    kind: &'static Kind,
}

impl Group {
    fn kinds(&self) -> Result<Vec<&'static Kind>, Failure> {
        let kinds = self.estimators.iter().map(|name| Kind::named(name));
        kinds.collect()
    }

    fn set(&self, device: &Device) -> Result<TuningSet, Failure> {
        let scenarios = self.scenarios.iter().map(|name| name.parse());
        Ok(TuningSet {
            device: device.clone(),
            scenarios: scenarios.collect::<Result<Vec<ScenarioName>, String>>()?,
            seeds: self.seeds,
            seconds: self.seconds,
            constant_errors: match self.perturbed {
                true => ConstantError::extremes(),
                false => Vec::new(),
            },
        })
    }
}

impl Plan {
    /// The presets of all searches in their order, and the notes.
    ///
    /// # Errors
    /// As those of the jobs.
    pub fn presets(&self, tuned: &[Tuned]) -> Result<(Presets, Vec<String>), Failure> {
        let mut presets = Presets::default();
        let mut notes = Vec::new();
        for (search, tuned) in self.jobs()?.iter().zip(tuned) {
            let Search { rate_hz, plant, .. } = *search;
            let is_next = (presets.preset.last())
                .is_none_or(|last| (last.rate_hz, last.plant) != (rate_hz, plant));
            if is_next {
                presets.preset.push(Preset {
                    rate_hz,
                    plant,
                    counts_per_rev: Some(self.device.stages.large.counts_per_rev),
                    estimators: BTreeMap::new(),
                });
            }
            if let Some(preset) = presets.preset.last_mut() {
                let name = search.kind.name.to_owned();
                preset.estimators.insert(name, tuned.values.clone());
            }
            let at = format!("{rate_hz} Hz, {}", plant.name());
            notes.extend(tuned.notes.iter().map(|note| format!("{at}: {note}")));
        }
        Ok((presets, notes))
    }
}

impl Experiment for Plan {
    const COMMAND: &'static str = "host-sim tune";
    type Job = Search;
    type Row = Tuned;

    fn jobs(&self) -> Result<Vec<Search>, Failure> {
        let mut searches = Vec::new();
        for &rate_hz in &self.rates_hz {
            for &plant in &self.plants {
                for (at, group) in self.groups.iter().enumerate() {
                    simulate::ticks(rate_hz, group.seconds)?;
                    searches.extend(group.kinds()?.into_iter().map(|kind| Search {
                        rate_hz,
                        plant,
                        group: at,
                        kind,
                    }));
                }
            }
        }
        Ok(searches)
    }

    fn rows(&self, jobs: &[Search], done: &(dyn Fn() + Sync)) -> Result<Vec<Tuned>, Failure> {
        self.rows_with_look(jobs, done, &|| ())
    }
}

impl Plan {
    /// As [`Experiment::rows`]; `look` is called before each simulation and each evaluation, and may unwind to
    /// stop the search. The searches with the same traces follow each other.
    ///
    /// # Errors
    /// As [`Experiment::rows`].
    pub fn rows_with_look(
        &self,
        jobs: &[Search],
        done: &(dyn Fn() + Sync),
        look: &(dyn Fn() + Sync),
    ) -> Result<Vec<Tuned>, Failure> {
        let traces = |job: &Search| (job.rate_hz, job.plant, job.group);
        let mut rows = Vec::new();
        for same in jobs.chunk_by(|a, b| traces(a) == traces(b)) {
            let (rate_hz, plant, group) = traces(&same[0]);
            let group = &self.groups[group];
            let kinds: Vec<_> = same.iter().map(|job| job.kind).collect();
            let set = group.set(&self.device)?;
            let read = group.kinds()?;
            rows.extend(tune(&set, &kinds, &read, rate_hz, plant, done, look)?);
        }
        Ok(rows)
    }
}
