//! The cases of one command: every combination of rate, scenario and seed.

use serde::{Deserialize, Serialize};
use shards::Experiment;

use super::{Cell, cells};
use crate::compare::{Case, Settings};
use catalogue::estimators::Kind;
use catalogue::parameters::{Parameters, PlantKind};
use scoring::score::Wanted;
use simulation::device::Device;
use simulation::scenario::ScenarioName;
use simulation::simulate;
use terminal::failure::Failure;

/// All inputs of the rows. A job is one case, a run of the plant with all estimators.
#[derive(Clone, Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Plan {
    /// Scenarios, by name.
    pub scenarios: Vec<String>,
    /// Control rates, Hz.
    pub rates_hz: Vec<f64>,
    /// Seeds.
    pub seeds: Vec<u64>,
    /// Duration of each run, s; `None` for that of the scenario.
    pub seconds: Option<f64>,
    /// Estimators, by name.
    pub estimators: Vec<String>,
    /// Their parameters.
    pub parameters: Parameters,
    /// The device.
    pub device: Device,
    /// Name of the device in reports.
    pub device_name: String,
}

impl Experiment for Plan {
    const COMMAND: &'static str = "host-sim sensitivity";
    type Job = Case;
    type Row = Vec<Cell>;

    fn jobs(&self) -> Result<Vec<Case>, Failure> {
        let scenarios = self.scenarios.iter().map(|name| name.parse());
        let scenarios: Vec<ScenarioName> = scenarios.collect::<Result<_, String>>()?;
        let mut cases = Vec::new();
        for &rate_hz in &self.rates_hz {
            for &scenario in &scenarios {
                let seconds = self.seconds.unwrap_or_else(|| scenario.default_seconds());
                simulate::ticks(rate_hz, seconds)?;
                cases.extend(self.seeds.iter().map(|&seed| Case {
                    scenario,
                    rate_hz,
                    plant: PlantKind::Friction,
                    seed,
                    seconds,
                    keep: false,
                }));
            }
        }
        Ok(cases)
    }

    fn rows(&self, jobs: &[Case], done: &(dyn Fn() + Sync)) -> Result<Vec<Vec<Cell>>, Failure> {
        let kinds = self.estimators.iter().map(|name| Kind::named(name));
        let settings = Settings {
            device: self.device.clone(),
            estimators: kinds.collect::<Result<_, _>>()?,
            parameters: self.parameters.clone(),
            wanted: Wanted::NONE,
        };
        cells(jobs, &settings, done)
    }
}
