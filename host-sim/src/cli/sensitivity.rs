//! `host-sim sensitivity`.

use clap::Args;

use experiments::designed::with_friction;
use experiments::rows;
use experiments::sensitivity::{self, Cell, Plan, table::table};
use experiments::table::layout::{NARROW, terminal_width};
use recordings::arguments::DeviceFile;
use report::{self, Printout};
use shards::Experiment as _;
use simulation::scenario::ScenarioName;
use terminal::failure::Failure;
use terminal::output::Folder;

use super::arguments::{
    ParameterOptions, check_rates, distinct, kinds, kinds_at, scenarios, seconds_help,
};
use super::page;
use super::rates::{USUAL_HZ, rate_help, repeatable};
use super::shard::{Outputs, ShardOptions};

/// Default folder of the page.
pub(super) const PAGE: &str = "target/sensitivity";

/// Text before the progress bar.
const DOING: &str = "running";

#[derive(Debug, Args)]
pub(super) struct Sensitivity {
    /// Scenario to run, see host-sim scenarios; repeatable [default: all with friction except
    /// heating]
    #[arg(long = "scenario", value_name = "NAME")]
    pub(super) scenarios: Vec<String>,
    #[arg(long = "rate", value_name = "HZ", help = rate_help() + &repeatable(&USUAL_HZ))]
    pub(super) rates: Vec<f64>,
    /// Estimator to run, see host-sim estimators; repeatable [default: all]
    #[arg(long = "estimator", value_name = "NAME")]
    pub(super) estimators: Vec<String>,
    /// Seed of all random numbers; repeatable [default: 1]
    #[arg(long = "seed", value_name = "N")]
    pub(super) seeds: Vec<u64>,
    #[arg(long, value_name = "S", help = seconds_help())]
    pub(super) seconds: Option<f64>,
    #[command(flatten)]
    pub(super) device: DeviceFile,
    #[command(flatten)]
    pub(super) parameters: ParameterOptions,
    #[command(flatten)]
    pub(super) outputs: ShardOptions,
}

pub(super) fn run(options: &Sensitivity, run_line: &str) -> Result<(), Failure> {
    let plan = plan(options)?;
    let asked = options.outputs.asked(run_line, PAGE, DOING);
    asked.run(&plan, finish)
}

/// Prints the table and writes page and JSON of all cases, whether they were run now or merged.
pub(super) fn finish(
    plan: &Plan,
    cells: &[Vec<Cell>],
    outputs: Outputs<'_>,
) -> Result<(), Failure> {
    let rows = sensitivity::rows(&plan.jobs()?, cells)?;
    let json = rows::json(&rows)?;
    let mut text = table(&rows, terminal_width());
    if let Some(folder) = outputs.folder(PAGE)? {
        let printout = Printout {
            command: &outputs.command_line(),
            device: &plan.device_name,
            table: &table(&rows, NARROW),
        };
        let page = report::sensitivity(&rows, &printout)?;
        let mut files = Folder::new(folder);
        files.add("sensitivity.json", json.as_slice());
        files.add("sensitivity.csv", rows::csv(&rows)?);
        let index = page::write(files, &page)?;
        text.push_str(&format!("\nPage: {}\n", index.display()));
    }
    page::print(outputs.json, &json, &text)
}

fn plan(options: &Sensitivity) -> Result<Plan, Failure> {
    let scenarios = scenarios(&options.scenarios, &ScenarioName::with_friction())?;
    let device = options.device.load_to_simulate()?;
    let parameters = options.parameters.load(&kinds(&options.estimators)?)?;
    let rates_hz = distinct(&options.rates, &USUAL_HZ);
    check_rates(&rates_hz, options.seconds)?;
    let places = rates_hz.iter().map(|&hz| with_friction(&device, hz));
    let places: Vec<_> = places.collect();
    let kinds = kinds_at(&options.estimators, &parameters, &places)?;
    Ok(Plan {
        scenarios: scenarios.iter().map(ToString::to_string).collect(),
        rates_hz,
        seeds: distinct(&options.seeds, &[1]),
        seconds: options.seconds,
        estimators: kinds.iter().map(|kind| kind.name.to_owned()).collect(),
        parameters,
        device,
        device_name: options.device.name(),
    })
}
