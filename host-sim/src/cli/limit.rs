//! `host-sim limit`.

use std::path::PathBuf;

use clap::Args;

use catalogue::parameters::PlantKind;
use experiments::compare::Case;
use experiments::limit::{SCENARIOS, STEPS_PER_CASE, limit, table::table, too_few};
use experiments::rows;
use experiments::table::layout::terminal_width;
use recordings::arguments::DeviceFile;
use scoring::score::Wanted;
use terminal::failure::Failure;
use terminal::output::note;

use super::arguments::{ParameterOptions, distinct, kinds, scenarios};
use super::compare::{longer_than_skipped, settings};
use super::page::{self, progress};
use super::rates::{USUAL_HZ, rate_help, repeatable};

#[derive(Debug, Args)]
pub(super) struct Limit {
    /// Scenario to run, see host-sim scenarios; repeatable [default: stochastic, step, track,
    /// free-air, texture]
    #[arg(long = "scenario", value_name = "NAME")]
    pub(super) scenarios: Vec<String>,
    #[arg(long = "rate", value_name = "HZ", help = rate_help() + &repeatable(&USUAL_HZ))]
    pub(super) rates: Vec<f64>,
    /// Estimator to compare with the particle filter, see host-sim estimators; repeatable [default: all]
    #[arg(long = "estimator", value_name = "NAME")]
    pub(super) estimators: Vec<String>,
    /// Seed of all random numbers, also of the particles
    #[arg(long, value_name = "N", default_value_t = 1)]
    pub(super) seed: u64,
    /// Duration of each run, s
    #[arg(long, value_name = "S", default_value_t = 10.0)]
    pub(super) seconds: f64,
    /// Number of particles, 10 to 1000000
    #[arg(long, value_name = "N", default_value_t = 2000, value_parser = clap::value_parser!(u32).range(10..=1_000_000))]
    pub(super) particles: u32,
    #[command(flatten)]
    pub(super) device: DeviceFile,
    #[command(flatten)]
    pub(super) parameters: ParameterOptions,
    /// Write the scores as JSON to FILE; - is standard output, which then has nothing else
    #[arg(long, value_name = "FILE")]
    pub(super) json: Option<PathBuf>,
}

pub(super) fn run(options: &Limit) -> Result<(), Failure> {
    let scenarios = scenarios(&options.scenarios, &SCENARIOS)?;
    let mut cases = Vec::new();
    for rate_hz in distinct(&options.rates, &USUAL_HZ) {
        simulation::simulate::ticks(rate_hz, options.seconds)?;
        longer_than_skipped(options.seconds)?;
        cases.extend(scenarios.iter().map(|&scenario| Case {
            scenario,
            rate_hz,
            plant: PlantKind::Friction,
            seed: options.seed,
            seconds: options.seconds,
            keep: false,
        }));
    }
    let (device, parameters) = (
        options.device.load_to_simulate()?,
        options.parameters.load(&kinds(&options.estimators)?)?,
    );
    let settings = settings(
        &options.estimators,
        &cases,
        device,
        parameters,
        Wanted::NONE,
    )?;
    let bar = progress(STEPS_PER_CASE * cases.len(), "filtering");
    let rows = limit(&cases, &settings, options.particles as usize, &|| {
        bar.inc(1);
    })?;
    bar.finish_and_clear();
    for line in too_few(&rows, options.particles as usize) {
        note(line);
    }
    let json = rows::json(&rows)?;
    page::print(
        options.json.as_deref(),
        &json,
        &table(&rows, terminal_width()),
    )
}
