//! `host-sim sensitivity`.

use std::path::PathBuf;

use clap::Args;

use catalogue::parameters::PlantKind;
use experiments::compare::{Case, Settings};
use experiments::rows;
use experiments::sensitivity::{sensitivity, table::table};
use experiments::table::layout::{NARROW, terminal_width};
use recordings::arguments::DeviceFile;
use report::{self, Printout};
use scoring::score::Wanted;
use simulation::scenario::ScenarioName;
use terminal::failure::Failure;
use terminal::output::Folder;

use super::arguments::{ParameterOptions, kinds, rates, scenarios};
use super::page::{self, progress};

/// Default folder of the page.
const PAGE: &str = "target/sensitivity";

#[derive(Debug, Args)]
pub(super) struct Sensitivity {
    /// Scenario to run, see host-sim scenarios; repeatable [default: all with friction except
    /// heating]
    #[arg(long = "scenario", value_name = "NAME")]
    pub(super) scenarios: Vec<String>,
    /// Control rate, 100 to 100000 Hz; repeatable [default: 1000]
    #[arg(long = "rate", value_name = "HZ", allow_negative_numbers = true)]
    pub(super) rates: Vec<f64>,
    /// Estimator to run, see host-sim estimators; repeatable [default: all]
    #[arg(long = "estimator", value_name = "NAME")]
    pub(super) estimators: Vec<String>,
    /// Seed of all random numbers; repeatable [default: 1]
    #[arg(long = "seed", value_name = "N")]
    pub(super) seeds: Vec<u64>,
    /// Duration of each run, s [default: 10; scenario heating: 60]
    #[arg(long, value_name = "S", allow_negative_numbers = true)]
    pub(super) seconds: Option<f64>,
    #[command(flatten)]
    pub(super) device: DeviceFile,
    #[command(flatten)]
    pub(super) parameters: ParameterOptions,
    /// Folder of index.html, figures as SVG, sensitivity.csv, sensitivity.json [default:
    /// target/sensitivity; no folder with --json -]
    #[arg(long, value_name = "DIR")]
    pub(super) out: Option<PathBuf>,
    /// Write the scores as JSON to FILE; - is standard output, which then has nothing else
    #[arg(long, value_name = "FILE")]
    pub(super) json: Option<PathBuf>,
}

pub(super) fn run(options: &Sensitivity, command_line: &str) -> Result<(), Failure> {
    let settings = Settings {
        device: options.device.load()?,
        estimators: kinds(&options.estimators)?,
        parameters: options.parameters.load()?,
        wanted: Wanted::NONE,
    };
    let cases = cases(options)?;
    let folder = page::folder(options.out.as_deref(), options.json.as_deref(), PAGE)?;
    let bar = progress(cases.len(), "running");
    let rows = sensitivity(&cases, &settings, || bar.inc(1))?;
    bar.finish_and_clear();

    let json = rows::json(&rows)?;
    let mut text = table(&rows, terminal_width());
    if let Some(folder) = folder {
        let printout = Printout {
            command: command_line,
            device: &options.device.name(),
            table: &table(&rows, NARROW),
        };
        let page = report::sensitivity(&rows, &printout)?;
        let mut files = Folder::new(folder);
        files.add("sensitivity.json", json.as_slice());
        files.add("sensitivity.csv", rows::csv(&rows)?);
        let index = page::write(files, &page)?;
        text.push_str(&format!("\nPage: {}\n", index.display()));
    }
    page::print(options.json.as_deref(), &json, &text)
}

fn cases(options: &Sensitivity) -> Result<Vec<Case>, Failure> {
    let scenarios = scenarios(&options.scenarios, &ScenarioName::with_friction())?;
    let seeds = if options.seeds.is_empty() {
        vec![1]
    } else {
        options.seeds.clone()
    };
    let mut cases = Vec::new();
    for rate_hz in rates(&options.rates, &[1e3]) {
        for &scenario in &scenarios {
            let seconds = options
                .seconds
                .unwrap_or_else(|| scenario.default_seconds());
            simulation::simulate::ticks(rate_hz, seconds)?;
            cases.extend(seeds.iter().map(|&seed| Case {
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
