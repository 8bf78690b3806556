//! `host-sim limit`.

use crate::compare::{Case, Settings};
use crate::failure::Failure;
use crate::limit::{limit, table::table};
use crate::output::{print_bytes, write_whole};
use crate::parameters::PlantKind;
use crate::rows;
use crate::scenario::ScenarioName;
use crate::score::Wanted;

use super::arguments::{Limit, is_stdout, kinds, rates, scenarios};
use super::compare::progress;

pub(super) fn run(options: &Limit) -> Result<(), Failure> {
    use ScenarioName::{FreeAir, Step, Stochastic, Texture, Track};
    let settings = Settings {
        device: options.device.load()?,
        estimators: kinds(&options.estimators)?,
        parameters: options.parameters.load()?,
        wanted: Wanted::NONE,
    };
    let scenarios = scenarios(
        &options.scenarios,
        &[Stochastic, Step, Track, FreeAir, Texture],
    )?;
    let mut cases = Vec::new();
    for rate_hz in rates(&options.rates, &[1e3]) {
        crate::simulate::ticks(rate_hz, options.seconds)?;
        cases.extend(scenarios.iter().map(|&scenario| Case {
            scenario,
            rate_hz,
            plant: PlantKind::Friction,
            seed: options.seed,
            seconds: options.seconds,
            keep: false,
        }));
    }
    let bar = progress(cases.len(), "filtering");
    let rows = limit(&cases, &settings, options.particles as usize, || bar.inc(1))?;
    bar.finish_and_clear();
    let json = rows::json(&rows)?;
    match &options.json {
        Some(path) if is_stdout(path) => return print_bytes(&json),
        Some(path) => write_whole(path, &json)?,
        None => {}
    }
    print_bytes(table(&rows).as_bytes())
}
